//! `u_h = sum_k N_k(xi_h) u_k`: a node that refinement has put on an edge or face of a larger element.

use super::interpolate;
use crate::geometry::node::{ROUNDING, field};
use crate::geometry::shape::{Shape, ShapeParameters};
use crate::{Constraint, EquationSink};

/// A hanging node of h-refinement, at the parameters xi of its parent: a linear or quadratic edge or face of an
/// element that was not refined.
///
/// The weights depend only on the parameters, so they are exact: 1/2 and 1/2 in the middle of a linear edge; 3/8, -1/8
/// and 3/4 at a quarter of a quadratic edge. The field is continuous if the refined elements have the degree of the
/// parent, and if each of their nodes on the parent hangs on it or is one of its nodes. If a node hangs on a face, it must
/// not also hang on an edge of that face: the equations of the edge would be redundant. The nodes of a parent may hang too.
///
/// For p-refinement use [`OrderTie`](crate::types::OrderTie). For nodes with unknown parameters use
/// [`NodeTie`](crate::types::NodeTie).
///
#[doc = include_str!("../../../docs/pictures/hanging_node.svg")]
///
#[doc = include_str!("../../../docs/types/hanging_node.md")]
/// # Example
///
/// ```
/// use qless_constraints::{ConstraintSet, types::{HangingNode, Shape}};
/// // The middle of the left half of a quadratic edge, with two fields.
/// let (node, parent) = ([0, 1], vec![[2, 3], [4, 5], [6, 7]]);
/// let mut builder = ConstraintSet::builder(8);
/// builder.add("hanging", HangingNode { node, shape: Shape::Line3, parent, at: [-0.5, 0.0] })?;
/// let g = builder.build()?.allocate().g().clone();
/// assert_eq!(g.row(0).collect::<Vec<_>>(), [(0, 1.0), (2, -0.375), (4, 0.125), (6, -0.75)]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct HangingNode<const F: usize> {
    /// The DOFs of the hanging node, 0-based, one for each field.
    pub node: [usize; F],
    /// Shape of the parent.
    pub shape: Shape,
    /// The DOFs of the parent's nodes, in the order of the shape.
    pub parent: Vec<[usize; F]>,
    /// Parameters `xi, eta` of the node; `eta` is ignored on an edge. [`Shape`] defines their range.
    pub at: [f64; 2],
}

/// What can be wrong with a hanging node.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum HangingNodeError {
    /// The parent is a solid.
    #[error("the parent is a {shape:?}; nodes hang on edges and faces")]
    Solid {
        /// The shape.
        shape: Shape,
    },
    /// The parent has the wrong number of nodes.
    #[error("the parent has {found} nodes; a {shape:?} has {}", shape.nodes())]
    Nodes {
        /// The shape.
        shape: Shape,
        /// Number of nodes given.
        found: usize,
    },
    /// The node lies outside the parent.
    #[error(
        "the parameters {at:?} are not inside of a {shape:?}; correct them, or take the parent that the node is on"
    )]
    Outside {
        /// The shape.
        shape: Shape,
        /// The parameters.
        at: [f64; 2],
    },
    /// The node is a node of the parent.
    #[error("DOF {dof} of the node also belongs to the parent; a node of the parent cannot hang on it")]
    OwnParent {
        /// The DOF, 0-based.
        dof: usize,
    },
}

impl<const F: usize> HangingNode<F> {
    fn check(&self) -> Result<(), HangingNodeError> {
        let shape = self.shape;
        if shape.dimensions() == 3 {
            return Err(HangingNodeError::Solid { shape });
        }
        if self.parent.len() != shape.nodes() {
            return Err(HangingNodeError::Nodes { shape, found: self.parent.len() });
        }
        match self.node.iter().find(|&dof| self.parent.iter().flatten().any(|other| other == dof)) {
            Some(&dof) => Err(HangingNodeError::OwnParent { dof }),
            None => Ok(()),
        }
    }

    /// The parameters of the node. If they are outside of the parent by rounding, they are moved to its boundary.
    fn place(&self) -> Result<ShapeParameters, HangingNodeError> {
        let [xi, eta] = self.at;
        let given = [xi, if self.shape.dimensions() == 1 { 0.0 } else { eta }, 0.0];
        let inside = self.shape.clamp(given);
        let is_inside = inside.iter().zip(given).all(|(inside, given)| (inside - given).abs() <= ROUNDING);
        if is_inside { Ok(inside) } else { Err(HangingNodeError::Outside { shape: self.shape, at: self.at }) }
    }
}

impl<const F: usize> Constraint for HangingNode<F> {
    const NAME: &'static str = "hanging node";
    type Error = HangingNodeError;

    fn emit(self, sink: &mut EquationSink) -> Result<(), HangingNodeError> {
        self.check()?;
        let weights = self.shape.weights(self.place()?);
        interpolate(sink, field::<0, F>, &self.node, self.parent.iter().copied().zip(weights));
        Ok(())
    }
}
