//! Stability of an equilibrium: the number of negative eigenvalues of `Z^T (K + H) Z`, where Z is a basis of `G Z = 0`.
//!
//! An inertia counts positive and negative eigenvalues. Let `M = [K + H, G^T; G, -s I]` with m rows of G and a shift s; then `inertia M =
//! inertia (K + H + G^T G / s) + (0, m)`. For `A = M + s [0, 0; 0, I]`, `inertia A = inertia (Z^T (K + H) Z) + (m, m)` (Gould 1985). Both
//! have the same inertia if no `M - t (M - A)`, `0 <= t <= 1`, is singular, that is, if the powers of `M^-1 (M - A) = I - M^-1 A` decay.
//! This is checked with the computed factors `L D L^T`, including their rounding. If they do not prove the inertia, the result is
//! undecided.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::ldlt::factor::LdltRegularization;
use faer::sparse::Triplet;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LdltRef, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::{Conj, MatMut, Par, Side, Spec};

use super::saddle::norm;
use crate::common::{SparseMatrix, random, times};

/// Values of the shift s to try, for a saddle matrix A with entries of size one; M is A with `-s I` in the zero block. With a large s, M
/// differs much from A; with a small s, the stiffness is lost to rounding. Values near the square root of eps avoid both.
const SHIFTS: [f64; 4] = [1e-6, 1e-8, 1e-4, 1e-10];
/// Limit for the number of terms of `G^T G`, relative to the entries of the saddle matrix A. An equation with all DOFs would make `G^T G` a
/// full matrix. At a hundred, memory is still that of a factorization.
const FILL: usize = 100;
/// Number of applications of `M^-1 (M - A)` to a vector, where M is the shifted saddle matrix A. They prove the inertia if they shrink the
/// vector to a third or less per application, on average.
const POWERS: i32 = 6;

/// Whether the energy has a minimum at an equilibrium, among the motions that the constraints allow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Stability {
    /// The tangent is positive definite on the admissible motions.
    Stable,
    /// The tangent has negative eigenvalues on the admissible motions.
    Unstable {
        /// Number of independent motions that lower the energy: negative eigenvalues of the tangent on the admissible motions.
        directions: usize,
    },
    /// The tangent is not symmetric, so that there is no energy.
    NotSymmetric,
    /// The equilibrium is too close to a critical point, or the tangent too badly conditioned, for signs of pivots to prove anything.
    Undecided,
}

impl Stability {
    /// Stability of a model from that of its parts; one part that is not symmetric or undecided makes the model so.
    pub(super) fn of_parts(parts: impl Iterator<Item = Self>) -> Self {
        parts.fold(Self::Stable, |all, part| match (all, part) {
            (Self::NotSymmetric, _) | (_, Self::NotSymmetric) => Self::NotSymmetric,
            (Self::Undecided, _) | (_, Self::Undecided) => Self::Undecided,
            (Self::Unstable { directions: a }, Self::Unstable { directions: b }) => {
                Self::Unstable { directions: a + b }
            }
            (Self::Stable, other) | (other, Self::Stable) => other,
        })
    }
}

/// Stability by a scaled saddle matrix, whose first `free` rows are DOFs.
pub fn stability(a: &SparseMatrix, free: usize) -> Stability {
    if !symmetric(a) {
        return Stability::NotSymmetric;
    }
    if free == 0 {
        return Stability::Stable;
    }
    match SHIFTS.iter().find_map(|&shift| InertiaFactors::new(a, free, shift)?.proven(a)) {
        Some(0) => Stability::Stable,
        Some(directions) => Stability::Unstable { directions },
        None => Stability::Undecided,
    }
}

fn symmetric(a: &SparseMatrix) -> bool {
    let column = |j: usize| a.symbolic().row_idx_of_col(j).zip(a.val_of_col(j));
    let other = |i: usize, j: usize| a.get(i, j).copied().unwrap_or(0.0);
    // Half of the digits: more than the rounding of an assembly, less than any real asymmetry.
    (0..a.ncols()).all(|j| column(j).all(|(i, v)| (v - other(j, i)).abs() <= f64::EPSILON.sqrt()))
}

/// Factors `K + H + G^T G / s = L D L^T`, with the tangent K + H, the constraint Jacobian G and the shift s.
struct InertiaFactors {
    free: usize,
    shift: f64,
    symbolic: SymbolicCholesky<usize>,
    values: Vec<f64>,
}

