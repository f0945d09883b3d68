//! Why a factorization is refused: every condition is checked before the work that it would spoil.

/// What analyses, factorizations and solutions refuse.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The pattern is no m x n pattern in compressed columns with ascending row indices.
    #[error("column {column} of the pattern is malformed: {what}")]
    Pattern {
        /// The first column at fault.
        column: usize,
        /// What is wrong with it.
        what: &'static str,
    },
    /// The starts of a [`Matrix`](crate::Matrix) do not ascend from 0 to the number of its entries.
    #[error("start[{at}] is {found}: starts ascend from 0 to the number of entries, {entries}")]
    Start {
        /// Which of them.
        at: usize,
        /// What it is (`usize::MAX`: no number that an array could have).
        found: usize,
        /// How many entries the matrix has.
        entries: usize,
    },
    /// An entry of a [`Matrix`](crate::Matrix) lies outside of it.
    #[error("entry {entry} has the index {found}, which must be below {bound}")]
    Index {
        /// Which entry.
        entry: usize,
        /// Its index (`usize::MAX`: negative).
        found: usize,
        /// How many rows or columns there are.
        bound: usize,
    },
    /// An array is not as long as the pattern says.
    #[error("{what} has {found} entries, not {expected}")]
    Length {
        /// Which array.
        what: &'static str,
        /// Its length.
        found: usize,
        /// What the length must be (of the right-hand sides: a multiple of it).
        expected: usize,
    },
    /// More rows, columns or entries than 31-bit indices count.
    #[error("a {rows} x {cols} matrix with {entries} entries is larger than its indices can count")]
    TooLarge {
        /// Rows.
        rows: usize,
        /// Columns.
        cols: usize,
        /// Entries.
        entries: usize,
    },
    /// The tolerance is negative or not a number.
    #[error("the tolerance {0} is no distance")]
    Tolerance(f64),
    /// A number of the matrix or of the right-hand sides is infinite or not a number.
    #[error("{0} holds a number that is not finite")]
    NotFinite(&'static str),
    /// Numbers grew beyond the floating-point range.
    #[error("the factorization overflows: scale the matrix")]
    Overflow,
    /// More memory than allowed or than there is.
    #[error("the factorization needs {needed} bytes, {limit} are allowed")]
    OutOfMemory {
        /// Bytes needed, as far as known when it stopped.
        needed: usize,
        /// Bytes allowed.
        limit: usize,
    },
    /// [`solve`](crate::solve()) was given a matrix that is not square.
    #[error("a {rows} x {cols} matrix is not square: see least_squares and minimum_norm")]
    NotSquare {
        /// Rows.
        rows: usize,
        /// Columns.
        cols: usize,
    },
    /// [`solve`](crate::solve()) was given a matrix with dependent columns.
    #[error("the rank is {rank}, not {cols}: see least_squares and minimum_norm")]
    Singular {
        /// Rank found.
        rank: usize,
        /// Columns.
        cols: usize,
    },
    /// Q is needed and was not kept.
    #[error("Q was not kept: factor with Options::keep_q(true)")]
    NoQ,
    /// The ordering library failed.
    #[error("no column order was found: {0}")]
    Ordering(String),
}
