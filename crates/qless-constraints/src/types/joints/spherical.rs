//! Spherical joint: a point of two bodies coincides; three equations.

use super::attachment::Body;
use super::coincident::coincident;
use super::{JointError, check_moves};
use crate::scalar::vector::Vector;
use crate::{Constraint, EquationSink};

/// A ball joint: `x_a + R_a s_a - x_b - R_b s_b = 0`.
///
#[doc = include_str!("../../../docs/pictures/spherical.svg")]
///
#[doc = include_str!("../../../docs/types/spherical.md")]
/// # Example
///
/// ```
/// use qless_constraints::{ConstraintSet, types::{Body, Spherical}};
/// let arm = Body::with_vector([0, 1, 2], [1.0, 0.0, 0.0], [3, 4, 5]);
/// let mut builder = ConstraintSet::builder(6);
/// builder.add("hip", Spherical { a: Body::ground(), b: arm, at: [0.0; 3] })?;
/// assert_eq!(builder.build()?.equations(), 3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spherical {
    /// One body.
    pub a: Body,
    /// The other.
    pub b: Body,
    /// Position of the joint in the reference configuration, coordinates.
    pub at: Vector<f64>,
}

impl Constraint for Spherical {
    const NAME: &'static str = "spherical joint";
    type Error = JointError;

    fn emit(self, sink: &mut EquationSink) -> Result<(), JointError> {
        check_moves(&self.a, &self.b)?;
        coincident(sink, "", &self.a, &self.b, self.at);
        Ok(())
    }
}
