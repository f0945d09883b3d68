//! Why a factorization is refused: every condition is checked before the work that it would spoil.

/// What [`Symbolic::analyse`](crate::Symbolic::analyse) and [`Symbolic::factor`](crate::Symbolic::factor) refuse.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Error {
    /// The pattern is no m x n pattern in compressed columns with ascending row indices.
    #[error("column {column} of the pattern is malformed: {what}")]
    Pattern {
        /// The first column at fault.
        column: usize,
        /// What is wrong with it.
        what: &'static str,
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
    /// The ordering library failed.
    #[error("no column order was found: {0}")]
    Ordering(String),
}
