//! All constraints must say the same of one DOF, and Euler parameters keep their length without being asked.

use qless_constraints::types::{Body, Distance, Fixed, Point, Prescribed, Revolute, RigidBody, Spherical};
use qless_constraints::{AddError, Constraint, ConstraintSet, EquationError, ReplaceError};

use crate::common::Outcome;

const PIN: [f64; 3] = [1.0, 0.0, 0.0];

fn arm(at: [f64; 3]) -> Body {
    Body::with_vector([0, 1, 2], at, [3, 4, 5])
}

fn hinge(b: Body) -> Revolute {
    Revolute { a: Body::ground(), b, at: PIN, axis: [0.0, 0.0, 1.0] }
}

/// The fault of a constraint after a hinge of the arm at 0.5.
fn second<C: Constraint>(constraint: C) -> Option<EquationError> {
    let mut builder = ConstraintSet::builder(20);
    builder.add("door", hinge(arm([0.5, 0.0, 0.0]))).expect("valid");
    match builder.add("other", constraint).err()? {
        AddError::Equation { source, label, .. } => {
            assert_eq!(label, "other");
            Some(source)
        }
        other => panic!("{other}"),
    }
}

#[test]
fn a_body_with_two_places_is_refused() {
    let refused = second(Spherical { a: Body::ground(), b: arm([0.6, 0.0, 0.0]), at: PIN }).expect("another place");
    let expected = EquationError::TwoPlaces { dof: 0, here: 0.6, other: "door".into(), there: 0.5 };
    assert_eq!(refused, expected);
    let said = refused.to_string();
    assert!(["DOF 0", "0.6", "\"door\"", "0.5"].iter().all(|part| said.contains(part)), "{said}");
    // Coordinates that differ by rounding are the same place; a node is a body without rotations.
    assert_eq!(second(hinge(arm([0.5 * (1.0 + f64::EPSILON), 0.0, 0.0]))), None);
    let rod = |at| Distance::new(Point::new([0, 1, 2], at), Point::new([6, 7, 8], [3.0, 0.0, 0.0]));
    assert_eq!(second(rod([0.5, 0.0, 0.0])), None);
    assert!(matches!(second(rod([0.5, 1e-9, 0.0])), Some(EquationError::TwoPlaces { dof: 1, .. })));
    let link = RigidBody { body: arm([0.5, 0.1, 0.0]), nodes: vec![Point::new([6, 7, 8], PIN).into()] };
    assert!(matches!(second(link), Some(EquationError::TwoPlaces { dof: 1, .. })));
}

#[test]
fn a_dof_with_two_rotations_or_two_uses_is_refused() {
    let at = [0.5, 0.0, 0.0];
    let ball = |b| Spherical { a: Body::ground(), b, at: PIN };
    for other in [
        Body::with_euler([0, 1, 2], at, [3, 4, 5, 6]),
        Body::with_vector([0, 1, 2], at, [5, 4, 3]),
        Body::with_vector([10, 11, 12], at, [4, 5, 6]),
    ] {
        let refused = second(ball(other));
        assert!(matches!(&refused, Some(EquationError::TwoRotations { other, .. }) if other == "door"), "{refused:?}");
    }
    for other in [Body::with_vector([3, 4, 5], at, [6, 7, 8]), Body::with_vector([10, 11, 12], at, [0, 1, 2])] {
        let refused = second(ball(other));
        assert!(matches!(&refused, Some(EquationError::TwoUses { other, .. }) if other == "door"), "{refused:?}");
    }
    let rod = Distance::new(Point::new([3, 4, 5], at), Point::new([6, 7, 8], PIN));
    assert!(matches!(second(rod), Some(EquationError::TwoUses { dof: 3, .. })));
}

