//! `u_p = sum_k N_k(xi) u_k`: a node tied to the nearest point of a line, face or solid.

use super::interpolate;
use crate::geometry::closest_point::project;
use crate::geometry::element_quality::is_degenerate;
use crate::geometry::node::{Node, field, relative, rounding, within};
use crate::geometry::search::{FaceSearch, Nearest, SearchError};
use crate::geometry::shape::Shape;
use crate::geometry::surface::Surface;
use crate::{Constraint, EquationSink};

/// A node with F fields, tied to a line, to a face, or to a solid that contains it, in D dimensions:
/// `u_p = sum_k N_k(xi) u_k`.
///
/// xi are the parameters of the point of the element that is nearest to the node. In a solid that contains the node they
/// solve `x(xi) = x_p`, by Newton's method (one step for affine elements). Weights below 8 units in the last place of the
/// largest are exactly zero. The sum of all weights is one, up to two units of rounding per weight. So the tie reproduces
/// constants, and also linear fields if the node lies on the element. Cost: about ten evaluations of N.
///
/// Each field is interpolated separately: over a gap h, a rigid rotation theta leaves an error `theta h`. So the
/// tolerance should be small compared with the element.
///
/// A node embedded in a tetrahedron:
///
/// ```
/// use qless_constraints::{ConstraintSet, types::{Node, NodeTie, Shape}};
/// let corners = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0]];
/// let face: Vec<_> = (0..4).map(|k| Node::of_field(k, corners[k])).collect();
/// let node = Node::of_field(4, [0.5, 1.0, 0.0]);
/// let mut builder = ConstraintSet::builder(5);
/// builder.add("rebar", NodeTie { node, shape: Shape::Tet4, face, tolerance: 1e-6 })?;
/// let g = builder.build()?.allocate().g().clone();
/// assert_eq!(g.row(0).collect::<Vec<_>>(), [(0, -0.25), (1, -0.25), (2, -0.5), (4, 1.0)]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// A planar node on a line:
///
#[doc = include_str!("../../../docs/pictures/node_tie.svg")]
///
#[doc = include_str!("../../../docs/types/node_tie.md")]
/// # Example
///
/// ```
/// use qless_constraints::{ConstraintSet, types::{NodeTie, PlanarPoint, Shape}};
/// let master = vec![PlanarPoint::new([2, 3], [0.0, 0.0]), PlanarPoint::new([4, 5], [4.0, 0.0])];
/// let node = PlanarPoint::new([0, 1], [1.0, 0.0]);
/// let mut builder = ConstraintSet::builder(6);
/// builder.add("tie", NodeTie { node, shape: Shape::Line2, face: master, tolerance: 1e-6 })?;
/// let set = builder.build()?;
/// assert_eq!(set.allocate().g().row(0).collect::<Vec<_>>(), [(0, 1.0), (2, -0.75), (4, -0.25)]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct NodeTie<const D: usize, const F: usize = D> {
    /// The slave node.
    pub node: Node<D, F>,
    /// Shape of the master element.
    pub shape: Shape,
    /// Nodes of the master element, in the order of the shape.
    pub face: Vec<Node<D, F>>,
    /// Largest distance of the node from the element, a length; the rounding of the coordinates is added.
    pub tolerance: f64,
}

/// What can be wrong with a tie of a node.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NodeTieError {
    /// The face has the wrong number of nodes.
    #[error("the face has {found} nodes; a {shape:?} has {}", shape.nodes())]
    Nodes {
        /// The shape.
        shape: Shape,
        /// Number of nodes given.
        found: usize,
    },
    /// The element has no size, is folded, or has more dimensions than the space.
    #[error("the face is degenerate or folded: no nearest point was found; correct its nodes or their order")]
    Degenerate,
    /// The node is too far away.
    #[error(
        "the node is {distance} away from the face, more than the tolerance {tolerance}: correct the node, tie it to the face \
         or solid that it is on, or raise the tolerance"
    )]
    TooFar {
        /// Distance of the node from the face.
        distance: f64,
        /// Largest allowed distance.
        tolerance: f64,
    },
}

impl<const D: usize, const F: usize> NodeTie<D, F> {
    /// Ties each node to the nearest face of a surface, or to the nearest solid of a mesh ([`FaceSearch`]); one tie
    /// per node, in the same order. Cost for m nodes near n faces: O((n + m) log n).
    ///
    /// The nodes should not belong to the surface: their equations would be `0 = 0`.
    ///
    /// ```
    /// use qless_constraints::ConstraintSet;
    /// use qless_constraints::types::{Face, NodeTie, PlanarPoint, Shape, Surface};
    /// let at = |i: usize, x: f64| PlanarPoint::new([2 * i, 2 * i + 1], [x, 0.0]);
    /// let faces = vec![Face::new(Shape::Line2, [0, 1]), Face::new(Shape::Line2, [1, 2])];
    /// let wall = Surface { nodes: vec![at(0, 0.0), at(1, 1.0), at(2, 2.0)], faces };
    /// let mut builder = ConstraintSet::builder(10);
    /// for (i, tie) in NodeTie::to_surface(&[at(3, 0.5), at(4, 1.75)], &wall, 1e-6)?.into_iter().enumerate() {
    ///     builder.add(format!("tie {}", i + 1), tie)?;
    /// }
    /// let g = builder.build()?.allocate().g().clone();
    /// assert_eq!(g.row(2).collect::<Vec<_>>(), [(2, -0.25), (4, -0.75), (8, 1.0)]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`SearchError`]: the surface is invalid, or a node has no face within the tolerance, a length.
    pub fn to_surface(nodes: &[Node<D, F>], surface: &Surface<D, F>, tolerance: f64) -> Result<Vec<Self>, SearchError> {
        let places: Vec<[f64; D]> = nodes.iter().map(|node| node.at).collect();
        let nearest = FaceSearch::new(surface)?.within(&places, tolerance)?;
        let tie = |(&node, found): (&Node<D, F>, Nearest)| {
            let face = &surface.faces[found.face];
            let masters = face.nodes.iter().map(|&master| surface.nodes[master]).collect();
            Self { node, shape: face.shape, face: masters, tolerance }
        };
        Ok(nodes.iter().zip(nearest).map(tie).collect())
    }
}

impl<const D: usize, const F: usize> Constraint for NodeTie<D, F> {
    const NAME: &'static str = "tie of a node";
    type Error = NodeTieError;

    fn emit(self, sink: &mut EquationSink) -> Result<(), NodeTieError> {
        if self.face.len() != self.shape.nodes() {
            return Err(NodeTieError::Nodes { shape: self.shape, found: self.face.len() });
        }
        let corners: Vec<[f64; D]> = self.face.iter().map(|node| node.at).collect();
        if is_degenerate(self.shape, &relative(&corners, &self.node.at)) {
            return Err(NodeTieError::Degenerate);
        }
        let found = project(self.shape, &corners, &self.node.at).ok_or(NodeTieError::Degenerate)?;
        if !within(found.distance - rounding(&corners, &self.node.at), self.tolerance) {
            return Err(NodeTieError::TooFar { distance: found.distance, tolerance: self.tolerance });
        }
        let masters = self.face.iter().zip(&found.weights).map(|(node, &n)| (node.dofs, n));
        interpolate(sink, field::<D, F>, &self.node.dofs, masters);
        Ok(())
    }
}
