use std::array::from_fn;

use qless_constraints::types::{Distance, MacroStrain, OnSphere, Periodic, PlanarPoint, Point, Prescribed};
use qless_constraints::{ConstraintSet, SetBuilder};
use qless_solve::newton::{NewtonOptions, Redundancy, redundancies};

use crate::linkages::{Outcome, bricard, four_bar, moved, parallelogram, random, rank};

/// Each linkage has one motion: its DOFs, its equations, their rank, and how many are redundant everywhere.
///
/// The parallelogram has three arms. 5 moving bodies of Bricard's linkage have 35 DOFs; 6 hinges with 5 equations and 5 norms of Euler
/// parameters are 35 equations. The spatial four-bar linkage has 4 hinges with 5 equations and 3 norms.
#[test]
fn linkages_have_one_motion() -> Outcome {
    let linkages = [
        ("parallelogram", parallelogram()?, (0, 0.4), (6, 6, 5), 1),
        ("Bricard", bricard()?, (2, 0.1), (35, 35, 34), 1),
        ("four-bar", four_bar()?, (0, 0.1), (21, 23, 20), 3),
    ];
    for (name, builder, (dof, by), counts, redundant) in linkages {
        let set = builder.build()?;
        let u = moved(&set, dof, by)?;
        assert_eq!((set.dofs(), set.equations(), rank(&set, &u)?), counts, "{name}");
        let found = redundancies(&set, &u, &NewtonOptions::default())?;
        assert_eq!(found.iter().map(|f| f.1).collect::<Vec<_>>(), vec![Redundancy::Everywhere; redundant], "{name}");
    }
    Ok(())
}

/// A driven Bricard linkage: 36 equations have rank 35, so that one is redundant, and nothing moves.
#[test]
fn a_driven_linkage_does_not_move() -> Outcome {
    // The middle of the first link can only move vertically.
    let u = moved(&bricard()?.build()?, 2, 0.1)?;
    assert!(u.iter().map(|u| u.abs()).fold(0.0, f64::max) > 0.05);
    let mut builder = bricard()?;
    builder.add("drive", Prescribed { values: vec![(2, u[2])] })?;
    let driven = builder.build()?;
    assert_eq!((driven.equations(), rank(&driven, &u)?), (36, 35));
    Ok(())
}

fn all_distances<const D: usize>(points: usize) -> Outcome<(SetBuilder, usize)> {
    let point = |i: usize| {
        let at = from_fn(|k| 2.0 * random(D * i + k));
        qless_constraints::types::Node::<D> { dofs: from_fn(|k| D * i + k), at }
    };
    let mut builder = ConstraintSet::builder(D * points);
    for i in 0..points {
        for j in i + 1..points {
            builder.add(format!("{i}-{j}"), Distance::new(point(i), point(j)))?;
        }
    }
    Ok((builder, D * points))
}

/// n points have `D n - D (D + 1) / 2` motions that are not rigid; that is the rank.
#[test]
fn all_pairwise_distances() -> Outcome {
    let (builder, dofs) = all_distances::<2>(4)?;
    let set = builder.build().expect("few DOFs");
    assert_eq!((set.equations(), rank(&set, &vec![0.0; dofs])?), (6, 5));
    let (builder, dofs) = all_distances::<3>(8)?;
    let set = builder.build().expect("few DOFs");
    assert_eq!((set.equations(), rank(&set, &vec![0.0; dofs])?), (28, 18));
    let found = redundancies(&set, &vec![0.0; dofs], &NewtonOptions::default())?;
    assert_eq!(found.iter().filter(|f| f.1 == Redundancy::Everywhere).count(), 10);
    Ok(())
}

/// Pairs of opposite faces of a grid of n^D nodes under a macroscopic strain.
fn periodic<const D: usize>(n: usize, strain: MacroStrain<D>, dofs: usize) -> Outcome<ConstraintSet> {
    let node = |place: [usize; D]| {
        let number = place.iter().fold(0, |sum, p| sum * n + p);
        qless_constraints::types::Node::<D> { dofs: from_fn(|k| D * number + k), at: place.map(|p| p as f64) }
    };
    let mut builder = ConstraintSet::builder(dofs);
    for face in 0..D {
        for other in 0..n.pow(D as u32 - 1) {
            let mut rest = other;
            let low: [usize; D] = from_fn(|k| {
                let place = if k == face { 0 } else { rest % n };
                rest /= if k == face { 1 } else { n };
                place
            });
            let mut high = low;
            high[face] = n - 1;
            builder.add(format!("{low:?} {high:?}"), Periodic { a: node(low), b: node(high), strain })?;
        }
    }
    Ok(builder.build().expect("few DOFs"))
}

/// In space there are `3 n^2` equations per component; `3 n - 1` of them are redundant: 3 (n - 2) on edges and 5 at corners.
#[test]
fn periodic_grids_in_space() -> Outcome {
    for n in [2, 3, 5] {
        let given = MacroStrain::Given([[0.01, 0.02, 0.0], [0.02, -0.01, 0.03], [0.0, 0.0, 0.005]]);
        let set = periodic::<3>(n, given, 3 * n.pow(3))?;
        let u = vec![0.0; set.dofs()];
        assert_eq!((set.equations(), rank(&set, &u)?), (9 * n * n, 9 * n * n - 3 * (3 * n - 1)));
        // With E as DOFs nothing changes: the same combinations cancel.
        let first = 3 * n.pow(3);
        let dofs = MacroStrain::Dofs(from_fn(|i| from_fn(|j| first + 3 * i + j)));
        let set = periodic::<3>(n, dofs, first + 9)?;
        assert_eq!(rank(&set, &vec![0.0; set.dofs()])?, 9 * n * n - 3 * (3 * n - 1));
    }
    Ok(())
}

