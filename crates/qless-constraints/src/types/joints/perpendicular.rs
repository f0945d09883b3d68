//! Perpendicular axes: `(R_a s) . (R_b t) = 0`.

use super::attachment::Body;
use super::orientation::PerpendicularAxes;
use super::relative::relative;
use super::{JointError, check_turns, direction};
use crate::scalar::vector::{Vector, dot};
use crate::{Constraint, EquationSink};

/// An axis of each body, kept perpendicular to each other: `(R_a s) . (R_b t) = 0`, the cosine of their angle. The
/// positions of the bodies do not matter.
///
#[doc = include_str!("../../../docs/pictures/perpendicular.svg")]
///
#[doc = include_str!("../../../docs/types/perpendicular.md")]
/// # Example
///
/// ```
/// use qless_constraints::{ConstraintSet, types::{Body, Perpendicular}};
/// let arm = Body::with_vector([0, 1, 2], [1.0, 0.0, 0.0], [3, 4, 5]);
/// let joint = Perpendicular { a: Body::ground(), b: arm, axis_a: [1.0, 0.0, 0.0], axis_b: [0.0, 0.0, 1.0] };
/// let mut builder = ConstraintSet::builder(6);
/// builder.add("square", joint)?;
/// let set = builder.build()?;
/// // The axes stay perpendicular if the body rotates about one of them.
/// let mut evaluation = set.allocate();
/// set.evaluate(&[5.0, 5.0, 5.0, 0.0, 0.0, 2.0], &mut evaluation)?;
/// assert_eq!(evaluation.c(), [0.0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Perpendicular {
    /// One body.
    pub a: Body,
    /// The other.
    pub b: Body,
    /// The axis on body a in the reference configuration, of any length.
    pub axis_a: Vector<f64>,
    /// The axis on body b there, perpendicular to the other.
    pub axis_b: Vector<f64>,
}

impl Constraint for Perpendicular {
    const NAME: &'static str = "perpendicular axes";
    type Error = JointError;

    fn emit(self, sink: &mut EquationSink) -> Result<(), JointError> {
        check_turns(&self.a, &self.b)?;
        relative(sink, "", &self.a, &self.b, perpendicular_axes(self.axis_a, self.axis_b)?);
        Ok(())
    }
}

/// Two axes, which must be perpendicular in the reference configuration.
pub(super) fn perpendicular_axes(of_a: Vector<f64>, of_b: Vector<f64>) -> Result<PerpendicularAxes, JointError> {
    let (of_a, of_b) = (direction(of_a)?, direction(of_b)?);
    let cosine = dot(of_a, of_b);
    if cosine.abs() > 1e-9 { Err(JointError::NotPerpendicular(cosine)) } else { Ok(PerpendicularAxes { of_a, of_b }) }
}
