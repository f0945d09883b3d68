//! `A P = Q R`, Q never formed (Eq. 21-24): the one thing a backend does.
//!
//! A backend factors one block A (m x n, any shape, any rank) and returns plain owned data. It knows
//! nothing of slaves, scaling or decks. Rather than Q it applies it: any nonsingular row transform W with
//! `W A P = [R1 R2; 0 0]` serves the callers, so that Gauss elimination is a backend too (W = L^-1).

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
mod tall;

/// The most entries that a dense backend will hold: 2 GiB.
const DENSE_LIMIT: usize = 1 << 28;

/// m n up to which blocks are dense where there is a choice: pivoting finds ranks more surely, and costs nothing there.
pub(crate) const SMALL: usize = 1 << 14;

/// Refuses a dense m x n array that would not fit.
fn dense_len(backend: &'static str, rows: usize, cols: usize) -> Result<usize, BackendError> {
    let advice = "; keep presolve on, or use a sparse backend (sparse, spqr)";
    let fits = rows.checked_mul(cols).filter(|&len| len <= DENSE_LIMIT);
    fits.ok_or(BackendError::OutOfMemory { backend, rows, cols, advice })
}

/// Refuses numbers that are not finite, a B that is not m x k, and a tolerance below zero.
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
    /// The name users choose it by: `faer`, `spqr`, `gauss`.
    fn name(&self) -> &'static str;

    /// Name and version of the library that does the work, as the report prints it.
    fn version(&self) -> String;

    /// Whether W is orthogonal, so that R has the singular values of A.
    fn is_orthogonal(&self) -> bool {
        true
    }

    /// Whether it takes the best columns of a block of this size (column pivoting), not just the first independent ones.
    fn pivots(&self, _rows: usize, _cols: usize) -> bool {
        false
    }

    /// Factors A, given by its columns (row j of `columns` is column j of A), and transforms B.
    ///
    /// `rhs` is B, m x k by columns (its length is a multiple of m). A column of A whose remaining part is at most
    /// `tolerance` in 2-norm (absolute, as A is given) counts as dependent.
    ///
    /// # Errors
    /// [`BackendError`]; no error leaves memory behind, and the next call works.
    fn factor(&self, columns: &Csr, rhs: &[f64], tolerance: f64) -> Result<Factor, BackendError>;
}

/// `W A P = [R1 R2; 0 0]` and `W B`, with R1 upper triangular and nonsingular.
#[derive(Clone, Debug, PartialEq)]
pub struct Factor {
    /// r, the number of columns found independent; R1 is r x r.
    pub rank: usize,
    /// P: `order[k]` is the column of A at position k, independent ones first; length n.
    pub order: Vec<usize>,
    /// `[R1 R2]`, r x n in the order of `order`; row i has no entry left of column i.
    pub r: Csr,
    /// First r rows of W B, r x k by columns.
    pub rhs: Vec<f64>,
    /// For each of the k right-hand sides the 2-norm of the rest of W B: what the equations cannot meet.
    pub rest: Vec<f64>,
    /// 2-norm (Frobenius) of what was treated as zero to find the rank.
    pub dropped: f64,
}

/// Why a backend could not factor a block.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BackendError {
    /// The block needs more memory than there is or than is allowed.
    #[error("{backend}: a block of {rows} x {cols} needs more memory than is available{advice}")]
    OutOfMemory {
        /// Which backend.
        backend: &'static str,
        /// Rows of the block.
        rows: usize,
        /// Columns of the block.
        cols: usize,
        /// What the user can do, opening with "; ", or nothing.
        advice: &'static str,
    },
    /// The block needs more memory than the caller allows ([`crate::Options::memory`]).
    #[error(
        "{backend}: a block of {rows} x {cols} needs {} MiB of memory and {} are allowed; allow more, or keep presolve on",
        .needed.div_ceil(1 << 20), .limit >> 20
    )]
    OverLimit {
        /// Which backend.
        backend: &'static str,
        /// Rows of the block.
        rows: usize,
        /// Columns of the block.
        cols: usize,
        /// Bytes needed, as far as known when it stopped.
        needed: usize,
        /// Bytes allowed.
        limit: usize,
    },
    /// The block is larger than the backend's index type.
    #[error("{backend}: a block of {rows} x {cols} is larger than its indices can count")]
    TooLarge {
        /// Which backend.
        backend: &'static str,
        /// Rows of the block.
        rows: usize,
        /// Columns of the block.
        cols: usize,
    },
    /// The backend was not compiled in.
    #[error("{backend}: this build does not have it; rebuild with `--features {backend}`")]
    NotCompiledIn {
        /// Which backend.
        backend: &'static str,
    },
    /// Numbers that are not finite, right-hand sides that do not fit to the block, or a tolerance that is no distance.
    #[error(transparent)]
    Argument(#[from] ArgumentError),
    /// Anything else, in the library's own words.
    #[error("{backend}: {message}")]
    Failed {
        /// Which backend.
        backend: &'static str,
        /// What it said.
        message: String,
    },
}
