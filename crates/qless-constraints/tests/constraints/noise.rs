//! Rows of G that are rounding do not count for the rank; rows that are small for other reasons do.

use std::error::Error;
use std::f64::consts::TAU;

use qless::{Options, analyse};
use qless_constraints::types::{
    Body, Distance, Fixed, Line, LinearEquation, OnLine, PlanarPoint, Point, Prismatic, Revolute, Universal,
};
use qless_constraints::{Constraint, ConstraintSet, EquationSink, LineariseError, Nonlinear};

type Outcome = Result<(), Box<dyn Error>>;

/// Rank of G at u, and the labels of vanishing rows.
fn rank(set: &ConstraintSet, u: &[f64]) -> Result<(usize, Vec<String>), Box<dyn Error>> {
    let mut evaluation = set.allocate();
    set.evaluate(u, &mut evaluation)?;
    let analysis = analyse(&set.linearised(&evaluation, &[])?, &Options::default())?;
    let vanishing = set.vanishing(&evaluation)?.into_iter().map(|found| found.label).collect();
    Ok((analysis.rank(), vanishing))
}

/// A body on the ground, held by one joint.
fn held<C: Constraint>(joint: impl Fn(Body) -> C) -> Result<ConstraintSet, Box<dyn Error>>
where
    C::Error: 'static,
{
    let mut builder = ConstraintSet::builder(6);
    builder.add("joint", joint(Body::with_vector([0, 1, 2], [0.3, -0.2, 0.5], [3, 4, 5])))?;
    Ok(builder.build()?)
}

/// At a rotation vector of whole turns, only the rotation along it is possible: rank 3 + 1, 3 + 1 or 3, 2 + 1, 3 + 1 or 3.
#[test]
fn after_a_turn_a_rotation_vector_reaches_one_turn() -> Outcome {
    let (a, at) = (Body::ground(), [0.3, -0.2, 0.5]);
    let weld = held(|b| Fixed { a, b, at })?;
    let hinge = held(|b| Revolute { a, b, at, axis: [0.0, 0.0, 1.0] })?;
    let slider = held(|b| Prismatic { a, b, at, axis: [0.0, 0.0, 1.0] })?;
    let cross = held(|b| Universal { a, b, at, axis_a: [1.0, 0.0, 0.0], axis_b: [0.0, 1.0, 0.0] })?;
    for turns in [-2.0, -1.0, 1.0, 2.0, 5.0] {
        for axis in 0..3 {
            let mut u = [0.0; 6];
            u[3 + axis] = turns * TAU;
            let along_z = usize::from(axis == 2);
            assert_eq!(rank(&weld, &u)?.0, 4, "weld, {u:?}");
            // The hinge allows the turn about z; the cross prevents only that.
            assert_eq!(rank(&hinge, &u)?.0, 4 - along_z, "hinge, {u:?}");
            assert_eq!(rank(&slider, &u)?.0, 3, "slider, {u:?}");
            assert_eq!(rank(&cross, &u)?.0, 3 + along_z, "cross, {u:?}");
        }
    }
    Ok(())
}

/// At any other angle no row vanishes.
#[test]
fn no_row_vanishes_on_the_way() -> Outcome {
    let weld = held(|b| Fixed { a: Body::ground(), b, at: [0.3, -0.2, 0.5] })?;
    for k in 0..200 {
        let angle = 0.03 * f64::from(k);
        let u = [0.0, 0.0, 0.0, 0.48 * angle, 0.6 * angle, -0.64 * angle];
        assert_eq!(rank(&weld, &u)?.1, Vec::<String>::new(), "angle {angle}");
    }
    Ok(())
}

/// A rod of any length, far away and in any unit, has a direction as long as it is known.
#[test]
fn small_rods_and_far_rods_are_no_noise() -> Outcome {
    for unit in [1e-12, 1e-6, 1.0, 1e6, 1e12, 1e-36] {
        for (at, length, alive) in [(0.0, 1.0, true), (1.0, 1e-3, true), (1e6, 1e-3, true), (1e9, 1e-8, false)] {
            let end = |dofs, x: f64| PlanarPoint::new(dofs, [unit * x, unit * at]);
            let mut builder = ConstraintSet::builder(4);
            let (a, b) = (end([0, 1], at), end([2, 3], at + length));
            builder.add("rod", Distance { a, b, length: Some(unit * length) })?;
            let (rank, vanishing) = rank(&builder.build()?, &[0.0; 4])?;
            assert_eq!((rank, vanishing.len()), (usize::from(alive), usize::from(!alive)), "{unit} ({at}, {length})");
        }
    }
    Ok(())
}

