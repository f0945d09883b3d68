//! `x_i = x_r + R (X_i - X_r)`: nodes that move as a rigid body, for rotations of any size.

use crate::geometry::carrier::Body;
use crate::geometry::node::Point;
use crate::types::joints::coincident::coincident;
use crate::{Constraint, Store};

/// A rigid link (one node) or rigid body (many), exact for finite rotations: three equations per node.
///
#[doc = include_str!("../../docs/pictures/rigid_body.svg")]
///
#[doc = include_str!("../../docs/types/rigid_body.md")]
/// # Example
///
/// ```
/// use qless_constraints::{ConstraintSet, types::{Body, Point, RigidBody}};
/// let body = Body::with_vector([0, 1, 2], [0.0; 3], [3, 4, 5]);
/// let node = Point::new([6, 7, 8], [2.0, 0.0, 0.0]);
/// let mut builder = ConstraintSet::builder(9);
/// builder.add("link", RigidBody { body, nodes: vec![node] })?;
/// let set = builder.build()?;
/// // A quarter turn about z brings the node from (2, 0, 0) to (0, 2, 0).
/// let mut quantities = set.allocate();
/// set.evaluate(&[0.0, 0.0, 0.0, 0.0, 0.0, std::f64::consts::FRAC_PI_2, -2.0, 2.0, 0.0], &mut quantities)?;
/// assert!(quantities.c().iter().all(|c| c.abs() < 1e-15));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct RigidBody {
    /// Position and rotation of the body.
    pub body: Body,
    /// The nodes that follow.
    pub nodes: Vec<Point>,
}

/// What can be wrong with a rigid body.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RigidBodyError {
    /// No node follows.
    #[error("the rigid body has no nodes; give at least one")]
    NoNodes,
    /// The body does not turn.
    #[error("the body has no rotations; give it a rotation vector or Euler parameters")]
    NoRotations,
}

impl Constraint for RigidBody {
    const NAME: &'static str = "rigid body, finite rotations";
    type Error = RigidBodyError;

    fn process(self, store: &mut Store) -> Result<(), RigidBodyError> {
        if self.nodes.is_empty() {
            return Err(RigidBodyError::NoNodes);
        }
        if !self.body.turns() {
            return Err(RigidBodyError::NoRotations);
        }
        for (i, &node) in self.nodes.iter().enumerate() {
            let part = if self.nodes.len() == 1 { String::new() } else { format!("node {}", i + 1) };
            coincident(store, part, &self.body, &Body::node(node), node.at);
        }
        Ok(())
    }
}
