//! Why there is no exact rank.

/// An exact rank that was given up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ExactError {
    /// Elimination fills the rows in beyond the memory allowed.
    #[error(
        "exact elimination of {rows} equations was given up: they fill in to {fill} coefficients, and {limit} are allowed"
    )]
    Fill {
        /// Equations that were left to eliminate.
        rows: usize,
        /// Coefficients held when it was given up.
        fill: usize,
        /// [`Settings::fill`](super::Settings::fill).
        limit: usize,
    },
}
