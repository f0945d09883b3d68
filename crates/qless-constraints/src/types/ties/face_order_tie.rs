//! `u_i = sum_k N_k(xi_i) u_k`: a face with nodes of a higher polynomial degree, tied to a face of a lower degree.

use std::fmt;

use super::{interpolate, is_shared};
use crate::geometry::node::{ROUNDING, field_of_node};
use crate::geometry::shape::Shape;
use crate::types::Polynomials;
use crate::{Constraint, EquationSink};

/// A face of p-refinement in a nodal basis: the finer side follows the polynomial through the nodes of the coarser
/// side.
///
/// `u_i = sum_k N_k(xi_i) u_k`. The polynomials `N_k` of the coarser side ([`Polynomials`](crate::types::Polynomials))
/// are 1 at one of its nodes and 0 at the others. The nodes may have any position on the face: equally spaced, Fekete
/// points, or others. The finer polynomials must contain the coarser ones, so that both sides agree everywhere, also
/// on the edges; an [`OrderTie`](crate::types::OrderTie) on an edge would be redundant. Shared nodes, which have the
/// same DOFs as a coarser node at the same place, have no equations. Weights that are only rounding are exactly zero.
/// The weights of a node sum to one. Cost: a dense factorization of the size of the coarser side.
///
/// A hierarchic basis needs no such tie: both sides share the lower modes, and
/// [`Prescribed`](crate::types::Prescribed) sets the additional modes of the finer side to zero.
///
#[doc = include_str!("../../../docs/pictures/face_order_tie.svg")]
///
#[doc = include_str!("../../../docs/types/face_order_tie.md")]
/// # Example
///
/// ```
/// use qless_constraints::{ConstraintSet, types::{FaceOrderTie, FaceSide, Shape}};
/// // A face with six nodes tied to a face with three nodes, with shared corners.
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
    /// The dependent side.
    pub fine: FaceSide<F>,
    /// The independent side, with the same parameters `xi, eta` as the finer side: the corners are in the same order.
    pub coarse: FaceSide<F>,
}

impl<const F: usize> FaceOrderTie<F> {
    fn check(&self) -> Result<(), FaceOrderTieError> {
        self.fine.check(TieSide::Fine)?;
        self.coarse.check(TieSide::Coarse)?;
        let (fine, coarse) = (self.fine.polynomials, self.coarse.polynomials);
        if !fine.contain(coarse) {
            return Err(FaceOrderTieError::NotAmong { fine, coarse });
        }
        self.fine.weights(TieSide::Fine, &[]).map(|_| ())
    }

    fn is_shared(&self, i: usize) -> Result<bool, FaceOrderTieError> {
        let (at, dofs) = self.fine.nodes[i];
        let here = |other: [f64; 2]| (0..2).all(|k| (other[k] - at[k]).abs() <= ROUNDING);
        is_shared(&dofs, &self.coarse.nodes, here).map_err(|dof| FaceOrderTieError::Shared { node: i + 1, dof })
    }
}

impl<const F: usize> Constraint for FaceOrderTie<F> {
    const NAME: &'static str = "face of p-refinement";
    type Error = FaceOrderTieError;

    fn emit(self, sink: &mut EquationSink) -> Result<(), FaceOrderTieError> {
        self.check()?;
        let weights = self.coarse.weights(TieSide::Coarse, &self.fine.places())?;
        for (i, ((_, dofs), weights)) in self.fine.nodes.iter().zip(weights).enumerate() {
            if !self.is_shared(i)? {
                let masters = self.coarse.nodes.iter().map(|&(_, dofs)| dofs).zip(weights);
                interpolate(sink, |k| field_of_node::<0, F>(i, k).into(), dofs, masters);
            }
        }
        Ok(())
    }
}

/// One of the two sides that meet at a face: its polynomials and its nodes.
#[derive(Clone, Debug, PartialEq)]
pub struct FaceSide<const F: usize> {
    /// The polynomials on the face.
    pub polynomials: Polynomials,
    /// `xi, eta` of each node, in the parameters of [`Shape`], and its 0-based DOFs. The number of nodes is the
    /// dimension of the space of polynomials.
    pub nodes: Vec<([f64; 2], [usize; F])>,
}

