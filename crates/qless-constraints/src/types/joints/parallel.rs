//! Parallel axes: `R_a t = R_b t`.

use super::attachment::Body;
use super::orientation::Tilt;
use super::relative::relative;
use super::{JointError, check_turns, direction};
use crate::scalar::vector::Vector;
use crate::{Constraint, EquationSink};

/// An axis of each body, kept parallel: `c = beta e`, the rotation vector that rotates `R_a t` to `R_b t`, in the axes
/// of a, two angles.
///
/// `beta = acos(R_a t . R_b t)` is in `[0, pi]`, and e is along `t x R_a^T R_b t`. So the axes point the same way, not
/// in opposite directions. The positions of the bodies do not matter. Within 1e-8 rad of opposite directions the rank is
/// one, and c is half a turn about one direction perpendicular to the axis. This lets Newton's method leave the
/// singularity.
///
#[doc = include_str!("../../../docs/pictures/parallel.svg")]
///
#[doc = include_str!("../../../docs/types/parallel.md")]
/// # Example
///
/// ```
/// use qless_constraints::{ConstraintSet, types::{Body, Parallel}};
/// let arm = Body::with_vector([0, 1, 2], [1.0, 0.0, 0.0], [3, 4, 5]);
/// let mut builder = ConstraintSet::builder(6);
/// builder.add("upright", Parallel { a: Body::ground(), b: arm, axis: [0.0, 0.0, 1.0] })?;
/// let set = builder.build()?;
/// // The body is tilted by 2 rad.
/// let mut evaluation = set.allocate();
/// set.evaluate(&[5.0, 5.0, 5.0, 0.0, 2.0, 0.0], &mut evaluation)?;
/// assert!((evaluation.c()[0].hypot(evaluation.c()[1]) - 2.0).abs() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parallel {
    /// One body.
    pub a: Body,
    /// The other.
    pub b: Body,
    /// The direction of the axis in the reference configuration, of any length.
    pub axis: Vector<f64>,
}

impl Constraint for Parallel {
    const NAME: &'static str = "parallel axes";
    type Error = JointError;

    fn emit(self, sink: &mut EquationSink) -> Result<(), JointError> {
        check_turns(&self.a, &self.b)?;
        relative(sink, "", &self.a, &self.b, Tilt::new(direction(self.axis)?));
        Ok(())
    }
}
