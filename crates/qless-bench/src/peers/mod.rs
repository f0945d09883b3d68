//! Other libraries as [`qless::backend::Backend`]s: Eigen's SparseQR, which the paper uses, and LAPACK's dgeqp3.
//!
//! A call cannot be interrupted, so it runs in a child process ([`super::child`]).

mod call;
mod eigen;
pub mod eliminate;
mod lapack;
#[cfg(test)]
mod tests;

pub use eigen::Eigen;
pub use lapack::Lapack;

/// The rule for entries that count as zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rule {
    /// The library's own rule for entries that count as zero. LAPACK has no such rule: diagonal entries of R up to `max(m, n) eps |R_11|`
    /// count as zero.
    Own,
    /// The absolute tolerance that the caller passes.
    Call,
}
