//! `L^-1 A P = U`: the paper's Gauss elimination of one block (Figure 7, section 3.1), on sparse rows.
//!
//! The elimination proceeds row by row and pivots in rows and columns: the pivot is one of the larger entries of the shortest remaining
//! row. A row whose largest entry is at most the tolerance is numerically dependent and moves to the bottom of the block. Rows store
//! nonzeros only, so time and memory follow the fill and not m n. Nothing but [`crate::Options::memory`] bounds the fill. This backend is
//! the baseline with which the orthogonal ones are compared.

mod eliminate;
mod ledger;
mod queue;
mod row;

use super::{Backend, BackendError, Factor, check_block};
use crate::Csr;
use eliminate::GaussElimination;
use ledger::Ledger;

/// The paper's elimination as a [`Backend`].
#[derive(Clone, Copy, Debug)]
pub struct Gauss {
    /// Bytes that an elimination may allocate; it stops when fill exceeds them.
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
mod tests {
    use super::*;
    use crate::factor::backend::check;

    const GAUSS: Gauss = Gauss { memory: usize::MAX };

    #[test]
    fn identities_hold_on_the_test_families() {
        check::families(&GAUSS);
    }

    #[test]
    fn the_largest_entry_of_each_row_is_the_pivot() {
        let columns = check::from_dense(&[vec![1.0, -1.0, 2.0], vec![1.0, 2.0, -1.0], vec![2.0, 1.0, 1.0]]);
        let factor = GAUSS.factor(&columns, &[1.0, 0.0, 1.0], 1e-5).expect("small");
        // The rows are equations (12) to (14) of the paper. The pivot of (12) is u3, its largest; that of (13) + (12) / 2 = 1.5 u1 + 1.5 u2
        // = 0.5 is u1; (14) vanishes.
        assert_eq!((factor.rank, factor.order.as_slice()), (2, [2, 0, 1].as_slice()));
        assert_eq!(factor.r.row(1).collect::<Vec<_>>(), [(1, 1.5), (2, 1.5)]);
        assert_eq!((factor.rhs.as_slice(), factor.rest[0]), ([1.0, 0.5].as_slice(), 0.0));
        // A conflict stays on the right-hand side.
        assert_eq!(GAUSS.factor(&columns, &[1.0, 0.0, 0.0], 1e-5).expect("small").rest, [1.0]);
    }
}
