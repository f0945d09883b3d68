//! `u_i = u_r + theta x (X_i - X_r)`: nodes that move as a rigid body, for small rotations.

use crate::geometry::node::{AXES, Point};
use crate::scalar::vector::sub;
use crate::{Constraint, Store};

/// A rigid link (one node) or rigid body (many), linear: three equations per node. Also known as RBE2.
///
#[doc = include_str!("../../docs/pictures/small_rigid_body.svg")]
///
#[doc = include_str!("../../docs/types/small_rigid_body.md")]
/// # Example
///
/// ```
/// use qless_constraints::{ConstraintSet, types::{Point, SmallRigidBody}};
/// let reference = Point::new([0, 1, 2], [0.0; 3]);
/// let nodes = vec![Point::new([6, 7, 8], [2.0, 0.0, 0.0])];
/// let mut builder = ConstraintSet::builder(9);
/// builder.add("link", SmallRigidBody { reference, rotations: [3, 4, 5], nodes })?;
/// let set = builder.build()?;
/// // A turn by 0.1 about z lifts the node by 0.2.
/// let mut quantities = set.allocate();
/// set.evaluate(&[0.0, 0.0, 0.0, 0.0, 0.0, 0.1, 0.0, 0.2, 0.0], &mut quantities)?;
/// assert!(quantities.c().iter().all(|c| c.abs() < 1e-16));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct SmallRigidBody {
    /// The node that carries the rotations.
    pub reference: Point,
    /// theta, 0-based DOFs, in radians.
    pub rotations: [usize; 3],
    /// The nodes that follow.
    pub nodes: Vec<Point>,
}

/// What can be wrong with a rigid body for small rotations.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SmallRigidBodyError {
    /// No node follows.
    #[error("the rigid body has no nodes besides its reference; give at least one")]
    NoNodes,
}

impl Constraint for SmallRigidBody {
    const NAME: &'static str = "rigid body, small rotations";
    type Error = SmallRigidBodyError;

    fn process(self, store: &mut Store) -> Result<(), SmallRigidBodyError> {
        if self.nodes.is_empty() {
            return Err(SmallRigidBodyError::NoNodes);
        }
        for (i, node) in self.nodes.iter().enumerate() {
            let r = sub(node.at, self.reference.at);
            for axis in 0..3 {
                // (theta x r)_x = theta_y r_z - theta_z r_y, and so on.
                let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
                let terms = [
                    (node.dofs[axis], 1.0),
                    (self.reference.dofs[axis], -1.0),
                    (self.rotations[next], -r[last]),
                    (self.rotations[last], r[next]),
                ];
                store.equation(part(i, self.nodes.len(), axis), terms.into_iter().filter(|t| t.1 != 0.0), 0.0);
            }
        }
        Ok(())
    }
}

fn part(node: usize, nodes: usize, axis: usize) -> String {
    if nodes == 1 { AXES[axis].to_owned() } else { format!("node {}, {}", node + 1, AXES[axis]) }
}
