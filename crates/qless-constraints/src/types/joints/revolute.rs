//! Revolute joint: a hinge; three equations for the point, two for the axis.

use super::coincident::coincident;
use super::parts::angle;
use super::{JointError, check_turns, direction};
use crate::geometry::carrier::Body;
use crate::scalar::vector::{Vector, perpendicular};
use crate::{Constraint, Store};

/// A hinge: a point coincides, and the axis `t` stays perpendicular to two directions: `(R_a s_i) . (R_b t) = 0`.
///
/// ```
/// use qless_constraints::{ConstraintSet, types::{Body, Revolute}};
/// let arm = Body::with_vector([0, 1, 2], [1.0, 0.0, 0.0], [3, 4, 5]);
/// let mut builder = ConstraintSet::builder(6);
/// builder.add("door", Revolute { a: Body::ground(), b: arm, at: [0.0; 3], axis: [0.0, 0.0, 1.0] })?;
/// let set = builder.build()?;
/// assert_eq!((set.equations(), set.label(3)?), (5, "door, axis 1".to_owned()));
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

    fn process(self, store: &mut Store) -> Result<(), JointError> {
        check_turns(&self.a, &self.b)?;
        let axis = direction(self.axis)?;
        coincident(store, "", &self.a, &self.b, self.at);
        for (part, side) in ["axis 1", "axis 2"].into_iter().zip(perpendicular(axis)) {
            angle(store, part, &self.a, &self.b, [side, axis]);
        }
        Ok(())
    }
}
