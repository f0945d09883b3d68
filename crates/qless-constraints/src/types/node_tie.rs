//! `u_p = sum_k N_k(xi) u_k`: a node tied to the point of a face or a line that is nearest to it.

use crate::geometry::node::{AXES, Node, within};
use crate::geometry::project::project;
use crate::geometry::shape::Shape;
use crate::{Constraint, Store};

/// A node tied to a face or a line, in D dimensions.
///
/// ```
/// use qless_constraints::{ConstraintSet, types::{NodeTie, PlanarPoint, Shape}};
/// let master = vec![PlanarPoint::new([2, 3], [0.0, 0.0]), PlanarPoint::new([4, 5], [4.0, 0.0])];
/// let node = PlanarPoint::new([0, 1], [1.0, 0.0]);
/// let mut builder = ConstraintSet::builder(6);
/// builder.add("tie", NodeTie { node, shape: Shape::Line2, face: master, tolerance: 1e-6 })?;
/// let set = builder.build();
/// assert_eq!(set.allocate().g.row(0).collect::<Vec<_>>(), [(0, 1.0), (2, -0.75), (4, -0.25)]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct NodeTie<const D: usize> {
    /// The node that is tied.
    pub node: Node<D>,
    /// What kind of face it is tied to.
    pub shape: Shape,
    /// The nodes of the face, in the order of the shape.
    pub face: Vec<Node<D>>,
    /// Farthest that the node may be from the face, a length.
    pub tolerance: f64,
}

/// What can be wrong with a tie of a node.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum NodeTieError {
    /// The face has the wrong number of nodes.
    #[error("the face has {found} nodes; a {shape:?} has {}", shape.nodes())]
    Nodes {
        /// The shape.
        shape: Shape,
        /// How many were given.
        found: usize,
    },
    /// The face has no area, or folds.
    #[error("the face is degenerate or folded: no nearest point was found; correct its nodes or their order")]
    Degenerate,
    /// The node is too far away.
    #[error("the node is {distance} away from the face, more than the tolerance {tolerance}")]
    TooFar {
        /// How far.
        distance: f64,
        /// How far it may be.
        tolerance: f64,
    },
}

impl<const D: usize> Constraint for NodeTie<D> {
    const NAME: &'static str = "tie of a node";
    type Error = NodeTieError;

    fn process(self, store: &mut Store) -> Result<(), NodeTieError> {
        if self.face.len() != self.shape.nodes() {
            return Err(NodeTieError::Nodes { shape: self.shape, found: self.face.len() });
        }
        let corners: Vec<[f64; D]> = self.face.iter().map(|node| node.at).collect();
        let found = project(self.shape, &corners, &self.node.at).ok_or(NodeTieError::Degenerate)?;
        if !within(found.distance, self.tolerance) {
            return Err(NodeTieError::TooFar { distance: found.distance, tolerance: self.tolerance });
        }
        for axis in 0..D {
            let masters = self.face.iter().zip(&found.weights).filter(|&(_, &n)| n != 0.0);
            let terms = masters.map(|(node, n)| (node.dofs[axis], -n));
            store.equation(AXES[axis], terms.chain([(self.node.dofs[axis], 1.0)]), 0.0);
        }
        Ok(())
    }
}
