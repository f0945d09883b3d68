//! Faults in the shares of the ranks. All ranks return the same error.

/// The place of a number in a rank's share.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SharePlace {
    /// A coefficient of an equation.
    Coefficient {
        /// The number of the equation.
        equation: u64,
        /// The DOF.
        dof: u64,
    },
    /// The right-hand side of an equation.
    RightHandSide {
        /// The number of the equation.
        equation: u64,
    },
    /// The value of a prescribed DOF.
    Prescribed {
        /// The DOF.
        dof: u64,
    },
    /// A DOF that the rank asks for by [`need`](crate::Share::need).
    Needed {
        /// The DOF.
        dof: u64,
    },
}

impl std::fmt::Display for SharePlace {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Coefficient { equation, dof } => write!(f, "the coefficient in equation {equation}, DOF {dof}"),
            Self::RightHandSide { equation } => write!(f, "the right-hand side of equation {equation}"),
            Self::Prescribed { dof } => write!(f, "the prescribed value of DOF {dof}"),
            Self::Needed { dof } => write!(f, "the needed DOF {dof}"),
        }
    }
}

/// Why the shares of the ranks do not form a constraint system.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ShareError {
    /// A number is NaN or infinite.
    #[error("rank {rank}: {what} is {value}; every number must be finite")]
    NotFinite {
        /// The rank with the number.
        rank: usize,
        /// The place of the number.
        what: SharePlace,
        /// The value found.
        value: f64,
    },
    /// A rank names a DOF that no rank owns.
    #[error("rank {rank}: {what} names a DOF that does not exist: the ranks own DOFs 0 to {dofs} (excluded)")]
    DofOutOfRange {
        /// The rank that names this DOF.
        rank: usize,
        /// The place where the rank names it.
        what: SharePlace,
        /// The number of DOFs.
        dofs: u64,
    },
    /// The ranges of DOFs that the ranks own do not follow one another.
    #[error(
        "rank {rank} owns DOFs from {start}, but the ranks before it own those up to {expected} (excluded); the ranges must follow one another from 0"
    )]
    Ranges {
        /// The first rank whose range does not start at the end of the preceding range, or whose range ends before its start.
        rank: usize,
        /// The start of the range of this rank.
        start: u64,
        /// The end of the range of the rank before.
        expected: u64,
    },
    /// A DOF is prescribed with two different values.
    #[error("DOF {dof} is prescribed twice, as {first} and as {second}; remove one")]
    PrescribedTwice {
        /// The DOF.
        dof: u64,
        /// The value on the rank that comes first.
        first: f64,
        /// The second value, which differs from the first.
        second: f64,
    },
    /// Two equations have the same number.
    #[error("rank {rank}: the number {number} is used twice; each equation needs a number of its own")]
    NumberTwice {
        /// The rank with the second equation.
        rank: usize,
        /// The number.
        number: u64,
    },
    /// The number of an equation or of a DOF is too large.
    #[error("rank {rank}: the number {number} is too large: numbers of equations and DOFs must be below 2^62")]
    NumberTooLarge {
        /// The rank with the number.
        rank: usize,
        /// The number.
        number: u64,
    },
}
