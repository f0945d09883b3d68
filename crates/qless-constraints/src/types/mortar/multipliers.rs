//! `Phi_i = sum_j B_ij N_j`: the functions of the multipliers on a slave facet, and `D_ij = int Phi_i N_j`.
//!
//! Dual functions: `int Phi_i M_j = delta_ij int M_j` with `B = diag(d) (int M M^T)^-1 P`, `M = P N`, `d_i = int M_i` (Wohlmuth, SIAM
//! J. Numer. Anal., 2000). Linear shapes: `P = I`. Quadratic ones, whose corners may have no integral: `M_c = N_c + a sum N_e`
//! over the edges at the corner, `M_e = (1 - 2 a) N_e`, `a = 1/5` (Popp, Wohlmuth, Gee and Wall, SIAM J. Sci. Comput., 2012).

use faer::linalg::solvers::DenseSolveCore;
use faer::{Mat, Side};

use super::Multipliers;
use crate::geometry::shape::Shape;

/// The share a of an edge's function that goes to each of its corners.
const SHARE: f64 = 0.2;

/// The multipliers of a slave facet with n nodes.
pub(super) struct Functions {
    /// B, n x n.
    pub b: Mat<f64>,
    /// D, n x n.
    pub d: Mat<f64>,
}

impl Functions {
    /// From `int N_i N_j` of the facet; nothing if that is not positive definite.
    pub fn new(kind: Multipliers, shape: Shape, mass: Mat<f64>) -> Option<Self> {
        match kind {
            Multipliers::Standard => Some(Self { b: Mat::identity(mass.nrows(), mass.ncols()), d: mass }),
            Multipliers::Dual => Self::dual(shape, &mass),
        }
    }

    fn dual(shape: Shape, mass: &Mat<f64>) -> Option<Self> {
        let p = shares(shape);
        let inverse = (&p * mass * p.transpose()).llt(Side::Lower).ok()?.inverse();
        // The functions sum to one.
        let d = &p * mass * Mat::<f64>::full(mass.nrows(), 1, 1.0);
        let b = Mat::from_fn(p.nrows(), p.nrows(), |i, j| d[(i, 0)] * inverse[(i, j)]) * &p;
        Some(Self { b, d: own(shape, &d) })
    }
}

/// P.
fn shares(shape: Shape) -> Mat<f64> {
    let mut p = Mat::identity(shape.nodes(), shape.nodes());
    for &[middle, a, b] in shape.edges() {
        p[(middle, middle)] = 1.0 - 2.0 * SHARE;
        (p[(a, middle)], p[(b, middle)]) = (SHARE, SHARE);
    }
    p
}

/// `diag(d) P^-T`: the values of M are those of N at corners, and `(u_e - a (u_1 + u_2)) / (1 - 2 a)` at edges.
fn own(shape: Shape, d: &Mat<f64>) -> Mat<f64> {
    let mut own = Mat::from_fn(d.nrows(), d.nrows(), |i, j| if i == j { d[(i, 0)] } else { 0.0 });
    for &[middle, a, b] in shape.edges() {
        let scaled = d[(middle, 0)] / (1.0 - 2.0 * SHARE);
        own[(middle, middle)] = scaled;
        (own[(middle, a)], own[(middle, b)]) = (-SHARE * scaled, -SHARE * scaled);
    }
    own
}
