//! Surfaces and meshes: nodes, and faces or solids that share them.

use std::collections::HashMap;

use rayon::prelude::*;

use super::element_quality::is_degenerate;
use super::node::{Node, relative};
use super::shape::Shape;

/// A face of a surface, a segment of a line, or a solid of a mesh.
///
/// ```
/// use qless_constraints::types::{Face, Shape};
/// let face = Face::new(Shape::Tri3, [0, 1, 2]);
/// assert_eq!(face.nodes.len(), face.shape.nodes());
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Face {
    /// Element shape of the face.
    pub shape: Shape,
    /// Indices into [`Surface::nodes`], from 0, in the order of the shape.
    pub nodes: Vec<usize>,
}

impl Face {
    /// A face with its nodes.
    pub fn new(shape: Shape, nodes: impl Into<Vec<usize>>) -> Self {
        Self { shape, nodes: nodes.into() }
    }
}

/// Nodes and the faces that share them, with F fields in D dimensions: `x(xi) = sum_k N_k(xi) x_k` on each face.
///
/// Faces may also be lines (a polyline) or solids (a mesh that contains embedded nodes). The list of nodes may contain
/// unused nodes, such as all nodes of the model.
///
/// ```
/// use qless_constraints::types::{Face, Point, Shape, Surface};
/// let at = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
/// let nodes = (0..4).map(|i| Point::new([3 * i, 3 * i + 1, 3 * i + 2], at[i])).collect();
/// let faces = vec![Face::new(Shape::Tri3, [0, 1, 2]), Face::new(Shape::Tri3, [0, 2, 3])];
/// let square = Surface { nodes, faces };
/// assert_eq!(square.faces.len(), 2);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Surface<const D: usize, const F: usize = D> {
    /// The nodes.
    pub nodes: Vec<Node<D, F>>,
    /// The faces, of any shapes.
    pub faces: Vec<Face>,
}

/// What can be wrong with a surface.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SurfaceError {
    /// The surface has no faces.
    #[error("the surface has no faces; give at least one")]
    Empty,
    /// A face has the wrong number of nodes.
    #[error("face {face}, from 1, has {found} nodes; a {shape:?} has {}", shape.nodes())]
    Nodes {
        /// Number of the face, counted from 1.
        face: usize,
        /// Shape of the face.
        shape: Shape,
        /// Number of nodes given.
        found: usize,
    },
    /// A face names a node that does not exist.
    #[error("face {face}, from 1, names node {node} (from 0), but the surface has {nodes}")]
    NoNode {
        /// Number of the face, counted from 1.
        face: usize,
        /// Number of the node, counted from 0.
        node: usize,
        /// Number of nodes of the surface.
        nodes: usize,
    },
    /// Two faces have the same nodes: integrals would count them twice.
    #[error("faces {first} and {second}, from 1, have the same nodes; remove one, as integrals would count both")]
    Repeated {
        /// Number of one face, counted from 1.
        first: usize,
        /// Number of the other face, counted from 1.
        second: usize,
    },
    /// A face has no size, is folded, has more dimensions than its space, or has coordinates that are not finite.
    #[error("face {face}, from 1, is degenerate or folded: correct its nodes, their coordinates or their order")]
    Degenerate {
        /// Number of the face, counted from 1.
        face: usize,
    },
}

impl<const D: usize, const F: usize> Surface<D, F> {
    /// A polyline through the nodes: one face of two nodes between consecutive nodes.
    ///
    /// ```
    /// use qless_constraints::types::{PlanarPoint, Surface};
    /// let at = |i: usize| PlanarPoint::new([2 * i, 2 * i + 1], [i as f64, 0.0]);
    /// assert_eq!(Surface::polyline((0..5).map(at).collect()).faces.len(), 4);
    /// ```
    pub fn polyline(nodes: Vec<Node<D, F>>) -> Self {
        let faces = (1..nodes.len()).map(|end| Face::new(Shape::Line2, [end - 1, end])).collect();
        Self { nodes, faces }
    }

    /// Coordinates of the nodes of a face.
    pub(crate) fn places(&self, face: usize) -> Vec<[f64; D]> {
        self.faces[face].nodes.iter().map(|&node| self.nodes[node].at).collect()
    }

    /// Checks all faces; the error names the first faulty one.
    pub(crate) fn check(&self) -> Result<(), SurfaceError> {
        if self.faces.is_empty() {
            return Err(SurfaceError::Empty);
        }
        let faults = (0..self.faces.len()).into_par_iter().filter_map(|face| self.check_face(face).err());
        faults.find_first(|_| true).map_or(Ok(()), Err)
    }

    /// Like [`Surface::check`]; also refuses repeated faces, which integrals would count twice.
    pub(crate) fn check_integrable(&self) -> Result<(), SurfaceError> {
        self.check()?;
        let mut found = HashMap::with_capacity(self.faces.len());
        for (second, face) in (1..).zip(&self.faces) {
            let mut nodes = face.nodes.clone();
            nodes.sort_unstable();
            if let Some(first) = found.insert(nodes, second) {
                return Err(SurfaceError::Repeated { first, second });
            }
        }
        Ok(())
    }

    fn check_face(&self, index: usize) -> Result<(), SurfaceError> {
        let (Face { shape, nodes }, face) = (&self.faces[index], index + 1);
        if nodes.len() != shape.nodes() {
            return Err(SurfaceError::Nodes { face, shape: *shape, found: nodes.len() });
        }
        if let Some(&node) = nodes.iter().find(|&&node| node >= self.nodes.len()) {
            return Err(SurfaceError::NoNode { face, node, nodes: self.nodes.len() });
        }
        let places = self.places(index);
        let middle = std::array::from_fn(|k| places.iter().map(|x| x[k]).sum::<f64>() / places.len() as f64);
        let finite = places.iter().flatten().all(|x| x.is_finite());
        if !finite || is_degenerate(*shape, &relative(&places, &middle)) {
            return Err(SurfaceError::Degenerate { face });
        }
        Ok(())
    }
}
