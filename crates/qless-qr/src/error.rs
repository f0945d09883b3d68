//! Errors of analysis, factorization and solution. Input is checked before the work that depends on it.

/// An error of an analysis, a factorization or a solution.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The arrays are not an m x n pattern in compressed columns with ascending row indices.
    #[error("column {column} of the pattern is malformed: {what}")]
    Pattern {
        /// The first malformed column.
        column: usize,
        /// What is wrong with the column.
        what: &'static str,
    },
    /// The starts of a [`Matrix`](crate::Matrix) do not ascend from 0 to the number of its entries.
    #[error("start[{at}] is {found}: starts ascend from 0 to the number of entries, {entries}")]
    Start {
        /// Index of the first wrong start.
        at: usize,
        /// The value of the first wrong start; `usize::MAX` for a negative number.
        found: usize,
        /// Number of entries of the matrix.
        entries: usize,
    },
    /// An entry of a [`Matrix`](crate::Matrix) has a row or column index out of range.
    #[error("entry {entry} has the index {found}, which must be below {bound}")]
    Index {
        /// Index of the entry in the arrays.
        entry: usize,
        /// The row or column index of the entry; `usize::MAX` for a negative number.
        found: usize,
        /// Number of rows or columns, which the index must be below.
        bound: usize,
    },
    /// An array has the wrong length.
    #[error("{what} has {found} entries, not {expected}")]
    Length {
        /// Name of the array with the wrong length.
        what: &'static str,
        /// The length of the array.
        found: usize,
        /// Required length; for right-hand sides, the length must be a multiple of this.
        expected: usize,
    },
    /// There are more rows, columns or entries than a third of the range of signed 32-bit indices.
    #[error("a {rows} x {cols} matrix with {entries} entries is larger than its indices can count")]
    TooLarge {
        /// Number of rows.
        rows: usize,
        /// Number of columns.
        cols: usize,
        /// Number of entries.
        entries: usize,
    },
    /// The tolerance is negative or not a number.
    #[error("the tolerance is {0}, but must be zero or positive")]
    Tolerance(f64),
    /// A value of the matrix or of the right-hand sides is infinite or not a number.
    #[error("{0} has a value that is infinite or not a number")]
    NotFinite(&'static str),
    /// The factorization or the solution overflows the floating-point range.
    #[error("the factorization overflows: scale the matrix")]
    Overflow,
    /// The memory limit is exceeded, or an allocation failed.
    #[error("the factorization needs {needed} bytes, but the limit is {limit}")]
    OutOfMemory {
        /// Bytes needed, as far as known when the factorization stopped.
        needed: usize,
        /// The memory limit in bytes.
        limit: usize,
    },
    /// [`solve`](crate::solve()) was given a matrix that is not square.
    #[error("a {rows} x {cols} matrix is not square: use least_squares or minimum_norm")]
    NotSquare {
        /// Number of rows.
        rows: usize,
        /// Number of columns.
        cols: usize,
    },
    /// [`solve`](crate::solve()) was given a matrix with dependent columns.
    #[error("the rank is {rank}, not {cols}: use least_squares or minimum_norm")]
    Singular {
        /// Numerical rank.
        rank: usize,
        /// Number of columns.
        cols: usize,
    },
    /// Q is needed and was not kept.
    #[error("Q was not kept: factor with Options::keep_q(true)")]
    NoQ,
    /// The ordering library failed.
    #[error("no column order was found: {0}")]
    Ordering(String),
}
