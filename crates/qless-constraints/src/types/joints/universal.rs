//! Universal joint: a cross of two axes; `x_a + R_a s_a = x_b + R_b s_b`, `(R_a s) . (R_b t) = 0`.

use super::attachment::Body;
use super::coincident::coincident;
use super::perpendicular::perpendicular_axes;
use super::relative::relative;
use super::{JointError, check_turns};
use crate::scalar::vector::Vector;
use crate::{Constraint, EquationSink};

/// A cross of two axes: `x_a + R_a s_a - x_b - R_b s_b = 0` and `(R_a s) . (R_b t) = 0`. Shafts at an angle beta rotate
/// by `tan(psi_b) = tan(psi_a) / cos(beta)`.
///
#[doc = include_str!("../../../docs/pictures/universal.svg")]
///
#[doc = include_str!("../../../docs/types/universal.md")]
/// # Example
///
/// ```
/// use qless_constraints::{ConstraintSet, types::{Body, Universal}};
/// let shaft = Body::with_vector([0, 1, 2], [1.0, 0.0, 0.0], [3, 4, 5]);
/// let joint = Universal { a: Body::ground(), b: shaft, at: [0.0; 3], axis_a: [0.0, 1.0, 0.0], axis_b: [0.0, 0.0, 1.0] };
/// let mut builder = ConstraintSet::builder(6);
/// builder.add("cardan", joint)?;
/// assert_eq!(builder.build()?.equations(), 4);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Universal {
    /// One body.
    pub a: Body,
    /// The other.
    pub b: Body,
    /// Point where the axes cross in the reference configuration, coordinates.
    pub at: Vector<f64>,
    /// The axis on body a there, of any length.
    pub axis_a: Vector<f64>,
    /// The axis on body b there, perpendicular to the other.
    pub axis_b: Vector<f64>,
}

impl Constraint for Universal {
    const NAME: &'static str = "universal joint";
    type Error = JointError;

    fn emit(self, sink: &mut EquationSink) -> Result<(), JointError> {
        check_turns(&self.a, &self.b)?;
        let cross = perpendicular_axes(self.axis_a, self.axis_b)?;
        coincident(sink, "", &self.a, &self.b, self.at);
        relative(sink, "cross", &self.a, &self.b, cross);
        Ok(())
    }
}
