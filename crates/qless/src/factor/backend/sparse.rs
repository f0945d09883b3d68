//! `A P = Q R` by multifrontal QR in Rust ([`qless_qr`]) with Heath's rank detection, like SuiteSparseQR's.
//!
//! The memory for a pattern is known before anything is allocated; a block above the limit is refused.

use qless_qr::{Error, FactorParts, Options, Symbolic, Tolerance};

use super::{Backend, BackendError, Factor, check_block};
use crate::Csr;

/// Sparse QR as a [`Backend`], for blocks of every size.
#[derive(Clone, Copy, Debug)]
pub struct Sparse {
    /// Bytes that a factorization may allocate.
    pub memory: usize,
}

impl Backend for Sparse {
    fn name(&self) -> &'static str {
        "sparse"
    }

    fn version(&self) -> String {
        concat!("qless ", env!("CARGO_PKG_VERSION"), ", faer 0.24").to_owned()
    }

    fn factor(&self, columns: &Csr, rhs: &[f64], tolerance: f64) -> Result<Factor, BackendError> {
        check_block(columns, rhs, tolerance)?;
        let options = Options::new().tolerance(Tolerance::Absolute(tolerance)).memory(self.memory);
        let factor = analyse(columns)?.factor(&columns.val, rhs, options);
        let factor = factor.map_err(|error| refused(&error, columns.cols, columns.rows()))?;
        let (rank, dropped) = (factor.rank(), factor.dropped());
        let FactorParts { order, r, rhs, rest, .. } = factor.into_parts();
        let r = Csr { cols: columns.rows(), start: r.start, col: r.col, val: r.val };
        Ok(Factor { rank, order, r, rhs, rest, dropped })
    }
}

/// The symbolic analysis of a block given by its columns.
pub(super) fn analyse(columns: &Csr) -> Result<Symbolic, BackendError> {
    let (m, n) = (columns.cols, columns.rows());
    Symbolic::analyse(m, n, &columns.start, &columns.col).map_err(|error| refused(&error, m, n))
}

/// A fill-reducing order of the columns.
pub(crate) fn order(columns: &Csr) -> Result<Vec<usize>, BackendError> {
    Ok(analyse(columns)?.order().iter().map(|&j| j as usize).collect())
}

fn refused(error: &Error, rows: usize, cols: usize) -> BackendError {
    let backend = "sparse";
    match *error {
        Error::OutOfMemory { needed, limit } if needed > limit => {
            BackendError::OverLimit { backend, rows, cols, needed, limit }
        }
        Error::OutOfMemory { .. } => BackendError::OutOfMemory { backend, rows, cols, advice: "" },
        Error::TooLarge { .. } => BackendError::TooLarge { backend, rows, cols },
        _ => BackendError::Failed { backend, message: error.to_string() },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::factor::backend::check;

    #[test]
    fn identities_hold_on_the_test_families() {
        check::families(&Sparse { memory: usize::MAX });
    }

    #[test]
    fn more_memory_than_allowed_is_refused_before_the_work() {
        let columns = check::from_dense(&vec![vec![1.0; 40]; 50]);
        let error = Sparse { memory: 1000 }.factor(&columns, &[], 1e-10).expect_err("50 x 40 numbers");
        let needs = |error: &BackendError| match *error {
            BackendError::OverLimit { needed, limit: 1000, .. } => needed,
            _ => 0,
        };
        assert!(needs(&error) >= 8 * 40 * 41 / 2, "{error}");
    }
}
