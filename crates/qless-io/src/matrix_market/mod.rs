//! Reads Matrix Market files of an m x n matrix: `coordinate` or `array`, `real` or `integer`, `general`, `symmetric` or `skew-symmetric`.
//!
//! ```text
//! %%MatrixMarket matrix coordinate real general
//! % comments and blank lines may occur anywhere below the header
//! 2 3 3
//! 1 1 1.0
//! 1 3 -1.0
//! 2 2 1.0D+3
//! ```
//!
//! The first line is the header (`%MatrixMarket` is accepted too, in capitals or not). `rows columns entries` follows, and then one line
//! `row column value` for each entry. Rows and columns count from 1. Repeated entries are kept; the library sums them. Exponents may use
//! Fortran's `D`, and lines may end in CRLF.
//!
//! A file in `array` format has a line `rows columns`, and then all values column after column, each on a line. Zeros are dropped. A
//! `symmetric` file stores the lower triangle with the diagonal. A `skew-symmetric` file (`a_ji = -a_ij`) stores the triangle below the
//! diagonal.
//!
//! The following is refused, with the line: other headers (`pattern`, `complex`, `hermitian`), entries of the other triangle, lines that
//! are malformed or out of range, `nan` and `inf`, numbers that overflow or underflow to zero, and a wrong number of entries. Memory is
//! proportional to the file, not to the sizes it claims.

mod array_places;
mod coordinate;
pub(crate) mod header;

use std::path::Path;

use crate::ReadError;
use crate::error::read_file;
pub use coordinate::ChunkedMatrix;
pub(crate) use coordinate::{find_entry, parse};

/// An m x n matrix as the file lists it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Triplets {
    /// Number of rows m.
    pub rows: usize,
    /// Number of columns n.
    pub columns: usize,
    /// The entries `(row, column, value)` in the order of the file. Rows and columns count from 0.
    pub entries: Vec<(usize, usize, f64)>,
}

/// Reads a Matrix Market file.
///
/// # Errors
/// [`ReadError::Io`], or [`ReadError::Malformed`] with the line.
///
/// ```
/// # let place = tempfile::tempdir()?;
/// let path = place.path().join("C.mtx");
/// std::fs::write(&path, "%%MatrixMarket matrix coordinate real general\n2 3 1\n2 3 -1.5\n")?;
/// let matrix = qless_io::matrix_market::read(&path)?;
/// assert_eq!((matrix.rows, matrix.columns), (2, 3));
/// assert_eq!(matrix.entries, [(1, 2, -1.5)]);
///
/// std::fs::write(&path, "%%MatrixMarket matrix coordinate real general\n2 3 1\n2 4 -1.5\n")?;
/// let error = qless_io::matrix_market::read(&path).unwrap_err().to_string();
/// assert!(error.contains("C.mtx:3: column `4` is out of range: the matrix has 3 columns"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn read(path: &Path) -> Result<Triplets, ReadError> {
    parse(path, &read_file(path)?)
}