/// If its ends coincide up to rounding, a rod has no direction, in any unit; folded to a thousandth, it has one.
#[test]
fn a_rod_whose_ends_meet_has_no_direction() -> Outcome {
    for unit in [1e-6, 1.0, 1e6] {
        let place = |node: usize, x: f64, y: f64| PlanarPoint::new([2 * node, 2 * node + 1], [unit * x, unit * y]);
        let mut builder = ConstraintSet::builder(4);
        builder.add("rod", Distance::new(place(0, 0.1, 0.2), place(1, 0.4, 0.6)))?;
        let set = builder.build()?;
        // 0.4 - 0.1 is not 0.3 but 0.30000000000000004.
        let meet = [0.0, 0.0, -0.3 * unit, -0.4 * unit];
        assert_eq!(rank(&set, &meet)?, (0, vec!["rod".to_owned()]), "unit {unit}");
        let near = meet.map(|u| u * 0.999);
        assert_eq!(rank(&set, &near)?, (1, Vec::new()), "unit {unit}");
        let mut evaluation = set.allocate();
        set.evaluate(&meet, &mut evaluation)?;
        let found = set.vanishing(&evaluation)?;
        assert!(found[0].entry <= found[0].rounding && !found[0].everywhere);
        // It is half its length too short, which no first-order step can change.
        assert!((found[0].value + 0.25 * unit).abs() < 1e-12 * unit, "{:?}", found[0]);
        assert!(found[0].to_string().contains("\"rod\" has no effect at this configuration"), "{}", found[0]);
    }
    Ok(())
}

/// A vanishing row holds up to rounding: its right-hand side is zero, and nothing conflicts.
#[test]
fn noise_is_no_conflict() -> Outcome {
    let weld = held(|b| Fixed { a: Body::ground(), b, at: [0.3, -0.2, 0.5] })?;
    let mut evaluation = weld.allocate();
    weld.evaluate(&[0.0, 0.0, 0.0, 0.0, TAU, 0.0], &mut evaluation)?;
    let system = weld.linearised(&evaluation, &[])?;
    let empty: Vec<usize> = (0..6).filter(|&row| system.matrix().row(row).len() == 0).collect();
    let vanishing = weld.vanishing(&evaluation)?;
    assert_eq!(empty, vanishing.iter().map(|found| found.row).collect::<Vec<_>>());
    assert_eq!(empty.len(), 2);
    empty.iter().for_each(|&row| assert_eq!(system.rhs()[row], 0.0));
    Ok(())
}

/// Terms on one DOF that cancel up to rounding leave no coefficient.
#[test]
fn cancelled_terms_of_linear_equations_leave_nothing() -> Outcome {
    let mut builder = ConstraintSet::builder(2);
    builder.add("none", LinearEquation { terms: vec![(0, 0.1), (0, 0.2), (0, -0.3)], rhs: 0.0 })?;
    builder.add("some", LinearEquation { terms: vec![(0, 0.1), (1, 1e-200), (0, -0.1)], rhs: 0.0 })?;
    let set = builder.build()?;
    assert_eq!(rank(&set, &[1.0; 2])?, (1, vec!["none".to_owned()]));
    let mut evaluation = set.allocate();
    set.evaluate(&[1.0; 2], &mut evaluation)?;
    let found = &set.vanishing(&evaluation)?[0];
    assert!(found.everywhere && found.to_string().contains("has no terms"), "{found}");
    Ok(())
}

/// `c = |x_b - x_a| - L` by a user: if the ends coincide, its slope is 0 / 0.
struct Length;

