//! Numbers by constraint while constraints come and go; constraints at rest; inequalities.

use qless_constraints::types::{Body, Distance, Driven, Fixed, LinearEquation, PlanarPoint, Prescribed, RotationMotor};
use qless_constraints::{AddError, ConstraintSet, EditError, EquationError, Inequalities, InequalityError};

use crate::common::Outcome;

fn rod(i: usize) -> Distance<PlanarPoint> {
    let point = |i: usize| PlanarPoint::new([2 * i, 2 * i + 1], [i as f64, 0.0]);
    Distance::new(point(i), point(i + 1))
}

/// Rows shift; what belongs to a constraint does not.
#[test]
fn numbers_stay_with_their_constraints() -> Outcome {
    let mut builder = ConstraintSet::builder(8);
    let rods = [0, 1, 2].map(|i| builder.add(format!("rod {i}"), rod(i)).expect("valid"));
    let clamp = builder.add("clamp", Prescribed::fixed([0, 1]))?;
    let mut set = builder.build()?;
    let numbers = set.by_constraint(&[10.0, 11.0, 0.0, 1.0, 2.0])?;
    let all = rods.map(|rod| numbers.of(rod).to_vec());
    assert_eq!((all, numbers.of(clamp)), ([vec![0.0], vec![1.0], vec![2.0]], [10.0, 11.0].as_slice()));
    set.deactivate(rods[0])?;
    set.deactivate(clamp)?;
    set.add("late", Prescribed::fixed([7]))?;
    assert_eq!(numbers.in_rows(&set)?, [0.0, 1.0, 2.0]);
    assert_eq!(numbers.of(rods[0]), [0.0]);
    set.activate(clamp)?;
    assert_eq!(numbers.in_rows(&set)?, [10.0, 11.0, 0.0, 1.0, 2.0]);
    // Another number of equations is another constraint.
    set.replace(clamp, Prescribed::fixed([0]))?;
    assert_eq!(numbers.in_rows(&set)?, [0.0, 0.0, 1.0, 2.0]);
    let other = ConstraintSet::builder(8).build()?;
    assert!(numbers.in_rows(&other).is_err() && set.by_constraint(&[0.0]).is_err());
    Ok(())
}

/// Linear and nonlinear constraints have the same values at rest as in action, at any time.
#[test]
fn constraints_at_rest_have_values() -> Outcome {
    let mut builder = ConstraintSet::builder(14);
    let body = Body::with_vector([8, 9, 10], [0.0; 3], [11, 12, 13]);
    let ids = [
        builder.add("rod", rod(1))?,
        builder.add("clamp", Prescribed { values: vec![(0, 0.5), (3, -0.5)] })?,
        builder.add("ramp", Driven::new([(1, 2.0)], |t| 3.0 * t))?,
        builder.add("motor", RotationMotor::new(Body::ground(), body, [0.0, 0.6, 0.8], |t| 0.1 * t))?,
    ];
    let mut set = builder.build()?;
    let u: Vec<f64> = (0..14).map(|j| f64::from(j * j % 7) / 10.0).collect();
    for time in [0.0, 2.0, -1.0] {
        let mut values = Vec::new();
        set.set_time(time)?;
        for rests in [false, true] {
            ids.iter().try_for_each(|&id| if rests { set.deactivate(id) } else { set.activate(id) })?;
            set.set_time(time)?;
            let mut evaluation = set.allocate();
            set.evaluate(&u, &mut evaluation)?;
            assert_eq!(evaluation.c().len(), if rests { 0 } else { 5 });
            values.push(ids.iter().map(|&id| set.values_of(id, &evaluation)).collect::<Result<Vec<_>, _>>()?.concat());
        }
        let off = values[0].iter().zip(&values[1]).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(values[0].len() == 5 && values[1].len() == 5 && off < 1e-15, "{time}: {values:?}");
    }
    let root = set.add("root", Driven::new([(0, 1.0)], |t: f64| (t + 2.0).sqrt()))?;
    set.deactivate(root)?;
    set.set_time(-5.0)?;
    let mut evaluation = set.allocate();
    assert!(matches!(set.values_of(root, &evaluation), Err(EditError::Argument(_))), "it was never evaluated");
    set.evaluate(&u, &mut evaluation)?;
    assert!(matches!(set.values_of(root, &evaluation), Err(EditError::Time(_))));
    Ok(())
}

/// A problem that is not positive definite: `p = u`, so that neither open nor closed is right. The step refuses it instead of going round.
#[test]
fn an_active_set_that_returns_is_refused() -> Outcome {
    let mut set = ConstraintSet::builder(1).build()?;
    let mut floor = Inequalities::default();
    floor.add(&mut set, "floor", LinearEquation { terms: vec![(0, 1.0)], rhs: 0.0 })?;
    let mut calls = 0;
    let found = floor.solve(&mut set, |set| {
        calls += 1;
        let closed = set.equations() == 1;
        let lambda = vec![1.0; set.equations()];
        Ok::<_, InequalityError>((vec![if closed { 0.0 } else { -1.0 }], set.by_constraint(&lambda)?))
    });
    assert!(matches!(&found, Err(InequalityError::Cycle { labels }) if labels == &["floor"]), "{found:?}");
    assert!(calls < 8, "{calls} equilibria");
    let two = floor.add(&mut set, "two", Prescribed::fixed([0, 0]));
    assert!(two.is_ok(), "one DOF is one equation");
    let refused = floor.add(&mut set, "none", Driven { terms: Vec::new(), rhs: std::sync::Arc::new(|_| 0.0) });
    assert!(matches!(refused, Err(AddError::Input { .. })), "{refused:?}");
    let mut wide = ConstraintSet::builder(2).build()?;
    let refused = Inequalities::default().add(&mut wide, "pair", Prescribed::fixed([0, 1]));
    assert!(
        matches!(refused, Err(AddError::Equation { source: EquationError::NotOne { found: 2 }, .. })),
        "{refused:?}"
    );
    assert_eq!(wide.constraints(), 0);
    Ok(())
}

/// A constraint that is replaced at rest has the values that it has in action, in the same order; a constant right-hand side mends a function.
#[test]
fn constraints_change_at_rest() -> Outcome {
    let mut set = ConstraintSet::builder(14).build()?;
    let body = Body::with_vector([8, 9, 10], [0.0; 3], [11, 12, 13]);
    // The set meets the motor before the ball joint.
    set.add("motor", RotationMotor::new(Body::ground(), body, [0.0, 0.6, 0.8], |t| 0.1 * t))?;
    let id = set.add("root", Driven::new([(0, 1.0)], |t: f64| (t + 2.0).sqrt()))?;
    let mut evaluation = set.allocate();
    let u: Vec<f64> = (0..14).map(|j| f64::from(j * j % 7) / 10.0).collect();
    set.deactivate(id)?;
    set.set_time(-5.0)?;
    set.evaluate(&u, &mut evaluation)?;
    assert!(set.values_of(id, &evaluation).is_err());
    set.set_rhs(id, &[0.25])?;
    set.evaluate(&u, &mut evaluation)?;
    assert_eq!(set.values_of(id, &evaluation)?, [-0.25]);
    set.replace(id, Fixed { a: Body::ground(), b: body, at: [0.3, 0.1, 0.2] })?;
    set.evaluate(&u, &mut evaluation)?;
    let resting = set.values_of(id, &evaluation)?;
    set.activate(id)?;
    set.evaluate(&u, &mut evaluation)?;
    let off = resting.iter().zip(set.values_of(id, &evaluation)?).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(resting.len() == 6 && off < 1e-14, "{resting:?}");
    Ok(())
}
