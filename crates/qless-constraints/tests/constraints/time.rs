use qless_constraints::scalar::Scalar;
use qless_constraints::types::{Driven, LinearEquation};
use qless_constraints::{AddError, Constraint, ConstraintSet, Nonlinear, Store, StoreError, TimeError};

use crate::linkages::Outcome;

/// `u^2 / 2 - t = 0`.
struct Half {
    time: f64,
}

impl Nonlinear for Half {
    const DOFS: usize = 1;
    const DRIVEN: bool = true;
    const PARTS: &'static [&'static str] = &[""];

    fn value<S: Scalar>(&self, u: &[S], c: &mut [S]) {
        c[0] = u[0] * u[0] * S::from(0.5) - S::from(self.time);
    }

    fn at_time(&mut self, time: f64) {
        self.time = time;
    }
}

/// [`Half`] on DOF 0.
struct Square;

impl Constraint for Square {
    const NAME: &'static str = "square";
    type Error = std::convert::Infallible;

    fn process(self, store: &mut Store) -> Result<(), Self::Error> {
        store.nonlinear("", &[0], Half { time: f64::NAN });
        Ok(())
    }
}

/// Right-hand sides and parameters follow time, what is not driven stays, and time 0 is the start.
#[test]
fn numbers_are_those_of_the_time() -> Outcome {
    let mut builder = ConstraintSet::builder(2);
    builder.add("square", Square)?;
    builder.add("still", LinearEquation { terms: vec![(0, 1.0)], rhs: 0.25 })?;
    builder.add("piston", Driven::new([(0, 2.0), (1, -1.0)], |t| 3.0 + t * t))?;
    let mut set = builder.build()?;
    let mut quantities = set.allocate();
    let u = [1.5, -2.0];
    for time in [0.0, -0.5, 7.0, 0.0] {
        set.set_time(time)?;
        set.evaluate(&u, &mut quantities)?;
        assert_eq!(quantities.c(), [1.25, 5.0 - (3.0 + time * time), 1.125 - time], "t = {time}");
        assert_eq!(set.time(), time);
    }
    Ok(())
}

/// A time, or a value then, that is no number: nothing changes, and the message says which equation it is.
#[test]
fn a_time_without_a_value_is_refused() -> Outcome {
    let mut builder = ConstraintSet::builder(1);
    builder.add("ramp", Driven::new([(0, 1.0)], |t| 2.0 * t))?;
    builder.add("root", Driven::new([(0, 1.0)], f64::sqrt))?;
    let refused = builder.add("pole", Driven::new([(0, 1.0)], |t| 1.0 / t)).expect_err("infinite at time 0");
    assert!(matches!(refused, AddError::Store { source: StoreError::NotFinite { .. }, .. }), "{refused}");
    let mut set = builder.build()?;
    set.set_time(4.0)?;
    assert!(matches!(set.set_time(f64::INFINITY), Err(TimeError::Time(_))));
    let refused = set.set_time(-1.0).expect_err("no root");
    assert!(refused.to_string().contains("root") && refused.to_string().contains("time -1"), "{refused}");
    let mut quantities = set.allocate();
    set.evaluate(&[0.0], &mut quantities)?;
    assert_eq!((set.time(), quantities.c()), (4.0, [-8.0, -2.0].as_slice()));
    Ok(())
}
