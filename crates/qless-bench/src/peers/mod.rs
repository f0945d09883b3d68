//! Other libraries as [`qless::backend::Backend`]s: Eigen's SparseQR, which the paper uses, and LAPACK's dgeqp3; and solvers that find a
//! rank without eliminating: MUMPS and HiGHS ([`Solver`]).
//!
//! A call cannot be interrupted, so it runs in a child process ([`super::child`]).

mod call;
mod eigen;
pub mod eliminate;
mod lapack;
mod solvers;
#[cfg(test)]
mod tests;

pub use eigen::Eigen;
pub use lapack::Lapack;
pub use solvers::Solver;

use qless::{ConstraintSystem, Csr};

/// The columns of C for its free DOFs: row j of the result is the j-th of these columns.
fn free_columns(system: &ConstraintSystem) -> Csr {
    let all = system.matrix().transpose().expect("a system has few enough DOFs");
    let mut free = Csr::empty(system.equations());
    let is_free = |j: &usize| system.prescribed().binary_search_by_key(j, |p| p.0).is_err();
    (0..system.dofs()).filter(is_free).for_each(|j| free.push_row(all.row(j)).expect("a row of another matrix"));
    free
}

/// The rule for entries that count as zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rule {
    /// The library's own rule for entries that count as zero. LAPACK has no such rule: diagonal entries of R up to `max(m, n) eps |R_11|`
    /// count as zero.
    Own,
    /// The absolute tolerance that the caller passes.
    Call,
}
