//! `u_i = sum_k L_k(s_i) u_k` with the Lagrange polynomials `L_k` of the coarser nodes: an edge with nodes of degree p, tied to an edge of
//! degree q < p.

use super::{interpolate, is_shared};
use crate::geometry::node::{ROUNDING, field_of_node};
use crate::{Constraint, EquationSink};

/// An edge of p-refinement in a nodal basis: the p + 1 nodes of the finer side follow the polynomial through the q + 1
/// nodes of the coarser side.
///
/// `u_i = sum_k L_k(s_i) u_k` with the Lagrange polynomials of the coarser nodes. These may have any position on the
/// edge: equally spaced, Gauss-Lobatto points, or others. Shared nodes, which have the same DOFs as a coarser node at
/// the same place, have no equations.
///
/// A hierarchic basis needs no such tie: both sides share the modes up to q, and
/// [`Prescribed`](crate::types::Prescribed) sets the higher modes on the edge to zero.
///
#[doc = include_str!("../../../docs/pictures/order_tie.svg")]
///
#[doc = include_str!("../../../docs/types/order_tie.md")]
/// # Example
///
/// ```
/// use qless_constraints::{ConstraintSet, types::OrderTie};
/// // A cubic edge tied to a linear edge, with shared ends.
/// let coarse = vec![(0.0, [0]), (1.0, [1])];
/// let fine = vec![(0.0, [0]), (0.25, [2]), (0.75, [3]), (1.0, [1])];
/// let mut builder = ConstraintSet::builder(4);
/// builder.add("edge", OrderTie { fine, coarse })?;
/// let set = builder.build()?;
/// assert_eq!(set.equations(), 2);
/// assert_eq!(set.allocate().g().row(0).collect::<Vec<_>>(), [(0, -0.75), (1, -0.25), (2, 1.0)]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct OrderTie<const F: usize> {
    /// Position of each finer node along the edge, in any unit, and its DOFs.
    pub fine: Vec<(f64, [usize; F])>,
    /// Position of each coarser node along the edge, in the same unit, and its DOFs.
    pub coarse: Vec<(f64, [usize; F])>,
}

/// What can be wrong with an edge of p-refinement.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum OrderTieError {
    /// The coarser side has too few or too many nodes.
    #[error("{fine} nodes are tied to {coarse}; the coarser side needs at least two, and fewer than the finer")]
    Order {
        /// Number of nodes of the finer side.
        fine: usize,
        /// Number of nodes of the coarser side.
        coarse: usize,
    },
    /// A finer node is not between the ends of the coarser side.
    #[error("node {node}, from 1, of the finer side is at {at}, beyond the ends {from} and {to} of the coarser side")]
    Outside {
        /// Number of the node, counted from 1.
        node: usize,
        /// Position of the node.
        at: f64,
        /// Position of one end of the coarser side.
        from: f64,
        /// Position of the other end.
        to: f64,
    },
    /// Two coarser nodes have the same position.
    #[error("nodes {first} and {second}, from 1, of the coarser side are both at {at}; they must differ")]
    Repeated {
        /// Number of one node, counted from 1.
        first: usize,
        /// Number of the other node, counted from 1.
        second: usize,
        /// Position of both nodes.
        at: f64,
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

/// `L_k(s) = prod_(j != k) (s - s_j) / (s_k - s_j)`: exactly 1 and 0 at the nodes.
fn lagrange(nodes: &[f64], s: f64) -> Vec<f64> {
    let factor = |k: usize| {
        let others = nodes.iter().enumerate().filter(move |&(j, _)| j != k);
        others.map(|(_, &other)| (s - other) / (nodes[k] - other)).product()
    };
    (0..nodes.len()).map(factor).collect()
}

impl<const F: usize> OrderTie<F> {
    fn check(&self, places: &[f64]) -> Result<(), OrderTieError> {
        let (fine, coarse) = (self.fine.len(), self.coarse.len());
        if coarse < 2 || coarse >= fine {
            return Err(OrderTieError::Order { fine, coarse });
        }
        for (second, &at) in places.iter().enumerate() {
            if let Some(first) = places[..second].iter().position(|&other| other == at) {
                return Err(OrderTieError::Repeated { first: first + 1, second: second + 1, at });
            }
        }
        let from = places.iter().copied().fold(f64::INFINITY, f64::min);
        let to = places.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        // Positions may be outside by rounding. Written so that NaN is refused.
        let off = ROUNDING * from.abs().max(to.abs());
        match self.fine.iter().position(|(at, _)| !(from - off..=to + off).contains(at)) {
            Some(i) => Err(OrderTieError::Outside { node: i + 1, at: self.fine[i].0, from, to }),
            None => Ok(()),
        }
    }

    fn is_shared(&self, i: usize) -> Result<bool, OrderTieError> {
        let (at, dofs) = self.fine[i];
        let here = |other: f64| (other - at).abs() <= ROUNDING * other.abs().max(at.abs());
        is_shared(&dofs, &self.coarse, here).map_err(|dof| OrderTieError::Shared { node: i + 1, dof })
    }
}

impl<const F: usize> Constraint for OrderTie<F> {
    const NAME: &'static str = "edge of p-refinement";
    type Error = OrderTieError;

    fn emit(self, sink: &mut EquationSink) -> Result<(), OrderTieError> {
        let places: Vec<f64> = self.coarse.iter().map(|&(at, _)| at).collect();
        self.check(&places)?;
        for (i, (at, dofs)) in self.fine.iter().enumerate() {
            if !self.is_shared(i)? {
                let weights = lagrange(&places, *at);
                let masters = self.coarse.iter().map(|&(_, dofs)| dofs).zip(weights);
                interpolate(sink, |k| field_of_node::<0, F>(i, k).into(), dofs, masters);
            }
        }
        Ok(())
    }
}
