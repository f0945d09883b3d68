//! Universal joint: a cross of two axes; three equations for the point, one for the cross.

use super::coincident::coincident;
use super::parts::angle;
use super::{JointError, check_turns, direction};
use crate::geometry::carrier::Body;
use crate::scalar::vector::{Vector, dot};
use crate::{Constraint, Store};

/// A point coincides, and an axis of each body stays perpendicular to the other: `(R_a s) . (R_b t) = 0`.
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
    /// Where the axes cross in the reference configuration, coordinates.
    pub at: Vector<f64>,
    /// The axis on body a there, of any length.
    pub axis_a: Vector<f64>,
    /// The axis on body b there, perpendicular to the other.
    pub axis_b: Vector<f64>,
}

impl Constraint for Universal {
    const NAME: &'static str = "universal joint";
    type Error = JointError;

    fn process(self, store: &mut Store) -> Result<(), JointError> {
        check_turns(&self.a, &self.b)?;
        let (s, t) = (direction(self.axis_a)?, direction(self.axis_b)?);
        let cosine = dot(s, t);
        if cosine.abs() > 1e-9 {
            return Err(JointError::NotPerpendicular(cosine));
        }
        coincident(store, "", &self.a, &self.b, self.at);
        angle(store, "cross", &self.a, &self.b, [s, t]);
        Ok(())
    }
}
