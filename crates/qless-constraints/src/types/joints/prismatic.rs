//! Prismatic joint: a slider; `(R_a s_i) . (p_b - p_a) = 0`, `log(R_a^T R_b) = 0`.

use super::attachment::Body;
use super::height::height;
use super::orientation::Aligned;
use super::relative::relative;
use super::{JointError, check_turns, direction};
use crate::scalar::vector::{Vector, perpendicular};
use crate::{Constraint, EquationSink};

/// Body b slides along an axis of body a without rotating: `(R_a s_i) . (p_b - p_a) = 0` for two directions `s_i`
/// perpendicular to the axis, and `log(R_a^T R_b) = 0`, as in [`super::Fixed`]. `p_a` and `p_b` are the points of both
/// bodies that are at `at` in the reference configuration.
///
#[doc = include_str!("../../../docs/pictures/prismatic.svg")]
///
#[doc = include_str!("../../../docs/types/prismatic.md")]
/// # Example
///
/// ```
/// use qless_constraints::{ConstraintSet, types::{Body, Prismatic}};
/// let piston = Body::with_vector([0, 1, 2], [1.0, 0.0, 0.0], [3, 4, 5]);
/// let mut builder = ConstraintSet::builder(6);
/// builder.add("bore", Prismatic { a: Body::ground(), b: piston, at: [1.0, 0.0, 0.0], axis: [1.0, 0.0, 0.0] })?;
/// let set = builder.build()?;
/// let mut evaluation = set.allocate();
/// set.evaluate(&[5.0, 0.0, 0.0, 0.0, 0.0, 0.0], &mut evaluation)?;
/// assert_eq!(evaluation.c(), [0.0; 5]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prismatic {
    /// The body with the guide.
    pub a: Body,
    /// The body that slides.
    pub b: Body,
    /// A point of the axis in the reference configuration, coordinates.
    pub at: Vector<f64>,
    /// The direction of the axis there, of any length.
    pub axis: Vector<f64>,
}

impl Constraint for Prismatic {
    const NAME: &'static str = "prismatic joint";
    type Error = JointError;

    fn emit(self, sink: &mut EquationSink) -> Result<(), JointError> {
        check_turns(&self.a, &self.b)?;
        let axis = direction(self.axis)?;
        path(sink, &self.a, &self.b, self.at, axis);
        relative(sink, "", &self.a, &self.b, Aligned);
        Ok(())
    }
}

/// Adds the two equations that keep the point `at` of body b on an axis of body a.
pub(super) fn path(sink: &mut EquationSink, a: &Body, b: &Body, at: Vector<f64>, axis: Vector<f64>) {
    for (part, side) in ["path 1", "path 2"].into_iter().zip(perpendicular(axis)) {
        height(sink, part, a, b, at, side);
    }
}