/// Nothing is added by a refused call, and a place is free again when nobody states it.
#[test]
fn refusals_leave_nothing_behind() -> Outcome {
    let mut set = ConstraintSet::builder(6).build()?;
    let other = arm([0.7, 0.0, 0.0]);
    let door = set.add("door", hinge(arm([0.5, 0.0, 0.0])))?;
    for count in [3, 5000] {
        let refused =
            set.add_all("pin", count, |i| if i == count - 1 { hinge(other) } else { hinge(arm([0.5, 0.0, 0.0])) });
        let refused = refused.expect_err("the last one has another place").to_string();
        assert!(refused.contains(&format!("pin {}", count - 1)) && refused.contains("door"), "{refused}");
        assert_eq!((set.constraints(), set.equations()), (1, 5));
    }
    // Two copies within one call.
    let refused = set.add_all("pin", 2, |i| hinge(arm([0.5, 0.1 * i as f64, 0.0])));
    assert!(refused.is_err() && set.constraints() == 1);
    set.deactivate(door)?;
    assert!(set.add("pin", hinge(other)).is_err(), "a constraint at rest is still about the body");
    let refused =
        set.replace(door, Fixed { a: Body::ground(), b: Body::with_euler([0, 1, 2], PIN, [2, 3, 4, 5]), at: PIN });
    assert!(matches!(refused, Err(ReplaceError::Add(_))), "{refused:?}");
    // A constraint may correct its own statement.
    set.replace(door, hinge(other))?;
    assert!(set.add("pin", hinge(arm([0.5, 0.0, 0.0]))).is_err());
    set.remove(door)?;
    set.add("pin", hinge(arm([0.5, 0.0, 0.0])))?;
    Ok(())
}

/// One equation of length for each body with Euler parameters, from its first constraint to its last, whatever comes and goes.
#[test]
fn euler_parameters_keep_their_length() -> Outcome {
    let body = |i: usize| {
        let first = 7 * i;
        Body::with_euler([first, first + 1, first + 2], PIN, [first + 3, first + 4, first + 5, first + 6])
    };
    let mut set = ConstraintSet::builder(14).build()?;
    let lengths = |set: &ConstraintSet| -> Outcome<usize> {
        let labels = (0..set.equations()).map(|row| set.label(row)).collect::<Result<Vec<_>, _>>()?;
        Ok(labels.iter().filter(|label| label.starts_with("length of Euler parameters")).count())
    };
    let ground = set.add("ground", hinge(body(0)))?;
    assert_eq!((set.equations(), lengths(&set)?), (6, 1));
    let pins = set.add_all("pin", 3, |_| Spherical { a: body(0), b: body(1), at: [0.2; 3] })?;
    assert_eq!((set.equations(), lengths(&set)?), (6 + 3 * 3 + 1, 2));
    let mut evaluation = set.allocate();
    let mut u = vec![0.0; 14];
    (u[3], u[4]) = (-0.4, 0.8);
    (u[10], u[12]) = (0.1, 0.3);
    set.evaluate(&u, &mut evaluation)?;
    let of = |part: &str| (0..set.equations()).find(|&row| set.label(row).is_ok_and(|label| label.ends_with(part)));
    let [first, second] = ["DOFs 3 to 6", "DOFs 10 to 13"].map(|part| of(part).map(|row| evaluation.c()[row]));
    assert!(first.is_some_and(|c| c.abs() < 1e-15) && second == Some(0.1 + 0.005 + 0.045));
    set.deactivate(ground)?;
    pins.iter().try_for_each(|pin| set.deactivate(pin))?;
    assert_eq!((set.equations(), lengths(&set)?), (2, 2), "bodies remain when their joints rest");
    pins.iter().try_for_each(|pin| set.remove(pin))?;
    assert_eq!(lengths(&set)?, 1);
    set.replace(ground, Prescribed::fixed([0]))?;
    assert_eq!((lengths(&set)?, set.constraints()), (0, 1));
    set.replace(ground, hinge(body(1)))?;
    set.activate(ground)?;
    assert_eq!((set.equations(), lengths(&set)?), (6, 1));
    Ok(())
}
