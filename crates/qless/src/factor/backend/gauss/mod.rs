//! `L^-1 A P = U`: the paper's Gauss elimination of one block (Figure 7, section 3.1), on sparse rows.
//!
//! Triangular form row by row, with pivots in rows and columns: the shortest of the remaining rows gives up an entry near its
//! largest, and a row whose largest entry is at most the tolerance is numerically dependent and moves to the bottom of the
//! block. Rows hold what is not zero, so that time and memory follow the fill and not m n. Kept as the baseline beside the
//! orthogonal backends: nothing bounds the fill but [`crate::Options::memory`].

mod eliminate;
mod ledger;
mod pivot;
mod queue;
mod row;
mod triangle;

use super::{Backend, BackendError, Factor, check_block};
use crate::Csr;
use eliminate::GaussElimination;
use ledger::Ledger;

/// The paper's elimination as a [`Backend`].
#[derive(Clone, Copy, Debug)]
pub struct Gauss {
    /// Bytes that an elimination may allocate; counted as rows fill in.
    pub memory: usize,
}

impl Backend for Gauss {
    fn name(&self) -> &'static str {
        "gauss"
    }

    fn version(&self) -> String {
        format!("gauss (qless {})", env!("CARGO_PKG_VERSION"))
    }

    fn is_orthogonal(&self) -> bool {
        false
    }

    fn factor(&self, columns: &Csr, rhs: &[f64], tolerance: f64) -> Result<Factor, BackendError> {
        check_block(columns, rhs, tolerance)?;
        let ledger = Ledger::new(columns, self.memory);
        let mut elimination = GaussElimination::new(columns, rhs, ledger)?;
        elimination.triangularize(tolerance)?;
        elimination.into_factor()
    }
}

#[cfg(test)]
mod tests;
