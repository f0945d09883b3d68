//! Dense or sparse: what the backend `faer` does with a block.
//!
//! A block of at most 2^20 numbers is dense, for pivoting finds ranks more surely. A larger one is sparse if the
//! operations that its pattern asks for, times 8, are fewer than the `4 m n min(m, n)` of the dense way. Whether C or
//! `C^T` is factored is no choice: [`crate::analyse`] needs both, `C^T` for the dependent rows, C for the slaves.

use super::faer::Faer;
use super::sparse::{Sparse, analyse};
use super::{Backend, BackendError, Factor, SMALL};
use crate::Csr;

/// How many times fewer operations the sparse way must promise.
const GAIN: f64 = 8.0;

/// Dense QR with column pivoting or sparse QR, by the rule above, as a [`Backend`].
#[derive(Clone, Copy, Debug)]
pub struct DenseOrSparse {
    /// Bytes that a sparse factorization may allocate.
    pub memory: usize,
}

impl Backend for DenseOrSparse {
    fn name(&self) -> &'static str {
        Faer.name()
    }

    fn version(&self) -> String {
        Faer.version()
    }

    fn pivots(&self, rows: usize, cols: usize) -> bool {
        rows.saturating_mul(cols) <= SMALL
    }

    fn factor(&self, columns: &Csr, rhs: &[f64], tolerance: f64) -> Result<Factor, BackendError> {
        let (m, n) = (columns.cols, columns.rows());
        if self.pivots(m, n) {
            return Faer.factor(columns, rhs, tolerance);
        }
        let symbolic = analyse(columns)?;
        let dense = 4.0 * m as f64 * n as f64 * m.min(n) as f64;
        if symbolic.flops() * GAIN < dense {
            Sparse { memory: self.memory }.factor_analysed(&symbolic, columns, rhs, tolerance)
        } else {
            Faer.factor(columns, rhs, tolerance)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: usize = usize::MAX;

    #[test]
    fn identities_hold_on_the_test_families() {
        crate::qr::check::families(&DenseOrSparse { memory: ALL });
    }

    #[test]
    fn a_large_sparse_block_is_sparse() {
        let mut rows = Csr::empty(3000);
        (0..4000).for_each(|i| rows.push_row([(i * 7 % 2999, 2.0), (2999, 1.0)]));
        let columns = rows.transpose();
        let factor = DenseOrSparse { memory: ALL }.factor(&columns, &[], 1e-10).expect("a factorization");
        assert_eq!(Ok(factor), Sparse { memory: ALL }.factor(&columns, &[], 1e-10));
    }
}
