//! The backend `faer` chooses dense or sparse QR for each block.
//!
//! A block with m n <= 2^14 is dense, because column pivoting finds the rank more reliably. A larger block is sparse, unless more than half
//! of its m n entries are stored. Operation counts need not be compared: sparse QR never needs more operations than dense QR,
//! `2 k^2 (l - k / 3)` with k the smaller and l the larger of m and n, and each of its operations is faster. On one thread with AVX-512,
//! in 1e9 operations per second:
//!
//! | block | sparse | dense |
//! | --- | --- | --- |
//! | in cache, 1100 x 1100 to 1500 x 1500, rows of 4 entries to full rows | 50 to 80 | 25 to 34 |
//! | full, 2000 x 2000 and 4000 x 400 | 55 to 62 | 13 to 19 |
//! | larger than the cache, 3000 x 3000, 6000 x 1500, 8000 x 1000 | 26 to 65 | 8 to 10 |
//! | an assignment problem, 7390 x 1726; sparse QR needs six tenths of the operations of dense QR | 57 | 8 |
//!
//! Half of the operations of column pivoting are matrix-vector products, which wait for memory. But the fill-reducing order of sparse QR
//! takes time too: 2000 x 2000 and 3000 x 3000 blocks take 0.40 s and 1.5 s with four tenths of the entries stored, and 2.1 s and 10 s
//! if full. Dense QR takes 0.8 s and 4.3 s, however many entries are stored.

use super::faer::Faer;
use super::sparse::Sparse;
use super::{Backend, BackendError, Factor, SMALL, check_limit};
use crate::Csr;

/// Dense or sparse QR as a [`Backend`]: dense for small or full blocks, sparse for the others.
#[derive(Clone, Copy, Debug)]
pub struct DenseOrSparse {
    /// Bytes that a factorization may allocate.
    pub memory: usize,
    /// Largest size m n (rows times columns) of a block that is always dense.
    pub small: usize,
}

impl DenseOrSparse {
    /// A backend whose factorizations may allocate `memory` bytes each; `small` has its default.
    pub fn new(memory: usize) -> Self {
        Self { memory, small: SMALL }
    }

    /// Refuses a dense m x n block with k right-hand sides before anything is allocated. Three m x (n + k) arrays must fit the limit: the
    /// block, R, and the remainder of a stage.
    fn allow_dense(self, rows: usize, cols: usize, rhs: usize) -> Result<(), BackendError> {
        let needed = rows.saturating_mul(cols.saturating_add(rhs)).saturating_mul(3 * size_of::<f64>());
        check_limit(Faer.name(), (rows, cols), needed, self.memory)
    }
}