/// The field of a macroscopic strain satisfies all pairs, whether the strain is prescribed or a DOF.
#[test]
fn periodic_pairs_follow_the_strain() -> Outcome {
    let (n, e) = (3, [[0.01, 0.02, 0.05], [0.03, -0.01, 0.04], [-0.02, 0.06, 0.005]]);
    let place = |node: usize| [node / (n * n), node / n % n, node % n];
    let field = |node: usize| -> [f64; 3] { from_fn(|i| (0..3).map(|k| e[i][k] * place(node)[k] as f64).sum()) };
    let mut u: Vec<f64> = (0..n.pow(3)).flat_map(field).collect();
    u.extend(e.iter().flatten());
    let dofs = MacroStrain::Dofs(from_fn(|i| from_fn(|j| 3 * n.pow(3) + 3 * i + j)));
    for strain in [MacroStrain::Given(e), dofs] {
        let set = periodic::<3>(n, strain, u.len())?;
        let mut evaluation = set.allocate();
        set.evaluate(&u, &mut evaluation).expect("of this set");
        assert!(evaluation.c().iter().all(|c| c.abs() < 1e-15));
    }
    Ok(())
}

/// In the plane there are `2 n` equations per component; one is redundant, at the corners. None conflicts, whatever the strain.
#[test]
fn periodic_grids_in_the_plane() -> Outcome {
    for n in [2, 4, 9] {
        let set = periodic::<2>(n, MacroStrain::Given([[0.1, 0.3], [0.2, -0.4]]), 2 * n * n)?;
        let mut evaluation = set.allocate();
        set.evaluate(&vec![0.0; set.dofs()], &mut evaluation).expect("of this set");
        let analysis = qless::analyse(&set.linearised(&evaluation, &[])?, &qless::Options::default())?;
        assert_eq!((set.equations(), analysis.rank()), (4 * n, 4 * n - 2));
        assert!(analysis.dependent().iter().all(|dependent| dependent.kind == qless::Kind::Redundant));
    }
    Ok(())
}

/// Two collinear bars fix their hinge twice along their line and not across it; any other pair fixes it.
#[test]
fn redundant_only_where_bars_are_in_line() -> Outcome {
    let point = Point::new([0, 1, 2], [1.0, 0.0, 0.0]);
    let mut builder = ConstraintSet::builder(3);
    builder.add("bar 1", OnSphere { point, centre: [0.0; 3], radius: None })?;
    builder.add("bar 2", OnSphere { point, centre: [2.0, 0.0, 0.0], radius: None })?;
    // Collinear at u = 0 and fully stretched: no other configuration satisfies both.
    let set = builder.build().expect("few DOFs");
    let found = redundancies(&set, &[0.0; 3], &NewtonOptions::default())?;
    assert_eq!(found.iter().map(|f| f.1).collect::<Vec<_>>(), [Redundancy::Unknown]);
    Ok(())
}

/// With a third arm one equation is redundant in all configurations, and one more in the flat one.
#[test]
fn flat_parallelogram_with_three_arms() -> Outcome {
    let set = parallelogram()?.build()?;
    let flat = [1.0, -1.0].repeat(3);
    assert_eq!(rank(&set, &flat)?, 4);
    let mut places: Vec<_> = redundancies(&set, &flat, &NewtonOptions::default())?.iter().map(|f| f.1).collect();
    places.sort_by_key(|&place| place == Redundancy::OnlyHere);
    assert_eq!(places, [Redundancy::Everywhere, Redundancy::OnlyHere]);
    Ok(())
}

/// A parallelogram passes through its flat configuration, and is regular before and after.
#[test]
fn flat_parallelogram() -> Outcome {
    let (p, q) = (PlanarPoint::new([0, 1], [0.0, 1.0]), PlanarPoint::new([2, 3], [2.0, 1.0]));
    let mut builder = ConstraintSet::builder(4);
    builder.add("arm 1", OnSphere { point: p, centre: [0.0, 0.0], radius: None })?;
    builder.add("arm 2", OnSphere { point: q, centre: [2.0, 0.0], radius: None })?;
    builder.add("coupler", Distance::new(p, q))?;
    let set = builder.build().expect("few DOFs");
    let flat = [1.0, -1.0, 1.0, -1.0];
    assert_eq!((rank(&set, &[0.0; 4])?, rank(&set, &flat)?), (3, 2));
    assert_eq!(redundancies(&set, &[0.0; 4], &NewtonOptions::default())?, []);
    let found = redundancies(&set, &flat, &NewtonOptions::default())?;
    assert_eq!(found.iter().map(|f| f.1).collect::<Vec<_>>(), [Redundancy::OnlyHere]);
    Ok(())
}
