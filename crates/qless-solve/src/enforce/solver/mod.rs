//! `A x = b` by the author's solver: a trait of two functions, and three of faer's factorizations that have it.
//!
//! They run on one thread, so that the bits are the same on any number of them.

mod cholesky;
mod lu;

use faer::Side;
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use qless::elimination::Storage;

pub use cholesky::{Ldlt, Llt};
pub use lu::Lu;

/// A square matrix in compressed columns, counted from 0, rows ascending.
#[derive(Clone, Copy, Debug)]
pub struct Columns<'a> {
    /// Where each column starts in `rows`; length n + 1.
    pub starts: &'a [u32],
    /// Row of each entry.
    pub rows: &'a [u32],
    /// Value of each entry.
    pub values: &'a [f64],
    /// Which half is stored, if not all.
    pub storage: Storage,
}

/// What solves the condensed equations.
///
/// ```
/// use qless_solve::enforce::{Columns, Llt, Solver};
/// let a = Columns { starts: &[0, 2, 4], rows: &[0, 1, 0, 1], values: &[2.0, 1.0, 1.0, 2.0], storage: Default::default() };
/// let mut solver = Llt::default();
/// solver.factor(a)?;
/// let mut x = [3.0, 3.0];
/// solver.solve(&mut x)?;
/// assert!((x[0] - 1.0).abs() < 1e-15 && (x[1] - 1.0).abs() < 1e-15);
/// # Ok::<(), qless_solve::enforce::SolverError>(())
/// ```
pub trait Solver {
    /// Takes new values. The pattern is the same in every call for one solver, so that its analysis may be kept.
    ///
    /// # Errors
    /// [`SolverError`] if the matrix has no such factors.
    fn factor(&mut self, matrix: Columns) -> Result<(), SolverError>;

    /// `b <- A^-1 b`, of the last values.
    ///
    /// # Errors
    /// [`SolverError`].
    fn solve(&mut self, b: &mut [f64]) -> Result<(), SolverError>;
}

/// Why a solver gave no solution, in its own words.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("the solver: {0}")]
pub struct SolverError(pub String);

impl SolverError {
    pub(super) fn of(error: impl std::fmt::Debug) -> Self {
        Self(format!("{error:?}"))
    }

    fn not_factored() -> Self {
        Self("solve was called before factor".into())
    }
}

impl<'a> Columns<'a> {
    fn pattern(self) -> SymbolicSparseColMatRef<'a, u32> {
        let n = self.starts.len() - 1;
        SymbolicSparseColMatRef::new_checked(n, n, self.starts, None, self.rows)
    }

    fn matrix(self) -> SparseColMatRef<'a, u32, f64> {
        SparseColMatRef::new(self.pattern(), self.values)
    }

    fn side(self) -> Side {
        if self.storage == Storage::Upper { Side::Upper } else { Side::Lower }
    }
}
