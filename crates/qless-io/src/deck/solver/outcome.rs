//! What a solver does where two cards claim one DOF.

/// What a solver does with a fault. The first claim is that of the equation that a fault names first, the second that of the value or
/// of the other equation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Outcome {
    /// It stops.
    Refused,
    /// It drops the first claim and goes on; at most it prints a warning.
    IgnoresFirst,
    /// It drops the second claim and goes on; at most it prints a warning.
    IgnoresSecond,
    /// Both hold.
    Accepted,
    /// It may go on; what it computes is infinite, not a number, or mostly rounding.
    Unsound,
}

impl Outcome {
    /// Whether one of the two claims is dropped.
    ///
    /// ```
    /// use qless_io::deck::Outcome;
    /// assert!(Outcome::IgnoresFirst.ignores() && !Outcome::Refused.ignores());
    /// ```
    pub fn ignores(self) -> bool {
        matches!(self, Self::IgnoresFirst | Self::IgnoresSecond)
    }
}
