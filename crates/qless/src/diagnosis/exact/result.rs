//! What exact arithmetic finds.

use super::Reading;

/// `rank C_f` and `rank [C_f | b - C_p u_p]`; see [`rank`](super::rank()).
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct ExactRank {
    /// What a double was taken for.
    pub reading: Reading,
    /// Rank of `C_f`, the columns of free DOFs.
    pub rank: usize,
    /// Rank of `[C_f | b - C_p u_p]`: the same where the equations have a solution, else one more.
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
    /// Its number of equations.
    pub equations: usize,
    /// The rank of their free DOFs' coefficients.
    pub rank: usize,
    /// Whether they have a solution.
    pub solvable: bool,
}

impl ExactRank {
    /// Whether `C_f u_f = b - C_p u_p` has a solution.
    pub fn is_solvable(&self) -> bool {
        self.augmented_rank == self.rank
    }
}