impl<const F: usize> FaceSide<F> {
    /// The face of an element, from the DOFs of its nodes in the order of the shape.
    ///
    /// # Errors
    /// [`FaceOrderTieError`] if the shape is not a face, or if `dofs` does not have one entry for each of its nodes.
    pub fn of_shape(shape: Shape, dofs: &[[usize; F]]) -> Result<Self, FaceOrderTieError> {
        let polynomials = Polynomials::from_shape(shape).ok_or(FaceOrderTieError::NoFace { shape })?;
        if dofs.len() != shape.nodes() {
            return Err(FaceOrderTieError::Nodes { shape, found: dofs.len() });
        }
        let nodes = shape.places().iter().zip(dofs).map(|(x, &dofs)| ([x[0], x[1]], dofs)).collect();
        Ok(Self { polynomials, nodes })
    }

    pub(super) fn check(&self, side: TieSide) -> Result<(), FaceOrderTieError> {
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

    /// The polynomials `N_k` of all nodes, evaluated at these points: one list for each point.
    pub(super) fn weights(&self, side: TieSide, points: &[[f64; 2]]) -> Result<Vec<Vec<f64>>, FaceOrderTieError> {
        self.polynomials.weights(&self.places(), points).ok_or(FaceOrderTieError::Undetermined { side })
    }

    pub(super) fn places(&self) -> Vec<[f64; 2]> {
        self.nodes.iter().map(|&(at, _)| at).collect()
    }
}

/// A side of the tie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TieSide {
    /// The dependent side.
    Fine,
    /// The independent side.
    Coarse,
}

impl fmt::Display for TieSide {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if *self == Self::Fine { "finer" } else { "coarser" })
    }
}

/// What can be wrong with a [`FaceOrderTie`].
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FaceOrderTieError {
    /// A shape is not a face.
    #[error("a {shape:?} is not a face")]
    NoFace {
        /// The shape.
        shape: Shape,
    },
    /// The number of nodes given is not that of the shape.
    #[error("{found} nodes are given; a {shape:?} has {}", shape.nodes())]
    Nodes {
        /// The shape.
        shape: Shape,
        /// Number of nodes given.
        found: usize,
    },
    /// The number of nodes does not match the polynomials.
    #[error("the {side} side has {found} nodes, but {polynomials:?} (degree one or more) needs {}", polynomials.dimension())]
    Count {
        /// Side of the tie.
        side: TieSide,
        /// The polynomials of this side.
        polynomials: Polynomials,
        /// The number of nodes of this side.
        found: usize,
    },
    /// The finer side does not contain the polynomials of the coarser side.
    #[error(
        "the polynomials {fine:?} of the finer side do not contain {coarse:?} of the coarser side: exchange the sides, or raise the finer degree"
    )]
    NotAmong {
        /// Polynomials of the finer side.
        fine: Polynomials,
        /// Polynomials of the coarser side.
        coarse: Polynomials,
    },
    /// A node is outside of the face.
    #[error("node {node}, from 1, of the {side} side is at {at:?}, which is not on the face; correct its parameters")]
    Outside {
        /// Side of the tie.
        side: TieSide,
        /// Number of the node, counted from 1.
        node: usize,
        /// Parameters `xi, eta` of the node.
        at: [f64; 2],
    },
    /// The nodes do not determine a polynomial.
    #[error(
        "the nodes of the {side} side do not determine a polynomial of it: two coincide, or too many lie on one curve; move them"
    )]
    Undetermined {
        /// Side of the tie.
        side: TieSide,
    },
    /// A finer node shares a DOF with a coarser node, but not its place, or not its other DOFs.
    #[error(
        "node {node}, from 1, of the finer side shares DOF {dof} with a different coarser node: a common node has one place and one list of DOFs"
    )]
    Shared {
        /// Number of the node, counted from 1.
        node: usize,
        /// The DOF, 0-based.
        dof: usize,
    },
}
