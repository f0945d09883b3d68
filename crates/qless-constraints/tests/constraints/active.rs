use qless::{Kind, Options, analyse};
use qless_constraints::types::{Distance, Equal, LinearEquation, PlanarPoint, Prescribed};
use qless_constraints::{ActiveError, ActiveSystem, ConstraintSet};

use crate::common::Outcome;

/// Random activation and deactivation in a lattice of rods with ties: rank and solvability agree with an analysis of all equations, and
/// expanded solutions satisfy the independent ones.
#[test]
fn rank_follows_the_active_constraints() -> Outcome {
    let side = 7;
    let dofs = 2 * side * side;
    let point =
        |i: usize| PlanarPoint::new([2 * i, 2 * i + 1], [(i % side) as f64, (i / side) as f64 + 0.1 * (i % 3) as f64]);
    let mut builder = ConstraintSet::builder(dofs);
    let mut ids = Vec::new();
    for i in 0..side * side {
        for j in [i + 1, i + side, i + side + 1]
            .into_iter()
            .filter(|j| j / side <= i / side + 1 && *j < side * side && j % side >= i % side)
        {
            ids.push(builder.add(format!("rod {i} {j}"), Distance::new(point(i), point(j)))?);
        }
        ids.push(builder.add(format!("tie {i}"), Equal::new([2 * i, (2 * i + 5) % dofs]))?);
        ids.push(builder.add(format!("clamp {i}"), Prescribed::fixed([2 * i, 2 * i + 1]))?);
    }
    let mut set = builder.build()?;
    let (mut evaluation, mut system) = (set.allocate(), ActiveSystem::new(&set, Options::default())?);
    let (mut seed, mut untouched) = (5_usize, 0);
    for step in 0..60 {
        for _ in 0..if step == 0 { 250 } else { 3 } {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let id = ids[(seed >> 33) % ids.len()];
            match (set.is_active(id)?, step) {
                (true, _) => set.deactivate(id)?,
                (false, 1..) => set.activate(id)?,
                _ => (),
            }
        }
        set.evaluate(&vec![0.0; dofs], &mut evaluation)?;
        let done = system.update(&set, &evaluation)?;
        untouched += usize::from(done < system.system().blocks().count());
        let whole = analyse(&set.linearised(&evaluation, &[])?, &Options::default())?;
        assert_eq!(system.rank(), whole.rank(), "step {step}");
        let mut du: Vec<f64> = (0..dofs).map(|j| (j * j % 11) as f64).collect();
        system.expand(&mut du)?;
        for (row, c) in evaluation.c().iter().enumerate() {
            let terms = || evaluation.g().row(row).map(|(j, v)| v * du[j]);
            // Lengths of the lattice are about 1.
            let size = evaluation.g().row(row).map(|(j, v)| v.abs() * du[j].abs().max(1.0)).sum::<f64>();
            let rest = (terms().sum::<f64>() + c).abs();
            assert!(rest <= 1e-10 * size, "step {step}, {}: {rest} of {size}", set.label(row)?);
        }
        let independent = (0..set.equations()).filter(|&row| system.kind(row) == Some(Kind::Independent)).count();
        assert_eq!(independent, whole.rank());
        assert_eq!(system.system().equations(), set.equations());
    }
    assert!(untouched > 10, "updates did everything anew");
    Ok(())
}

/// A change costs its own block; without a change there is no work; misuse is refused.
#[test]
fn only_what_changed_is_done_again() -> Outcome {
    let blocks = 2000;
    let mut builder = ConstraintSet::builder(3 * blocks);
    let ring = |b: usize, k: usize| Equal::new([3 * b + k, 3 * b + (k + 1) % 3]);
    let mut ids = Vec::new();
    for b in 0..blocks {
        for k in 0..3 {
            ids.push(builder.add(format!("ring {b}"), ring(b, k))?);
        }
    }
    let mut set = builder.build()?;
    let (mut evaluation, mut system) = (set.allocate(), ActiveSystem::new(&set, Options::default())?);
    let u = vec![0.0; set.dofs()];
    assert!(matches!(system.update(&set, &evaluation), Err(ActiveError::Argument(_))), "never evaluated");
    set.evaluate(&u, &mut evaluation)?;
    assert_eq!((system.update(&set, &evaluation)?, system.rank()), (blocks, 2 * blocks));
    assert_eq!(system.update(&set, &evaluation)?, 0);
    set.deactivate(ids[3000])?;
    set.remove(ids[3005])?;
    set.replace(ids[0], LinearEquation { terms: vec![(0, 2.0), (1, -1.0)], rhs: 0.0 })?;
    set.add("new", Prescribed { values: vec![(30, 1.0)] })?;
    set.evaluate(&u, &mut evaluation)?;
    assert_eq!((system.update(&set, &evaluation)?, system.rank()), (4, 2 * blocks + 2));
    set.activate(ids[3000])?;
    set.set_rhs(ids[9], &[0.5])?;
    set.evaluate(&u, &mut evaluation)?;
    assert_eq!(system.update(&set, &evaluation)?, 2);
    let conflicting = (0..set.equations()).filter(|&row| system.kind(row) == Some(Kind::Conflicting));
    assert_eq!(conflicting.map(|row| set.label(row)).collect::<Result<Vec<_>, _>>()?, ["ring 3"]);
    let mut other = ConstraintSet::builder(3 * blocks);
    other.add("ring", ring(0, 0))?;
    let other = other.build()?;
    let mut foreign = other.allocate();
    other.evaluate(&u, &mut foreign)?;
    assert!(system.update(&other, &foreign).is_err() && system.update(&set, &foreign).is_err());
    let mut wide = u.clone();
    wide[0] = f64::NAN;
    set.evaluate(&wide, &mut evaluation)?;
    let refused = system.update(&set, &evaluation).expect_err("not finite");
    assert!(refused.to_string().contains("ring 0"), "{refused}");
    Ok(())
}

/// An equation without terms, whose row of G vanishes, is a block without DOFs; the others are expanded as usual.
#[test]
fn equations_without_terms_do_not_hinder_the_others() -> Outcome {
    let mut builder = ConstraintSet::builder(4);
    builder.add("tie", Equal::new([0, 1]))?;
    builder.add("nothing", LinearEquation { terms: vec![(2, 1.0), (2, -1.0)], rhs: 0.0 })?;
    let points = [PlanarPoint::new([0, 1], [0.0, 0.0]), PlanarPoint::new([2, 3], [1.0, 0.0])];
    builder.add("rod", Distance { a: points[0], b: points[1], length: Some(1.0) })?;
    let set = builder.build()?;
    let (mut evaluation, mut system) = (set.allocate(), ActiveSystem::new(&set, Options::default())?);
    // The ends of the rod coincide, so that its row vanishes.
    set.evaluate(&[0.5, 0.0, -0.5, 0.0], &mut evaluation)?;
    system.update(&set, &evaluation)?;
    assert_eq!(set.vanishing(&evaluation)?.len(), 2);
    let mut du = [1.0, 3.0, 5.0, 7.0];
    system.expand(&mut du)?;
    assert!((0.5 + du[0] - du[1]).abs() < 1e-15 && du[2..] == [5.0, 7.0], "{du:?}");
    Ok(())
}
