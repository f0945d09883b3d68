//! The functions of the multipliers, and the rows of the mortar matrices `D` and `M`.

use std::collections::BTreeMap;

use faer::linalg::solvers::DenseSolveCore;
use faer::{Mat, Side};

use super::Multipliers;
use super::cover::FacetSegments;
use crate::geometry::shape::Shape;
use crate::geometry::surface::Face;

/// Entries of D and M below this share of the sum of their absolute terms are left out. They are rounding errors of the
/// quadrature, or of the inverse matrix in the dual functions.
const ROUNDING: f64 = 256.0 * f64::EPSILON;

/// A sum and the sum of its absolute terms.
#[derive(Clone, Copy, Default)]
struct EntrySum {
    value: f64,
    terms: f64,
}

/// A row of the mortar matrices: the entries of D by slave node, and those of -M by master node.
#[derive(Default)]
pub(super) struct MortarRow {
    slaves: BTreeMap<usize, EntrySum>,
    masters: BTreeMap<usize, EntrySum>,
}

impl MortarRow {
    pub fn slaves(&self) -> impl Iterator<Item = (usize, f64)> + Clone {
        entries(&self.slaves)
    }

    pub fn masters(&self) -> impl Iterator<Item = (usize, f64)> + Clone {
        entries(&self.masters)
    }
}

fn entries(sums: &BTreeMap<usize, EntrySum>) -> impl Iterator<Item = (usize, f64)> + Clone {
    sums.iter().filter(|(_, sum)| sum.value.abs() > ROUNDING * sum.terms).map(|(&node, sum)| (node, sum.value))
}

fn add(sums: &mut BTreeMap<usize, EntrySum>, node: usize, value: f64, terms: f64) {
    let sum = sums.entry(node).or_default();
    sum.value += value;
    sum.terms += terms;
}

/// The mass matrix `int N_i N_j` of a slave facet, over all of its segments.
fn mass(nodes: usize, segments: &FacetSegments) -> Mat<f64> {
    Mat::from_fn(nodes, nodes, |i, j| segments.iter().map(|(_, segment)| segment.own[i * nodes + j]).sum())
}

/// Adds a slave facet to the rows of its nodes. Returns `None` if the facet has no dual functions.
pub(super) fn add_facet(
    rows: &mut BTreeMap<usize, MortarRow>,
    kind: Multipliers,
    slave: &Face,
    masters: &[Face],
    segments: &FacetSegments,
) -> Option<()> {
    let MultiplierFunctions { b, d } = MultiplierFunctions::new(kind, slave.shape, mass(slave.nodes.len(), segments))?;
    for (i, &node) in slave.nodes.iter().enumerate() {
        let row = rows.entry(node).or_default();
        for (j, &other) in slave.nodes.iter().enumerate().filter(|&(j, _)| d[(i, j)] != 0.0) {
            add(&mut row.slaves, other, d[(i, j)], d[(i, j)].abs());
        }
        for (facet, segment) in segments {
            let nodes = &masters[*facet].nodes;
            for (k, &other) in nodes.iter().enumerate() {
                let sum = |sums: &[f64], weight: &dyn Fn(f64) -> f64| -> f64 {
                    (0..slave.nodes.len()).map(|l| weight(b[(i, l)]) * sums[l * nodes.len() + k]).sum()
                };
                add(&mut row.masters, other, -sum(&segment.other, &|b| b), sum(&segment.terms, &f64::abs));
            }
        }
    }
    Some(())
}

/// The share a of a mid-edge function `N_e` that is added to the function of each corner of the edge.
const SHARE: f64 = 0.2;

/// Functions `Phi_i = sum_j B_ij N_j` of the multipliers on a slave facet with n nodes, and `D_ij = int Phi_i N_j`.
///
/// Dual functions satisfy `int Phi_i M_j = delta_ij int M_j`, with `B = diag(d) (int M M^T)^-1 P`, `M = P N` and
/// `d_i = int M_i` (Wohlmuth, SIAM J. Numer. Anal., 2000). For linear shapes `P = I`. The corner functions of quadratic
/// shapes may have a zero or negative integral. So `M_c = N_c + a sum N_e` over the edges at the corner and
/// `M_e = (1 - 2 a) N_e`, with `a = 1/5` (Popp, Wohlmuth, Gee and Wall, SIAM J. Sci. Comput., 2012).
pub(super) struct MultiplierFunctions {
    /// The coefficients `B_ij` of `N_j` in `Phi_i`, n x n.
    pub b: Mat<f64>,
    /// The integrals `D_ij = int Phi_i N_j`, n x n.
    pub d: Mat<f64>,
}

impl MultiplierFunctions {
    /// `mass` is `int N_i N_j` of the facet. Returns `None` for dual functions if this matrix is not positive definite.
    pub fn new(kind: Multipliers, shape: Shape, mass: Mat<f64>) -> Option<Self> {
        match kind {
            Multipliers::Standard => Some(Self { b: Mat::identity(mass.nrows(), mass.ncols()), d: mass }),
            Multipliers::Dual => Self::dual(shape, &mass),
        }
    }

    fn dual(shape: Shape, mass: &Mat<f64>) -> Option<Self> {
        let p = edge_shares(shape);
        let inverse = (&p * mass * p.transpose()).llt(Side::Lower).ok()?.inverse();
        // `sum_j N_j = 1`, so `int M_i = sum_j int M_i N_j`.
        let d = &p * mass * Mat::<f64>::full(mass.nrows(), 1, 1.0);
        let b = Mat::from_fn(p.nrows(), p.nrows(), |i, j| d[(i, 0)] * inverse[(i, j)]) * &p;
        Some(Self { b, d: slave_matrix(shape, &d) })
    }
}

/// The matrix P of `M = P N`: it adds a share of each mid-edge function to the functions of both corners of the edge.
fn edge_shares(shape: Shape) -> Mat<f64> {
    let mut p = Mat::identity(shape.nodes(), shape.nodes());
    for &[middle, a, b] in shape.edges() {
        p[(middle, middle)] = 1.0 - 2.0 * SHARE;
        (p[(a, middle)], p[(b, middle)]) = (SHARE, SHARE);
    }
    p
}

/// The matrix `D = diag(d) P^-T` of dual functions, with `d_i = int M_i` and `M = P N`. `P^-T u` are the coefficients of a field in the
/// functions M: `u_c` at corners, and `(u_e - a (u_1 + u_2)) / (1 - 2 a)` at mid-edge nodes, where a is [`SHARE`].
fn slave_matrix(shape: Shape, d: &Mat<f64>) -> Mat<f64> {
    let mut own = Mat::from_fn(d.nrows(), d.nrows(), |i, j| if i == j { d[(i, 0)] } else { 0.0 });
    for &[middle, a, b] in shape.edges() {
        let scaled = d[(middle, 0)] / (1.0 - 2.0 * SHARE);
        own[(middle, middle)] = scaled;
        (own[(middle, a)], own[(middle, b)]) = (-SHARE * scaled, -SHARE * scaled);
    }
    own
}
