//! Cylindrical joint: a rod in a sleeve; `(R_a s_i) . (p_b - p_a) = 0`, `R_a t = R_b t`.

use super::attachment::Body;
use super::orientation::Tilt;
use super::prismatic::path;
use super::relative::relative;
use super::{JointError, check_turns, direction};
use crate::scalar::vector::Vector;
use crate::{Constraint, EquationSink};

/// Body b slides along an axis of body a and rotates about it: `(R_a s_i) . (p_b - p_a) = 0` for two directions `s_i`
/// perpendicular to the axis, and the tilt of the axis, as in [`super::Revolute`].
///
#[doc = include_str!("../../../docs/pictures/cylindrical.svg")]
///
#[doc = include_str!("../../../docs/types/cylindrical.md")]
/// # Example
///
/// ```
/// use qless_constraints::{ConstraintSet, types::{Body, Cylindrical}};
/// let rod = Body::with_vector([0, 1, 2], [1.0, 0.0, 0.0], [3, 4, 5]);
/// let mut builder = ConstraintSet::builder(6);
/// builder.add("sleeve", Cylindrical { a: Body::ground(), b: rod, at: [0.0; 3], axis: [1.0, 0.0, 0.0] })?;
/// let set = builder.build()?;
/// // The rod slides by 2 and rotates by 1 rad.
/// let mut evaluation = set.allocate();
/// set.evaluate(&[2.0, 0.0, 0.0, 1.0, 0.0, 0.0], &mut evaluation)?;
/// assert_eq!(evaluation.c(), [0.0; 4]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylindrical {
    /// The body with the sleeve.
    pub a: Body,
    /// The body that slides and turns.
    pub b: Body,
    /// A point of the axis in the reference configuration, coordinates.
    pub at: Vector<f64>,
    /// The direction of the axis there, of any length.
    pub axis: Vector<f64>,
}

impl Constraint for Cylindrical {
    const NAME: &'static str = "cylindrical joint";
    type Error = JointError;

    fn emit(self, sink: &mut EquationSink) -> Result<(), JointError> {
        check_turns(&self.a, &self.b)?;
        let axis = direction(self.axis)?;
        path(sink, &self.a, &self.b, self.at, axis);
        relative(sink, "", &self.a, &self.b, Tilt::new(axis));
        Ok(())
    }
}
