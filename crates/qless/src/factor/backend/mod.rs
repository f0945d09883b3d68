//! A backend computes `A P = Q R` without forming Q (Eq. 21-24 of the paper).
//!
//! It factors one block A (m x n, any shape, any rank) and returns plain owned data. It knows nothing about slaves, scaling or decks.
//! The callers need `W A P = [R1 R2; 0 0]` and `W B` for any nonsingular W. So Gauss elimination (W = L^-1) is a backend too.

use crate::common::argument::numbers;
use crate::{ArgumentError, Csr};
pub(crate) use factor::{largest_place, norm, part_of_largest};

#[cfg(test)]
pub(crate) mod check;
pub mod dense_or_sparse;
mod factor;
pub mod faer;
pub mod gauss;
pub(crate) mod many;
pub(crate) mod null;
pub mod sparse;
#[cfg(feature = "spqr")]
pub mod spqr;

/// Blocks of at most this size m n (rows times columns) are factored densely if there is a choice: column pivoting finds the rank more
/// reliably and is fast there.
pub(crate) const SMALL: usize = 1 << 14;

/// Refuses an m x n block that needs more bytes than the limit.
fn check_limit(
    backend: &'static str,
    (rows, cols): (usize, usize),
    needed: usize,
    limit: usize,
) -> Result<(), BackendError> {
    if needed > limit { Err(BackendError::OverLimit { backend, rows, cols, needed, limit }) } else { Ok(()) }
}

/// Refuses numbers that are not finite, right-hand sides that are not m x k, and a tolerance below zero.
fn check_block(columns: &Csr, rhs: &[f64], tolerance: f64) -> Result<(), ArgumentError> {
    let (m, found) = (columns.cols, rhs.len());
    if found.checked_rem(m).unwrap_or(found) != 0 {
        return Err(ArgumentError::WrongLength { what: "B", found, expected: m });
    }
    numbers("the block", &columns.val, columns.nnz())?;
    numbers("B", rhs, found)?;
    if tolerance >= 0.0 { Ok(()) } else { Err(ArgumentError::Negative { what: "the tolerance", value: tolerance }) }
}

/// Rank-revealing factorization of one block.
pub trait Backend: Send + Sync {
    /// The name by which users choose it: `faer`, `sparse`, `spqr`, `gauss`.
    fn name(&self) -> &'static str;

    /// Name and version of the library that computes the factorization, for the report.
    fn version(&self) -> String;

    /// Returns true if W in `W A P = [R1 R2; 0 0]` is orthogonal; `[R1 R2]` then has the singular values of the block A.
    fn is_orthogonal(&self) -> bool {
        true
    }

    /// Returns true if the backend pivots columns for a block of this size, instead of keeping the first independent ones.
    fn pivots(&self, _rows: usize, _cols: usize) -> bool {
        false
    }

    /// Factors the block A and transforms its right-hand sides B. Row j of `columns` is column j of A.
    ///
    /// `rhs` is B, m x k by columns (its length is a multiple of m). A column of A is dependent if the 2-norm of its remainder is at
    /// most `tolerance`, an absolute value.
    ///
    /// # Errors
    /// [`BackendError`]; after an error all memory is freed and the backend can be called again.
    fn factor(&self, columns: &Csr, rhs: &[f64], tolerance: f64) -> Result<Factor, BackendError>;
}

/// The factors `W A P = [R1 R2; 0 0]` of a block A, and its transformed right-hand sides `W B`. R1 is upper triangular and nonsingular.
#[derive(Clone, Debug, PartialEq)]
pub struct Factor {
    /// r, the number of independent columns; R1 is r x r.
    pub rank: usize,
    /// The column order P: `order[k]` is the column of A at position k, independent ones first; length n.
    pub order: Vec<usize>,
    /// The factor `[R1 R2]` of the independent and dependent columns, r x n in the order of `order`; row i has no entry left of column i.
    pub r: Csr,
    /// The first r rows of the transformed right-hand sides `W B`; r x k, by columns.
    pub rhs: Vec<f64>,
    /// For each of the k right-hand sides, its residual: the 2-norm of the remaining entries of its column of `W B`.
    pub rest: Vec<f64>,
    /// Frobenius norm of the entries that were treated as zero to find the rank.
    pub dropped: f64,
}

/// Why a backend could not factor a block.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BackendError {
    /// The block needs more memory than is available, or than the backend allows for a dense block.
    #[error("{backend}: a block of {rows} x {cols} needs more memory than is available{advice}")]
    OutOfMemory {
        /// The name of the backend.
        backend: &'static str,
        /// Rows of the block.
        rows: usize,
        /// Columns of the block.
        cols: usize,
        /// What the user can do, starting with "; ". Empty if there is no advice.
        advice: &'static str,
    },
    /// The block needs more memory than the caller allows ([`crate::Options::memory`]).
    #[error(
        "{backend}: a block of {rows} x {cols} needs {} MiB of memory and {} are allowed; allow more, or keep presolve on",
        .needed.div_ceil(1 << 20), .limit >> 20
    )]
    OverLimit {
        /// The name of the backend.
        backend: &'static str,
        /// Rows of the block.
        rows: usize,
        /// Columns of the block.
        cols: usize,
        /// Bytes needed, a lower bound if the factorization stopped early.
        needed: usize,
        /// Bytes allowed.
        limit: usize,
    },
    /// The block has more rows or columns than the backend's index type can count.
    #[error("{backend}: a block of {rows} x {cols} is larger than its indices can count")]
    TooLarge {
        /// The name of the backend.
        backend: &'static str,
        /// Rows of the block.
        rows: usize,
        /// Columns of the block.
        cols: usize,
    },
    /// The backend was not compiled in.
    #[error("{backend}: this build does not include it; rebuild with `--features {backend}`")]
    NotCompiledIn {
        /// The name of the backend.
        backend: &'static str,
    },
    /// A number that is not finite, right-hand sides whose length is not a multiple of m, or a tolerance that is negative or NaN.
    #[error(transparent)]
    Argument(#[from] ArgumentError),
    /// Another error, with the message of the library.
    #[error("{backend}: {message}")]
    Failed {
        /// The name of the backend.
        backend: &'static str,
        /// The message of the library.
        message: String,
    },
}
