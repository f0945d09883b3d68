//! Prismatic joint: a slider; two equations for the path, three for the orientation.

use super::fixed::orientation;
use super::parts::height;
use super::{JointError, check_turns, direction};
use crate::geometry::carrier::Body;
use crate::scalar::vector::{Vector, perpendicular};
use crate::{Constraint, Store};

/// Body b slides along an axis of body a and does not turn on it: `(R_a s_i) . (p_b - p_a) = 0` for the two `s_i`
/// perpendicular to the axis.
///
/// ```
/// use qless_constraints::{ConstraintSet, types::{Body, Prismatic}};
/// let piston = Body::with_vector([0, 1, 2], [1.0, 0.0, 0.0], [3, 4, 5]);
/// let mut builder = ConstraintSet::builder(6);
/// builder.add("bore", Prismatic { a: Body::ground(), b: piston, at: [1.0, 0.0, 0.0], axis: [1.0, 0.0, 0.0] })?;
/// let set = builder.build()?;
/// let mut quantities = set.allocate();
/// set.evaluate(&[5.0, 0.0, 0.0, 0.0, 0.0, 0.0], &mut quantities)?;
/// assert_eq!(quantities.c(), [0.0; 5]);
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

    fn process(self, store: &mut Store) -> Result<(), JointError> {
        check_turns(&self.a, &self.b)?;
        let axis = direction(self.axis)?;
        let sides = perpendicular(axis);
        for (part, side) in ["path 1", "path 2"].into_iter().zip(sides) {
            height(store, part, &self.a, &self.b, self.at, side);
        }
        orientation(store, &self.a, &self.b, [axis, sides[0], sides[1]]);
        Ok(())
    }
}