impl Backend for DenseOrSparse {
    fn name(&self) -> &'static str {
        Faer.name()
    }

    fn version(&self) -> String {
        Faer.version()
    }

    fn pivots(&self, rows: usize, cols: usize) -> bool {
        rows.saturating_mul(cols) <= self.small
    }

    fn factor(&self, columns: &Csr, rhs: &[f64], tolerance: f64) -> Result<Factor, BackendError> {
        let (m, n) = (columns.cols, columns.rows());
        if self.pivots(m, n) || columns.nnz() > m.saturating_mul(n) / 2 {
            self.allow_dense(m, n, rhs.len().checked_div(m).unwrap_or(0))?;
            return Faer.factor(columns, rhs, tolerance);
        }
        Sparse { memory: self.memory }.factor(columns, rhs, tolerance)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::factor::backend::check::Random;

    const CHOICE: DenseOrSparse = DenseOrSparse { memory: usize::MAX, small: SMALL };

    #[test]
    fn identities_hold_on_the_test_families() {
        crate::factor::backend::check::families(&CHOICE);
    }

    /// A random m x n matrix with `count` entries per column.
    fn random(m: usize, n: usize, count: usize) -> Csr {
        let mut random = Random(5);
        let mut columns = Csr::empty(m);
        for _ in 0..n {
            let first = random.below(m - count + 1);
            columns.append((first..first + count).map(|i| (i, random.signed() + 2e-4)));
        }
        columns
    }

    #[test]
    fn a_dense_block_beyond_the_limit_is_refused_before_the_work() {
        let columns = random(100, 80, 90);
        let error = DenseOrSparse::new(100 * 80 * 8).factor(&columns, &[], 1e-10).expect_err("R comes beside it");
        assert!(matches!(error, BackendError::OverLimit { needed: 192_000, limit: 64_000, .. }), "{error}");
    }

    #[test]
    fn a_large_full_block_is_dense() {
        let columns = random(1500, 800, 760);
        let factor = CHOICE.factor(&columns, &[], 1e-10).expect("a factorization");
        assert_eq!(Ok(factor), Faer.factor(&columns, &[], 1e-10));
    }

    /// The equations of an assignment problem of `size`, for all pairs (k, l): `sum_j y_ijkl = x_kl` for i other than k,
    /// `sum_i y_ijkl = x_kl` for j other than l, with `y_ijkl = y_klij` (Adams and Johnson's linearization).
    fn assignment(size: usize) -> Csr {
        let place = |i: usize, j: usize| i * size + j;
        let pair = |a: usize, b: usize| size * size + a.max(b) * (a.max(b) + 1) / 2 + a.min(b);
        let mut rows = Csr::empty(pair(size * size, 0));
        for (k, l) in (0..size * size).map(|at| (at / size, at % size)) {
            for fixed in 0..2 * size {
                let others: Vec<usize> = match fixed.checked_sub(size) {
                    None if fixed != k => (0..size).filter(|&j| j != l).map(|j| place(fixed, j)).collect(),
                    Some(j) if j != l => (0..size).filter(|&i| i != k).map(|i| place(i, j)).collect(),
                    _ => continue,
                };
                let terms = others.iter().map(|&at| (pair(at, place(k, l)), 1.0));
                let mut row: Vec<_> = std::iter::once((place(k, l), -1.0)).chain(terms).collect();
                row.sort_unstable_by_key(|&(j, _)| j);
                rows.append(row);
            }
        }
        rows
    }

    #[test]
    fn an_assignment_problem_is_sparse_and_has_the_rank_of_dense_qr() {
        let rows = assignment(8);
        assert_eq!((rows.rows(), CHOICE.pivots(rows.cols, rows.rows())), (896, false));
        let factor = CHOICE.factor(&rows, &[], 1e-10).expect("a factorization");
        assert_eq!(Ok(&factor), Sparse { memory: usize::MAX }.factor(&rows, &[], 1e-10).as_ref());
        assert_eq!(factor.rank, Faer.factor(&rows, &[], 1e-10).expect("it fits").rank);
    }

    #[test]
    fn a_large_sparse_block_is_sparse() {
        let mut rows = Csr::empty(3000);
        (0..4000).for_each(|i| rows.append([(i * 7 % 2999, 2.0), (2999, 1.0)]));
        let columns = rows.transposed();
        let factor = CHOICE.factor(&columns, &[], 1e-10).expect("a factorization");
        assert_eq!(Ok(factor), Sparse { memory: usize::MAX }.factor(&columns, &[], 1e-10));
    }

    /// Sparse QR needs about as many operations as dense QR here, but a third of the time.
    #[test]
    fn a_block_that_fills_in_is_sparse() {
        let mut random = Random(9);
        let mut rows = Csr::empty(1100);
        for _ in 0..1100 {
            let mut columns: Vec<_> = (0..20).map(|_| random.below(1100)).collect();
            columns.sort_unstable();
            columns.dedup();
            rows.append(columns.into_iter().map(|j| (j, random.signed() + 2e-4)));
        }
        let factor = CHOICE.factor(&rows, &[], 1e-10).expect("a factorization");
        assert!(factor.r.nnz() > 500_000, "{} of 605,550", factor.r.nnz());
        assert_eq!(Ok(factor), Sparse { memory: usize::MAX }.factor(&rows, &[], 1e-10));
    }
}