impl InertiaFactors {
    fn new(a: &SparseMatrix, free: usize, shift: f64) -> Option<Self> {
        let stiff = stiffened(a, free, shift)?;
        // Only simplicial factors give access to D.
        let simplicial = SupernodalThreshold::FORCE_SIMPLICIAL;
        let params = CholeskySymbolicParams { supernodal_flop_ratio_threshold: simplicial, ..Default::default() };
        let (side, order) = (Side::Upper, SymmetricOrdering::Amd);
        let symbolic = factorize_symbolic_cholesky(stiff.symbolic(), side, order, params).ok()?;
        let mut values = vec![0.0; symbolic.len_val()];
        let room = symbolic.factorize_numeric_ldlt_scratch::<f64>(Par::Seq, Spec::default());
        let (mut room, none) = (MemBuffer::try_new(room).ok()?, LdltRegularization::default());
        let (stack, spec) = (MemStack::new(&mut room), Spec::default());
        symbolic.factorize_numeric_ldlt(&mut values, stiff.as_ref(), side, none, Par::Seq, stack, spec).ok()?;
        Some(Self { free, shift, symbolic, values })
    }

    /// The number of negative pivots, if it is proven to be the number of negative eigenvalues of the tangent on the admissible motions.
    fn proven(&self, a: &SparseMatrix) -> Option<usize> {
        let mut x: Vec<f64> = (0..a.ncols() as u64).map(random).collect();
        let before = norm(&x);
        for _ in 0..POWERS {
            let image = self.solve(a, &times(a, &x))?;
            x.iter_mut().zip(image).for_each(|(x, image)| *x -= image);
        }
        let SymbolicCholeskyRaw::Simplicial(raw) = self.symbolic.raw() else { return None };
        let pivots = raw.col_ptr()[..self.free].iter().map(|&first| self.values[first]);
        (norm(&x) <= before * 3_f64.powi(-POWERS)).then(|| pivots.filter(|pivot| *pivot < 0.0).count())
    }

    /// `M^-1 b` for the shifted saddle matrix `M = [K + H, G^T; G, -s I]`: `x = (K + H + G^T G / s)^-1 (b_1 + G^T b_2 / s)`,
    /// `y = (G x - b_2) / s`.
    fn solve(&self, a: &SparseMatrix, b: &[f64]) -> Option<Vec<f64>> {
        let (motion, rows) = b.split_at(self.free);
        let mut whole = [&vec![0.0; self.free][..], rows].concat();
        let pull = times(a, &whole);
        let mut x: Vec<f64> = motion.iter().zip(pull).map(|(b, pull)| b + pull / self.shift).collect();
        let mut room = MemBuffer::try_new(self.symbolic.solve_in_place_scratch::<f64>(1, Par::Seq)).ok()?;
        let stack = MemStack::new(&mut room);
        let column = MatMut::from_column_major_slice_mut(&mut x, self.free, 1);
        LdltRef::new(&self.symbolic, &self.values).solve_in_place_with_conj(Conj::No, column, Par::Seq, stack);
        whole[..self.free].copy_from_slice(&x);
        whole[self.free..].fill(0.0);
        let moved = times(a, &whole);
        let of_rows = moved[self.free..].iter().zip(rows).map(|(moved, b)| (moved - b) / self.shift);
        Some(x.iter().copied().chain(of_rows).collect())
    }
}

/// The upper half of `K + H + G^T G / s`, from the saddle matrix `a`; none if it would have too many entries.
fn stiffened(a: &SparseMatrix, free: usize, shift: f64) -> Option<SparseMatrix> {
    let column = |j: usize| a.symbolic().row_idx_of_col(j).zip(a.val_of_col(j));
    // In the saddle matrix, the columns after the DOFs hold `G^T`.
    let rows = free..a.ncols();
    let terms: usize = rows.clone().map(|r| a.symbolic().row_idx_of_col(r).len().pow(2)).sum();
    if terms > FILL * a.compute_nnz() {
        return None;
    }
    let upper = |i: usize, j: usize| i <= j && j < free;
    let mut list: Vec<_> = (0..free).flat_map(|j| column(j).map(move |(i, &v)| Triplet::new(i, j, v))).collect();
    for r in rows {
        for (j, &b) in column(r) {
            list.extend(column(r).map(|(i, &a)| Triplet::new(i, j, a * b / shift)));
        }
    }
    list.retain(|entry| upper(entry.row, entry.col));
    SparseMatrix::try_new_from_triplets(free, free, &list).ok()
}

#[cfg(test)]
mod tests {
    use super::Stability::{self, NotSymmetric, Stable, Undecided, Unstable};

    #[test]
    fn motions_of_all_parts_count() {
        let [one, two, three] = [1, 2, 3].map(|directions| Unstable { directions });
        for (parts, all) in [
            (vec![], Stable),
            (vec![Stable, one, two, Stable], three),
            (vec![one, Undecided, Stable], Undecided),
            (vec![Undecided, NotSymmetric, one], NotSymmetric),
        ] {
            assert_eq!(Stability::of_parts(parts.into_iter()), all);
        }
    }
}
