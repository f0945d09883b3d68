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
    /// A DOF that is needed.
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
    /// A number that is NaN or infinite.
    #[error("rank {rank}: {what} is {value}; every number must be finite")]
    NotFinite {
        /// The rank that gave it.
        rank: usize,
        /// Which number.
        what: SharePlace,
        /// The value found.
        value: f64,
    },
    /// A DOF that no rank owns.
    #[error("rank {rank}: {what} names a DOF that is not there: the ranks own DOFs 0 to {dofs} (excluded)")]
    DofOutOfRange {
        /// The rank that named it.
        rank: usize,
        /// The place where it occurs.
        what: SharePlace,
        /// How many DOFs there are.
        dofs: u64,
    },
    /// Ranges of owned DOFs that do not follow one another.
    #[error(
        "rank {rank} owns DOFs from {start}, but the ranks before it own those up to {expected} (excluded); the ranges must follow one another from 0"
    )]
    Ranges {
        /// The first such rank.
        rank: usize,
        /// Where its range starts.
        start: u64,
        /// Where it should start.
        expected: u64,
    },
    /// A DOF with two different prescribed values.
    #[error("DOF {dof} is prescribed twice, as {first} and as {second}; remove one")]
    PrescribedTwice {
        /// The DOF.
        dof: u64,
        /// The value of the rank that comes first.
        first: f64,
        /// The other value.
        second: f64,
    },
    /// Two equations with the same number.
    #[error("rank {rank}: equation {number} was given before; each equation needs a number of its own")]
    NumberTwice {
        /// The rank that gave it again.
        rank: usize,
        /// The number.
        number: u64,
    },
    /// A number that cannot be one of an equation or of a DOF.
    #[error("rank {rank}: the number {number} is too large: numbers of equations and DOFs lie below 2^62")]
    NumberTooLarge {
        /// The rank that gave it.
        rank: usize,
        /// The number.
        number: u64,
    },
}
