use qless_constraints::scalar::Scalar;
use qless_constraints::types::{Body, Driven, LinearEquation, RotationMotor, TranslationMotor};
use qless_constraints::{
    AddError, Constraint, ConstraintSet, EditError, EquationError, EquationSink, Nonlinear, SetBuilder, TimeError,
};

use crate::common::Outcome;

/// `u^2 / 2 - t = 0`.
struct Half {
    time: f64,
}

impl Nonlinear for Half {
    const DOFS: usize = 1;
    const DRIVEN: bool = true;
    const EQUATION_NAMES: &'static [&'static str] = &[""];

    fn value<S: Scalar>(&self, u: &[S], c: &mut [S]) {
        c[0] = u[0] * u[0] * S::from(0.5) - S::from(self.time);
    }

    fn at_time(&mut self, time: f64) -> Result<(), f64> {
        self.time = time;
        Ok(())
    }
}

/// [`Half`] on DOF 0.
struct Square;

impl Constraint for Square {
    const NAME: &'static str = "square";
    type Error = std::convert::Infallible;

    fn emit(self, sink: &mut EquationSink) -> Result<(), Self::Error> {
        sink.nonlinear("", &[0], Half { time: f64::NAN });
        Ok(())
    }
}

/// Driven right-hand sides and parameters follow time, others stay, and time 0 is the start.
#[test]
fn numbers_are_those_of_the_time() -> Outcome {
    let mut builder = ConstraintSet::builder(2);
    builder.add("square", Square)?;
    builder.add("still", LinearEquation { terms: vec![(0, 1.0)], rhs: 0.25 })?;
    builder.add("piston", Driven::new([(0, 2.0), (1, -1.0)], |t| 3.0 + t * t))?;
    let mut set = builder.build()?;
    let mut evaluation = set.allocate();
    let u = [1.5, -2.0];
    for time in [0.0, -0.5, 7.0, 0.0] {
        set.set_time(time)?;
        set.evaluate(&u, &mut evaluation)?;
        assert_eq!(evaluation.c(), [1.25, 5.0 - (3.0 + time * time), 1.125 - time], "t = {time}");
        assert_eq!(set.time(), time);
    }
    Ok(())
}

/// If a time or a value is not finite, nothing changes, and the message names the equation.
#[test]
fn a_time_without_a_value_is_refused() -> Outcome {
    let mut builder = ConstraintSet::builder(1);
    builder.add("ramp", Driven::new([(0, 1.0)], |t| 2.0 * t))?;
    builder.add("root", Driven::new([(0, 1.0)], f64::sqrt))?;
    let refused = builder.add("pole", Driven::new([(0, 1.0)], |t| 1.0 / t)).expect_err("infinite at time 0");
    assert!(matches!(refused, AddError::Equation { source: EquationError::NotFinite { .. }, .. }), "{refused}");
    let mut set = builder.build()?;
    set.set_time(4.0)?;
    assert!(matches!(set.set_time(f64::INFINITY), Err(TimeError::Time(_))));
    let refused = set.set_time(-1.0).expect_err("no root");
    assert!(refused.to_string().contains("root") && refused.to_string().contains("time -1"), "{refused}");
    let mut evaluation = set.allocate();
    set.evaluate(&[0.0], &mut evaluation)?;
    assert_eq!((set.time(), evaluation.c()), (4.0, [-8.0, -2.0].as_slice()));
    Ok(())
}

/// A motor whose motion is not finite is refused like a right-hand side: at any time, when it is added, and when it is activated.
#[test]
fn a_motor_without_a_motion_is_refused() -> Outcome {
    let (ground, b) = (Body::ground(), Body::with_vector([0, 1, 2], [0.3; 3], [3, 4, 5]));
    let axis = [0.0, 0.6, 0.8];
    let root = |builder: &mut SetBuilder, turns: bool, last: f64| -> Outcome<_> {
        // Finite from `last - 4` on.
        let motion = move |t: f64| (t - last + 4.0).sqrt();
        Ok(if turns {
            builder.add("root", RotationMotor::new(ground, b, axis, motion))?
        } else {
            builder.add("root", TranslationMotor::new(ground, b, [0.0; 3], axis, motion))?
        })
    };
    for turns in [true, false] {
        let mut builder = ConstraintSet::builder(6);
        builder.add("ramp", Driven::new([(0, 1.0)], |t| 2.0 * t))?;
        builder.add("turn", RotationMotor::new(ground, b, axis, |t| t))?;
        assert!(root(&mut builder, turns, 5.0).is_err());
        let id = root(&mut builder, turns, 2.0)?;
        let mut set = builder.build()?;
        set.set_time(1.5)?;
        let u = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6];
        let (mut before, mut after) = (set.allocate(), set.allocate());
        set.evaluate(&u, &mut before)?;
        for time in [-3.0, f64::NAN, f64::INFINITY] {
            let refused = set.set_time(time).expect_err("no root");
            let names_it = refused.to_string().contains("root") && refused.to_string().contains("time -3");
            assert!(names_it || !time.is_finite(), "{refused}");
            set.evaluate(&u, &mut after)?;
            assert_eq!((set.time(), before.c()), (1.5, after.c()));
        }
        set.deactivate(id)?;
        set.set_time(-3.0)?;
        let refused = set.activate(id).expect_err("no root");
        assert!(
            matches!(&refused, EditError::Time(TimeError::NotFinite { label, .. }) if label == "root"),
            "{refused}"
        );
        assert!(!set.is_active(id)?);
        set.set_time(1.5)?;
        set.activate(id)?;
        set.evaluate(&u, &mut after)?;
        assert_eq!(before.c(), after.c());
    }
    Ok(())
}
