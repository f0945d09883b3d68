//! Single changes: in full segments, with an outdated evaluation, and invalid ones.

use qless_constraints::types::{Distance, Driven, Equal, Point, Prescribed};
use qless_constraints::{ConstraintId, ConstraintSet, EditError, Evaluation, LineariseError, ReplaceError};

use super::recipe::{DOFS, Random, point};
use super::run::bits;
use crate::common::Outcome;

/// A rod or an equal DOF between consecutive nodes.
fn chain(nodes: usize, is_rod: impl Fn(usize) -> bool) -> Outcome<(ConstraintSet, Vec<ConstraintId>)> {
    let mut builder = ConstraintSet::builder(DOFS * nodes);
    let add = |node: usize| {
        if is_rod(node) {
            return Ok(builder.add("rod", rod(node))?);
        }
        Ok(builder.add("tie", Equal::new([DOFS * node, DOFS * node + DOFS]))?)
    };
    let ids = (0..nodes - 1).map(add).collect::<Outcome<_>>()?;
    Ok((builder.build()?, ids))
}

fn rod(node: usize) -> Distance<Point> {
    Distance { length: Some(1.0 + (node % 7) as f64), ..Distance::new(point(node), point(node + 1)) }
}

/// New constraints of a type are stored with others of that type, also in full segments.
#[test]
fn full_segments_take_what_comes_between() -> Outcome {
    let (nodes, mut random) = (5000, Random(3));
    let (mut set, ids) = chain(nodes, |node| node.is_multiple_of(2))?;
    let mut is_rod: Vec<bool> = (0..nodes).map(|node| node.is_multiple_of(2)).collect();
    let mut evaluation = set.allocate();
    for _ in 0..4 {
        for _ in 0..1000 {
            let node = random.below(nodes - 1);
            is_rod[node] = true;
            set.replace(ids[node], rod(node))?;
        }
        let fresh = chain(nodes, |node| is_rod[node])?.0;
        let u: Vec<f64> = (0..DOFS * nodes).map(|_| random.number()).collect();
        let w: Vec<f64> = (0..nodes - 1).map(|_| random.number()).collect();
        let mut expected = fresh.allocate();
        fresh.assemble(&u, &w, &mut expected)?;
        set.assemble(&u, &w, &mut evaluation)?;
        assert!(bits(evaluation.c()) == bits(expected.c()));
        for (found, expected) in [(evaluation.g(), expected.g()), (evaluation.h(), expected.h())] {
            assert_eq!((found.starts(), found.columns()), (expected.starts(), expected.columns()));
            assert!(bits(found.values()) == bits(expected.values()));
        }
    }
    Ok(())
}

/// An evaluation from before a change is not accepted after it.
#[test]
fn numbers_from_before_a_change_are_refused() -> Outcome {
    let mut builder = ConstraintSet::builder(12);
    let rod = builder.add("rod", Distance::new(point(0), point(1)))?;
    let clamp = builder.add("clamp", Prescribed::fixed([0, 1]))?;
    let mut set = builder.build()?;
    let mut evaluation = set.allocate();
    let outdated = |set: &ConstraintSet, evaluation: &Evaluation| {
        matches!(set.linearised(evaluation, &[]), Err(LineariseError::Argument(_)))
    };
    assert!(outdated(&set, &evaluation), "never evaluated");
    set.evaluate(&[0.1; 12], &mut evaluation)?;
    assert!(!outdated(&set, &evaluation));
    set.deactivate(rod)?;
    assert!(outdated(&set, &evaluation));
    set.evaluate(&[0.1; 12], &mut evaluation)?;
    assert_eq!(set.linearised(&evaluation, &[])?.equations(), 2);
    set.set_rhs(clamp, &[1.0, 2.0])?;
    assert!(outdated(&set, &evaluation));
    set.evaluate(&[0.1; 12], &mut evaluation)?;
    set.activate(rod)?;
    // Only H is new; c and G are outdated.
    set.effective_hessian(&[0.1; 12], &[0.0; 3], &mut evaluation)?;
    assert!(outdated(&set, &evaluation));
    Ok(())
}

/// Misuse (other sets, wrong lengths, numbers that are not finite, refused constraints) leaves the set unchanged.
#[test]
fn changes_that_cannot_be_are_refused() -> Outcome {
    let (mut builder, mut others) = (ConstraintSet::builder(6), ConstraintSet::builder(6));
    let tie = builder.add("tie", Equal::new([0, 1, 2]))?;
    let slope = builder.add("root", Driven::new([(0, 1.0)], |t| (1.0 + t).sqrt()))?;
    let foreign = others.add("tie", Equal::new([0, 1]))?;
    let (mut set, other) = (builder.build()?, others.build()?);
    let mut evaluation = set.allocate();
    set.evaluate(&[0.5; 6], &mut evaluation)?;
    let before = evaluation.clone();
    assert_eq!(set.remove(foreign), Err(EditError::Foreign));
    assert_eq!(set.deactivate(foreign), Err(EditError::Foreign));
    assert!(matches!(set.set_rhs(tie, &[1.0]), Err(EditError::Count { found: 1, expected: 2, .. })));
    let refused = set.set_rhs(tie, &[1.0, f64::NAN]).expect_err("no number");
    assert!(refused.to_string().contains("tie"), "{refused}");
    let refused = set.replace(tie, Equal::new([0, 9])).expect_err("no such DOF");
    assert!(matches!(&refused, ReplaceError::Add(_)) && refused.to_string().contains("tie"), "{refused}");
    set.evaluate(&[0.5; 6], &mut evaluation)?;
    assert_eq!(evaluation, before);
    assert!(other.rows_of(tie).is_err() && other.linearised(&evaluation, &[]).is_err());

    // An inactive constraint is evaluated when it is activated, not when time advances.
    set.deactivate(slope)?;
    set.set_time(-3.0)?;
    let refused = set.activate(slope).expect_err("no root");
    assert!(matches!(&refused, EditError::Time(_)) && refused.to_string().contains("root"), "{refused}");
    assert!(!set.is_active(slope)?);
    set.set_rhs(slope, &[0.25])?;
    set.activate(slope)?;
    set.evaluate(&[0.5; 6], &mut evaluation)?;
    assert_eq!((evaluation.c(), set.constraints()), ([0.0, 0.0, 0.25].as_slice(), 2));
    set.remove(slope)?;
    assert_eq!(set.remove(slope), Err(EditError::Gone { place: 1 }));
    assert_eq!((set.constraints(), set.equations()), (1, 2));
    Ok(())
}
