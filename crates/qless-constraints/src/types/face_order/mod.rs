//! `u_i = sum_k N_k(xi_i) u_k`: a face with nodes for polynomials of a higher degree that moves as one of a lower.

mod error;
mod side;

use super::interpolation::interpolate;
use crate::geometry::node::field_of_node;
use crate::geometry::project::ROUNDING;
use crate::{Constraint, Store};
pub use error::{FaceOrderTieError, Side};
pub use side::FaceSide;

/// A face of p-refinement in a nodal basis: the nodes of the finer side lie on the polynomial through those of the coarser.
///
/// `u_i = sum_k N_k(xi_i) u_k` with the polynomials of the coarser side ([`Polynomials`](crate::types::Polynomials)) that are 1 at one of its
/// nodes and 0 at the others, wherever on the face they stand: equally spaced, at Fekete points, or otherwise. The polynomials of the coarser side must be
/// among those of the finer, so that both sides meet everywhere, on the edges of the face too: an [`OrderTie`](super::OrderTie) there would say
/// it twice. F equations and F DOFs removed for each finer node; one that has the DOFs of a coarser one in the same place (a corner that both
/// share) has none. Weights are exactly zero where they are rounding, and sum to one. Cost: that of a dense factorisation with the nodes
/// of the coarser side.
///
/// In a hierarchic basis lower modes are shared, and those of the finer side alone vanish: `u_m = 0`, a [`Prescribed`](super::Prescribed).
///
#[doc = include_str!("../../../docs/pictures/face_order_tie.svg")]
///
#[doc = include_str!("../../../docs/types/face_order_tie.md")]
/// # Example
///
/// ```
/// use qless_constraints::{ConstraintSet, types::{FaceOrderTie, FaceSide, Shape}};
/// // A face with six nodes at one with three; they share their corners.
/// let fine = FaceSide::of_shape(Shape::Tri6, &[[0], [1], [2], [3], [4], [5]])?;
/// let coarse = FaceSide::of_shape(Shape::Tri3, &[[0], [1], [2]])?;
/// let mut builder = ConstraintSet::builder(6);
/// builder.add("face", FaceOrderTie { fine, coarse })?;
/// let set = builder.build()?;
/// assert_eq!(set.equations(), 3);
/// assert_eq!(set.allocate().g().row(0).collect::<Vec<_>>(), [(0, -0.5), (1, -0.5), (3, 1.0)]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct FaceOrderTie<const F: usize> {
    /// The side that follows.
    pub fine: FaceSide<F>,
    /// The side that leads, with the same parameters: its first corner is the same.
    pub coarse: FaceSide<F>,
}

impl<const F: usize> FaceOrderTie<F> {
    fn check(&self) -> Result<(), FaceOrderTieError> {
        self.fine.check(Side::Fine)?;
        self.coarse.check(Side::Coarse)?;
        let (fine, coarse) = (self.fine.polynomials, self.coarse.polynomials);
        if !fine.contain(coarse) {
            return Err(FaceOrderTieError::NotAmong { fine, coarse });
        }
        self.fine.weights(Side::Fine, &[]).map(|_| ())
    }

    /// Whether a finer node is a coarser one; nothing but that may have its DOFs.
    fn is_shared(&self, i: usize) -> Result<bool, FaceOrderTieError> {
        let (at, dofs) = self.fine.nodes[i];
        let here = |other: [f64; 2]| (0..2).all(|k| (other[k] - at[k]).abs() <= ROUNDING);
        let coarse = &self.coarse.nodes;
        if coarse.iter().any(|&(other, own)| own == dofs && here(other)) {
            return Ok(true);
        }
        match dofs.iter().find(|dof| coarse.iter().any(|(_, others)| others.contains(dof))) {
            Some(&dof) => Err(FaceOrderTieError::Shared { node: i + 1, dof }),
            None => Ok(false),
        }
    }
}

impl<const F: usize> Constraint for FaceOrderTie<F> {
    const NAME: &'static str = "face of p-refinement";
    type Error = FaceOrderTieError;

    fn process(self, store: &mut Store) -> Result<(), FaceOrderTieError> {
        self.check()?;
        let weights = self.coarse.weights(Side::Coarse, &self.fine.places())?;
        for (i, ((_, dofs), weights)) in self.fine.nodes.iter().zip(weights).enumerate() {
            if !self.is_shared(i)? {
                let masters = self.coarse.nodes.iter().map(|&(_, dofs)| dofs).zip(weights);
                interpolate(store, |k| field_of_node::<0, F>(i, k).into(), dofs, masters);
            }
        }
        Ok(())
    }
}
