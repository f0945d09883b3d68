//! `rank C_f` and `rank [C_f | b - C_p u_p]` in exact arithmetic, modulo two primes drawn at random. C_f and C_p are the columns of free
//! and of prescribed DOFs.
//!
//! This rank has no tolerance: an equation is exactly a combination of others, or it is not. So exact arithmetic decides a rank that the
//! floating-point analysis calls ambiguous, provided that the numbers are exact as given. Equations that were rounded before they were
//! typed (0.3333 for 1/3) are not exactly dependent; for these the floating-point rank is the intended one.
//!
//! # How sure
//! Take a matrix of whole numbers, whose rows may be scaled by powers of ten or two. Its rank modulo p is the exact rank or smaller, never
//! larger. It is smaller only if p divides every minor of the size of the rank. A double is a whole
//! number below 10^17 times a power of ten between -324 and 308, so each row of such a minor is below `2^2177` in 2-norm (for at
//! most 2^32 DOFs), and by Hadamard a minor of size r is below `2^(2177 r)`. At most `2177 r / 60 < 40 r` primes above 2^60 divide it;
//! `[C_f | b - C_p u_p]`, whose last column holds products, adds less than 120 to that. Of the primes between 2^60 and 2^61
//! there are 2.7e16, and the larger of two ranks counts. So the chance that a rank is too small is at most
//!
//! ```text
//! (40 (r + 3) / 2.7e16)^2   =  2e-24 for r = 1000,  2e-18 for r = 1,000,000
//! ```
//!
//! over all draws of the primes, for any matrix chosen before they are drawn. With the fixed seed of [`Settings`] results repeat; another
//! seed checks them independently. The same bound holds for the rank of a single connected part.
//!
//! # The steps
//! DOFs that occur in one equation, and equations with one unknown DOF, are counted without arithmetic, once for both primes. The other
//! equations are eliminated modulo each prime, from the shortest row and its rarest column, so two-term equations come before longer
//! ones. If the rows fill in beyond the limit, the result is [`ExactError::Fill`].
//!
//! ```
//! use qless::SystemBuilder;
//! use qless::exact::{self, Reading};
//! let mut builder = SystemBuilder::new(2);
//! for x in [0.1, 0.2, 0.3] {
//!     builder.equation([(0, x), (1, 10.0 * x)], 5.0 * x);
//! }
//! let system = builder.build()?;
//! // Row 3 is the sum of the others as it was typed. As stored it is not: in binary 0.1 + 0.2 is not 0.3.
//! let typed = exact::rank(&system, Reading::Typed)?;
//! assert_eq!((typed.rank, typed.is_solvable()), (1, true));
//! assert_eq!(exact::rank(&system, Reading::Stored)?.rank, 2);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub(super) mod eliminate;
pub(super) mod field;
pub(super) mod prime;
mod row;
mod run;

use crate::ConstraintSystem;

pub use crate::input::reading::Reading;

/// How a rank is computed; can be made from a [`Reading`] with defaults for the rest.
///
/// ```
/// use qless::exact::{Reading, Settings};
/// let other_primes = Settings { seed: 7, ..Reading::Typed.into() };
/// assert_eq!(other_primes.fill, Settings::from(Reading::Stored).fill);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Settings {
    /// How a double is read as a number.
    pub reading: Reading,
    /// Seed from which the primes are drawn. Default: 1.
    pub seed: u64,
    /// Coefficients that the elimination may hold at a time for each prime, 24 bytes each. Default: 2^25, so 0.8 GB for each.
    pub fill: usize,
}

impl From<Reading> for Settings {
    fn from(reading: Reading) -> Self {
        Self { reading, seed: 1, fill: 1 << 25 }
    }
}

/// `rank C_f` and `rank [C_f | b - C_p u_p]`, in total and for each connected part; `C_f` are the columns of free DOFs.
///
/// `settings` is a [`Reading`], or [`Settings`] for other primes or more memory. Uses two threads if there are two. The result does not
/// depend on the number of threads, nor on the order of equations and DOFs.
///
/// # Errors
/// [`ExactError::Fill`].
///
/// ```
/// use qless::SystemBuilder;
/// use qless::exact::{self, Reading};
/// // u0 = u1 twice, and u2 = 1 with u2 prescribed as 1.5: its own part, without a free DOF.
/// let mut builder = SystemBuilder::new(3);
/// builder.equation([(0, 1.0), (1, -1.0)], 0.0);
/// builder.equation([(2, 1.0)], 1.0);
/// builder.equation([(0, 0.1), (1, -0.1)], 0.0);
/// builder.prescribe(2, 1.5);
/// let exact = exact::rank(&builder.build()?, Reading::Typed)?;
/// assert_eq!((exact.rank, exact.augmented_rank), (1, 2));
/// assert_eq!(exact.part_of, [0, 1, 0]);
/// assert_eq!((exact.parts[0].rank, exact.parts[0].solvable), (1, true));
/// assert_eq!((exact.parts[1].rank, exact.parts[1].solvable), (0, false));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn rank(system: &ConstraintSystem, settings: impl Into<Settings>) -> Result<ExactRank, ExactError> {
    run::rank(system, settings.into())
}

/// Why an exact rank was not computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ExactError {
    /// Elimination fills the rows in beyond the memory allowed.
    #[error(
        "exact elimination of {rows} equations was given up: they fill in to {fill} coefficients, and {limit} are allowed"
    )]
    Fill {
        /// Number of equations that the sparse elimination was given, without those that need no arithmetic.
        rows: usize,
        /// Number of stored coefficients when elimination was given up.
        fill: usize,
        /// The limit: [`Settings::fill`](Settings::fill).
        limit: usize,
    },
}

/// The ranks of `C_f` and `[C_f | b - C_p u_p]`, computed by [`rank`](rank()). `C_f` are the columns of free DOFs.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct ExactRank {
    /// How doubles were read.
    pub reading: Reading,
    /// Rank of `C_f`, the columns of free DOFs.
    pub rank: usize,
    /// Rank of `[C_f | b - C_p u_p]`: that of `C_f` if the equations have a solution, else one more.
    pub augmented_rank: usize,
    /// The primes, between 2^60 and 2^61.
    pub primes: [u64; 2],
    /// For each equation the index of its connected part in `parts`.
    pub part_of: Vec<u32>,
    /// Equations connected by free DOFs, in the order of their first equations.
    pub parts: Vec<PartRank>,
}

/// The rank of one connected part.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct PartRank {
    /// Number of equations of the part.
    pub equations: usize,
    /// The rank of the equations of the part in the columns of free DOFs.
    pub rank: usize,
    /// True if the equations of the part have a solution.
    pub solvable: bool,
}

impl ExactRank {
    /// Upper bound of the probability that the rank r is too small: `(40 (r + 3) / 2.7e16)^2`, over all draws of the primes.
    pub fn error_chance(&self) -> f64 {
        (40.0 * (self.rank as f64 + 3.0) / 2.7e16).powi(2)
    }

    /// Returns true if `C_f u_f = b - C_p u_p` has a solution.
    pub fn is_solvable(&self) -> bool {
        self.augmented_rank == self.rank
    }
}
