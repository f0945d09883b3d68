//! Fixed joint: a weld; three equations for the point, three for the orientation.

use super::coincident::coincident;
use super::parts::angle;
use super::{JointError, check_turns};
use crate::geometry::carrier::Body;
use crate::scalar::vector::Vector;
use crate::{Constraint, Store};

/// Two bodies that move as one: a point coincides, and three pairs of directions stay perpendicular.
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
    /// Where the joint is in the reference configuration, coordinates.
    pub at: Vector<f64>,
}

impl Constraint for Fixed {
    const NAME: &'static str = "fixed joint";
    type Error = JointError;

    fn process(self, store: &mut Store) -> Result<(), JointError> {
        check_turns(&self.a, &self.b)?;
        coincident(store, "", &self.a, &self.b, self.at);
        orientation(store, &self.a, &self.b, [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
        Ok(())
    }
}

/// Two bodies do not turn on one another: `(R_a e_i) . (R_b e_j) = 0` for three pairs of a frame.
pub(super) fn orientation(store: &mut Store, a: &Body, b: &Body, frame: [Vector<f64>; 3]) {
    for (part, i, j) in [("turn 1", 0, 1), ("turn 2", 1, 2), ("turn 3", 2, 0)] {
        angle(store, part, a, b, [frame[i], frame[j]]);
    }
}