impl Nonlinear for Length {
    const EQUATION_NAMES: &'static [&'static str] = &[""];
    fn value<S: qless_constraints::scalar::Scalar>(&self, u: &[S], c: &mut [S]) {
        let (x, y) = (u[2] - u[0], u[3] - u[1]);
        c[0] = (x * x + y * y).sqrt() - S::from(1.0);
    }
}

impl Constraint for Length {
    const NAME: &'static str = "length";
    type Error = std::convert::Infallible;
    fn emit(self, sink: &mut EquationSink) -> Result<(), Self::Error> {
        sink.nonlinear("", &[0, 1, 2, 3], self);
        Ok(())
    }
}

/// Types of users need no bounds of rounding; values that are not finite are refused.
#[test]
fn types_of_users_have_bounds_too() -> Outcome {
    let mut builder = ConstraintSet::builder(4);
    builder.add("rod", Length)?;
    let set = builder.build()?;
    assert_eq!(rank(&set, &[0.0, 0.0, 0.6, 0.8])?.0, 1);
    // The ends are a few units in the last place apart: a unit direction that is rounding only.
    let meet = [0.1 + 0.2, 0.5, 0.3, 0.5];
    assert_eq!(rank(&set, &meet)?, (0, vec!["rod".to_owned()]));
    let mut evaluation = set.allocate();
    set.evaluate(&[0.5; 4], &mut evaluation)?;
    assert!(set.linearised(&evaluation, &[]).is_err(), "0 / 0 was taken for a coefficient");
    assert!(set.rounding(&[0.0; 3]).is_err());
    Ok(())
}

/// A point on a line through nodes, one of which coincides with the other: its row has no noise, at the origin and 1000 km away.
#[test]
fn bounds_do_not_depend_on_threads_and_scale_with_the_unit() -> Outcome {
    let make = |unit: f64| -> Result<ConstraintSet, Box<dyn Error>> {
        let mut builder = ConstraintSet::builder(3000);
        for i in 0..997 {
            let at = |k: usize| {
                let node = i + k;
                let place = [unit * (node * node % 17) as f64, unit * 0.3, unit * node as f64];
                Point::new([3 * node, 3 * node + 1, 3 * node + 2], place)
            };
            builder.add("bead", OnLine { point: at(0), line: Line::Nodes(at(1), at(2)) })?;
        }
        Ok(builder.build()?)
    };
    let u: Vec<f64> = (0..3000).map(|j| f64::from(j * j % 101) / 64.0).collect();
    let one = rayon_free(1, || make(1.0)?.rounding(&u).map_err(Into::into))?;
    assert_eq!(one, rayon_free(3, || make(1.0)?.rounding(&u).map_err(Into::into))?);
    // Powers of two are exact; e_i / L and a product of two lengths make c a length.
    let unit = 2_f64.powi(40);
    let large = make(unit)?.rounding(&u.iter().map(|u| unit * u).collect::<Vec<_>>())?;
    assert!(one.c().iter().zip(large.c()).all(|(a, b)| a * unit == *b));
    assert_eq!(one.g(), large.g());
    Ok(())
}

fn rayon_free<T: Send>(
    threads: usize,
    work: impl FnOnce() -> Result<T, Box<dyn Error>> + Send,
) -> Result<T, Box<dyn Error>> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
    pool.install(|| work().map_err(|error| error.to_string())).map_err(Into::into)
}

/// Its bound is infinite; it does not count as rounding.
#[test]
fn what_leaves_the_range_of_doubles_is_refused_not_taken_for_rounding() -> Outcome {
    let points = [PlanarPoint::new([0, 1], [0.0, 0.0]), PlanarPoint::new([2, 3], [1.0, 0.0])];
    let mut builder = ConstraintSet::builder(4);
    builder.add("rod", Distance::new(points[0], points[1]))?;
    let set = builder.build()?;
    let mut evaluation = set.allocate();
    for far in [1e160, 1e200, 1e308] {
        set.evaluate(&[far, 0.0, 0.0, 0.0], &mut evaluation)?;
        let refused = set.linearised(&evaluation, &[]);
        assert!(matches!(refused, Err(LineariseError::NotFinite { row: 0, .. })), "{far:e}: {refused:?}");
    }
    Ok(())
}
