//! Fixed joint: a weld; `x_a + R_a s_a = x_b + R_b s_b`, `log(R_a^T R_b) = 0`.

use super::attachment::Body;
use super::coincident::coincident;
use super::orientation::Aligned;
use super::relative::relative;
use super::{JointError, check_turns};
use crate::scalar::vector::Vector;
use crate::{Constraint, EquationSink};

/// Two bodies that move as one: `x_a + R_a s_a - x_b - R_b s_b = 0` and `log(R_a^T R_b) = 0`.
///
/// The angles are the components of the shortest rotation vector from a to b, in the axes of a. So a joint that is not
/// yet assembled closes over at most half a turn; at exactly half a turn, the sign of the quaternion decides the sense.
/// The moment among the multipliers is in the axes of a.
///
#[doc = include_str!("../../../docs/pictures/fixed.svg")]
///
#[doc = include_str!("../../../docs/types/fixed.md")]
/// # Example
///
/// ```
/// use qless_constraints::{ConstraintSet, types::{Body, Fixed}};
/// let bracket = Body::with_vector([0, 1, 2], [1.0, 0.0, 0.0], [3, 4, 5]);
/// let mut builder = ConstraintSet::builder(6);
/// builder.add("weld", Fixed { a: Body::ground(), b: bracket, at: [0.0; 3] })?;
/// assert_eq!(builder.build()?.equations(), 6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fixed {
    /// One body.
    pub a: Body,
    /// The other.
    pub b: Body,
    /// Position of the joint in the reference configuration, coordinates.
    pub at: Vector<f64>,
}

impl Constraint for Fixed {
    const NAME: &'static str = "fixed joint";
    type Error = JointError;

    fn emit(self, sink: &mut EquationSink) -> Result<(), JointError> {
        check_turns(&self.a, &self.b)?;
        coincident(sink, "", &self.a, &self.b, self.at);
        relative(sink, "", &self.a, &self.b, Aligned);
        Ok(())
    }
}
