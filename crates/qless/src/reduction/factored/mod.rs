//! `u_s = C_S^-1 (b - C_M u_q - C_p u_p)`: a part of the equations whose T is applied by factors instead of formed (Eq. 23 of the paper).
//!
//! `C_S = U^T L^T` by sparse LU of C^T with threshold pivoting, which chooses well-conditioned slaves among all DOFs of the part.
//! Each application takes two triangular solves and a step of refinement, O(nnz(L) + nnz(U) + nnz(C)).

mod choose;
mod entries;
mod factors;
mod finishing;
mod predict;

use crate::Csr;
use crate::factor::solver::SlaveSolver;
use crate::input::scale::ldexp;

pub(super) use choose::factor;
pub use factors::Parts;
pub(super) use predict::predict;

/// A part of the equations in factored form. DOFs are the user's, 0-based.
///
/// With `C_S`, `C_M` and `C_p` the columns of slaves, masters and prescribed DOFs of its [`FactoredBlock::equations`]:
/// `u_s = C_S^-1 (b - C_M u_q - C_p u_p)`, and `T^T f_s = -C_M^T C_S^-T f_s`.
#[derive(Clone, Debug)]
pub struct FactoredBlock {
    pub(crate) equations: Vec<usize>,
    pub(crate) slaves: Vec<usize>,
    pub(crate) masters: Vec<usize>,
    pub(crate) prescribed: Vec<usize>,
    pub(crate) predicted: usize,
    pub(crate) growth: f64,
    solver: SlaveSolver,
    /// The scaled columns C_M of the masters, in the order of `masters`. The next field has C_p in the order of `prescribed`.
    of_masters: Csr,
    of_prescribed: Csr,
    /// The scaled right-hand sides b.
    pub(crate) rhs: Vec<f64>,
    /// Exponents of the scaling of slaves, masters and prescribed DOFs; empty if columns are not scaled.
    exponents: [Vec<i32>; 3],
    /// Exponents of the scaling of the equations.
    rows: Vec<i32>,
}

/// Multiplies each `x_i` by `2^(sign exponents_i)`.
fn rescale(x: &mut [f64], exponents: &[i32], sign: i32) {
    x.iter_mut().zip(exponents).for_each(|(x, &e)| *x = ldexp(*x, sign * e));
}

impl FactoredBlock {
    /// The independent equations of the part, ascending.
    pub fn equations(&self) -> &[usize] {
        &self.equations
    }

    /// Slaves, in the order of the elimination.
    pub fn slaves(&self) -> &[usize] {
        &self.slaves
    }

    /// Free DOFs of the part that are not slaves, ascending.
    pub fn masters(&self) -> &[usize] {
        &self.masters
    }

    /// Prescribed DOFs of the part, ascending.
    pub fn prescribed(&self) -> &[usize] {
        &self.prescribed
    }

    /// Number of nonzeros that the rows of T of this part would have: an estimate from a sample of columns, or an upper bound if that is
    /// smaller.
    pub fn predicted(&self) -> usize {
        self.predicted
    }

    /// Largest entry of T that the search found.
    pub fn growth(&self) -> f64 {
        self.growth
    }

    /// Sets `u_s = T u_q + G u_p` in u, which has all DOFs and holds masters and prescribed values.
    pub(crate) fn set_slaves(&self, u: &mut [f64]) {
        let scaled = |dofs: &[usize], exponents: &[i32]| {
            let mut x: Vec<f64> = dofs.iter().map(|&j| u[j]).collect();
            rescale(&mut x, exponents, -1);
            x
        };
        let mut right = vec![0.0; self.rhs.len()];
        let sides = [
            (&self.of_masters, scaled(&self.masters, &self.exponents[1])),
            (&self.of_prescribed, scaled(&self.prescribed, &self.exponents[2])),
        ];
        for (matrix, x) in sides {
            right.iter_mut().zip(matrix.product(&x)).for_each(|(b, part)| *b -= part);
        }
        let mut x = self.solver.solve_dense(&right);
        rescale(&mut x, &self.exponents[0], 1);
        self.slaves.iter().zip(x).for_each(|(&j, x)| u[j] = x);
    }

    /// The constants g of the slaves, in the order of `slaves`.
    pub(crate) fn constants(&self) -> Vec<f64> {
        let mut x = self.solver.solve_dense(&self.rhs);
        rescale(&mut x, &self.exponents[0], 1);
        x
    }

    /// Adds `T^T f_s` to f at its masters and `G^T f_s` at its prescribed DOFs.
    pub(crate) fn pull_back(&self, f: &mut [f64]) {
        let mut own: Vec<f64> = self.slaves.iter().map(|&j| f[j]).collect();
        rescale(&mut own, &self.exponents[0], 1);
        let y = self.solver.solve_transposed(&own);
        for (matrix, dofs, exponents) in [
            (&self.of_masters, &self.masters, &self.exponents[1]),
            (&self.of_prescribed, &self.prescribed, &self.exponents[2]),
        ] {
            let mut sum = vec![0.0; dofs.len()];
            y.iter().enumerate().for_each(|(i, y)| matrix.row(i).for_each(|(j, v)| sum[j] -= v * y));
            rescale(&mut sum, exponents, -1);
            dofs.iter().zip(sum).for_each(|(&j, sum)| f[j] += sum);
        }
    }

    /// Replaces b by the values of a new right-hand side of the system; returns the old b.
    pub(crate) fn set_rhs(&mut self, rhs: &[f64], row_exponents: &[i32]) -> Vec<f64> {
        let new = self.equations.iter().map(|&i| ldexp(rhs[i], row_exponents[i])).collect();
        std::mem::replace(&mut self.rhs, new)
    }

    /// Number of stored entries of the factors L and U and of the columns of masters and prescribed DOFs.
    pub fn nnz(&self) -> usize {
        self.solver.nnz() + self.of_masters.nnz() + self.of_prescribed.nnz()
    }
}
