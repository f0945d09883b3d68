//! `A x = b` by the author's solver: a trait of two functions, and three of faer's factorizations that have it.

use faer::MatMut;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::ldlt::factor::LdltRegularization;
use faer::prelude::Solve;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LdltRef, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::linalg::solvers as sparse;
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, Par, Side, Spec};
use qless::Storage;

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
/// use qless_constraints::enforce::{Columns, Llt, Solver};
/// let a = Columns { starts: &[0, 2, 4], rows: &[0, 1, 0, 1], values: &[2.0, 1.0, 1.0, 2.0], storage: Default::default() };
/// let mut solver = Llt::default();
/// solver.factor(a)?;
/// let mut x = [3.0, 3.0];
/// solver.solve(&mut x)?;
/// assert!((x[0] - 1.0).abs() < 1e-15 && (x[1] - 1.0).abs() < 1e-15);
/// # Ok::<(), qless_constraints::enforce::SolverError>(())
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
    fn of(error: impl std::fmt::Debug) -> Self {
        Self(format!("{error:?}"))
    }

    fn not_factored() -> Self {
        Self("solve was called before factor".into())
    }
}

/// faer's `L L^T`, for symmetric positive definite matrices.
#[derive(Debug, Default)]
pub struct Llt {
    symbolic: Option<sparse::SymbolicLlt<u32>>,
    factors: Option<sparse::Llt<u32, f64>>,
}

/// faer's `L D L^T` without pivoting, for symmetric matrices that have it.
#[derive(Debug, Default)]
pub struct Ldlt {
    symbolic: Option<SymbolicCholesky<u32>>,
    factors: Vec<f64>,
}

/// faer's LU with partial pivoting, for whatever is not singular; all entries must be stored.
#[derive(Debug, Default)]
pub struct Lu {
    symbolic: Option<sparse::SymbolicLu<u32>>,
    factors: Option<sparse::Lu<u32, f64>>,
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

impl Solver for Llt {
    fn factor(&mut self, matrix: Columns) -> Result<(), SolverError> {
        let symbolic = match self.symbolic.take() {
            Some(symbolic) => symbolic,
            None => sparse::SymbolicLlt::try_new(matrix.pattern(), matrix.side()).map_err(SolverError::of)?,
        };
        self.symbolic = Some(symbolic.clone());
        let factors = sparse::Llt::try_new_with_symbolic(symbolic, matrix.matrix(), matrix.side());
        self.factors = Some(factors.map_err(SolverError::of)?);
        Ok(())
    }

    fn solve(&mut self, b: &mut [f64]) -> Result<(), SolverError> {
        let factors = self.factors.as_ref().ok_or_else(SolverError::not_factored)?;
        let rows = b.len();
        factors.solve_in_place(MatMut::from_column_major_slice_mut(b, rows, 1));
        Ok(())
    }
}

impl Solver for Ldlt {
    fn factor(&mut self, matrix: Columns) -> Result<(), SolverError> {
        if self.symbolic.is_none() {
            let (order, params) = (SymmetricOrdering::Amd, CholeskySymbolicParams::default());
            let symbolic = factorize_symbolic_cholesky(matrix.pattern(), matrix.side(), order, params);
            self.symbolic = Some(symbolic.map_err(SolverError::of)?);
        }
        let Some(symbolic) = &self.symbolic else { return Ok(()) };
        self.factors.resize(symbolic.len_val(), 0.0);
        let room = symbolic.factorize_numeric_ldlt_scratch::<f64>(Par::Seq, Spec::default());
        let mut room = MemBuffer::try_new(room).map_err(SolverError::of)?;
        let stack = MemStack::new(&mut room);
        let (a, side, values) = (matrix.matrix(), matrix.side(), &mut self.factors);
        let regularization = LdltRegularization::default();
        let done = symbolic.factorize_numeric_ldlt(values, a, side, regularization, Par::Seq, stack, Spec::default());
        done.map(drop).map_err(SolverError::of)
    }

    fn solve(&mut self, b: &mut [f64]) -> Result<(), SolverError> {
        let symbolic = self.symbolic.as_ref().ok_or_else(SolverError::not_factored)?;
        let mut room = MemBuffer::new(symbolic.solve_in_place_scratch::<f64>(1, Par::Seq));
        let rows = b.len();
        let factors = LdltRef::new(symbolic, &self.factors);
        let b = MatMut::from_column_major_slice_mut(b, rows, 1);
        factors.solve_in_place_with_conj(Conj::No, b, Par::Seq, MemStack::new(&mut room));
        Ok(())
    }
}

impl Solver for Lu {
    fn factor(&mut self, matrix: Columns) -> Result<(), SolverError> {
        if matrix.storage != Storage::Full {
            return Err(SolverError("LU needs all entries of the matrix, not one half".into()));
        }
        let symbolic = match self.symbolic.take() {
            Some(symbolic) => symbolic,
            None => sparse::SymbolicLu::try_new(matrix.pattern()).map_err(SolverError::of)?,
        };
        self.symbolic = Some(symbolic.clone());
        let factors = sparse::Lu::try_new_with_symbolic(symbolic, matrix.matrix());
        self.factors = Some(factors.map_err(SolverError::of)?);
        Ok(())
    }

    fn solve(&mut self, b: &mut [f64]) -> Result<(), SolverError> {
        let factors = self.factors.as_ref().ok_or_else(SolverError::not_factored)?;
        let rows = b.len();
        factors.solve_in_place(MatMut::from_column_major_slice_mut(b, rows, 1));
        Ok(())
    }
}
