//! Revolute joint: a hinge; `x_a + R_a s_a = x_b + R_b s_b`, `R_a t = R_b t`.

use super::attachment::Body;
use super::coincident::coincident;
use super::orientation::Tilt;
use super::relative::relative;
use super::{JointError, check_turns, direction};
use crate::scalar::vector::Vector;
use crate::{Constraint, EquationSink};

/// A hinge: `x_a + R_a s_a - x_b - R_b s_b = 0` and the tilt of the axis.
///
/// The tilt is the rotation vector that rotates `R_a t` to `R_b t`, in the axes of a, with the angle
/// `acos(R_a t . R_b t)` in `[0, pi]` ([`super::Parallel`]). So the axes point the same way after assembly, from any
/// initial position. The joint may turn any number of times.
///
#[doc = include_str!("../../../docs/pictures/revolute.svg")]
///
#[doc = include_str!("../../../docs/types/revolute.md")]
/// # Example
///
/// ```
/// use qless_constraints::{ConstraintSet, types::{Body, Revolute}};
/// let arm = Body::with_vector([0, 1, 2], [1.0, 0.0, 0.0], [3, 4, 5]);
/// let mut builder = ConstraintSet::builder(6);
/// builder.add("door", Revolute { a: Body::ground(), b: arm, at: [0.0; 3], axis: [0.0, 0.0, 1.0] })?;
/// let set = builder.build()?;
/// assert_eq!((set.equations(), set.label(3)?), (5, "door, tilt 1".to_owned()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Revolute {
    /// One body.
    pub a: Body,
    /// The other.
    pub b: Body,
    /// A point of the axis in the reference configuration, coordinates.
    pub at: Vector<f64>,
    /// The direction of the axis there, of any length.
    pub axis: Vector<f64>,
}

impl Constraint for Revolute {
    const NAME: &'static str = "revolute joint";
    type Error = JointError;

    fn emit(self, sink: &mut EquationSink) -> Result<(), JointError> {
        check_turns(&self.a, &self.b)?;
        let axis = direction(self.axis)?;
        coincident(sink, "", &self.a, &self.b, self.at);
        relative(sink, "", &self.a, &self.b, Tilt::new(axis));
        Ok(())
    }
}
