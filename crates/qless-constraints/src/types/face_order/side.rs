//! One side of a face of p-refinement: its polynomials and its nodes.

use super::{FaceOrderTieError, Side};
use crate::geometry::project::ROUNDING;
use crate::geometry::shape::Shape;
use crate::types::Polynomials;

/// One side of a face.
#[derive(Clone, Debug, PartialEq)]
pub struct FaceSide<const F: usize> {
    /// What it can be.
    pub polynomials: Polynomials,
    /// `xi, eta` of each node, as of [`Shape`], and its DOFs, 0-based; as many nodes as there are polynomials.
    pub nodes: Vec<([f64; 2], [usize; F])>,
}

impl<const F: usize> FaceSide<F> {
    /// That of an element, from the DOFs of its nodes in the order of the shape.
    ///
    /// # Errors
    /// [`FaceOrderTieError`] if the shape is no face or has another number of nodes.
    pub fn of_shape(shape: Shape, dofs: &[[usize; F]]) -> Result<Self, FaceOrderTieError> {
        let polynomials = Polynomials::of(shape).ok_or(FaceOrderTieError::NoFace { shape })?;
        if dofs.len() != shape.nodes() {
            return Err(FaceOrderTieError::Nodes { shape, found: dofs.len() });
        }
        let nodes = shape.places().iter().zip(dofs).map(|(x, &dofs)| ([x[0], x[1]], dofs)).collect();
        Ok(Self { polynomials, nodes })
    }

    pub(super) fn check(&self, side: Side) -> Result<(), FaceOrderTieError> {
        let (polynomials, found) = (self.polynomials, self.nodes.len());
        if polynomials.degree() == 0 || polynomials.dimension() != found {
            return Err(FaceOrderTieError::Count { side, polynomials, found });
        }
        let is_inside = |[x, y]: [f64; 2]| {
            let inside = polynomials.face().clamp([x, y, 0.0]);
            (inside[0] - x).abs() <= ROUNDING && (inside[1] - y).abs() <= ROUNDING
        };
        match self.nodes.iter().position(|&(at, _)| !is_inside(at)) {
            Some(i) => Err(FaceOrderTieError::Outside { side, node: i + 1, at: self.nodes[i].0 }),
            None => Ok(()),
        }
    }

    /// `N_k` at these points.
    pub(super) fn weights(&self, side: Side, points: &[[f64; 2]]) -> Result<Vec<Vec<f64>>, FaceOrderTieError> {
        self.polynomials.weights(&self.places(), points).ok_or(FaceOrderTieError::Undetermined { side })
    }

    pub(super) fn places(&self) -> Vec<[f64; 2]> {
        self.nodes.iter().map(|&(at, _)| at).collect()
    }
}
