//! Factorizations of the condensed matrix: the trait [`Solver`] for the caller's own, and Cholesky, `L D L^T` and LU of faer.
//!
//! The factorizations of faer run on one thread, so that results do not depend on the number of threads.

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::cholesky::ldlt::factor::LdltRegularization;
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LdltRef, LltRef, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::linalg::lu::{LuRef, LuSymbolicParams, NumericLu, SymbolicLu, factorize_symbolic_lu};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side, Spec};
use qless::elimination::Storage;

/// A square matrix in compressed columns, with indices from 0 and ascending rows.
#[derive(Clone, Copy, Debug)]
pub struct SolverMatrix<'a> {
    /// Where each column starts in `rows`; length n + 1.
    pub starts: &'a [u32],
    /// Row of each entry.
    pub rows: &'a [u32],
    /// Value of each entry.
    pub values: &'a [f64],
    /// Whether all entries or one half are stored.
    pub storage: Storage,
}

/// Solves the condensed equations.
///
/// ```
/// use qless_solve::enforce::{SolverMatrix, Llt, Solver};
/// let a = SolverMatrix { starts: &[0, 2, 4], rows: &[0, 1, 0, 1], values: &[2.0, 1.0, 1.0, 2.0], storage: Default::default() };
/// let mut solver = Llt::default();
/// solver.factor(a)?;
/// let mut x = [3.0, 3.0];
/// solver.solve(&mut x)?;
/// assert!((x[0] - 1.0).abs() < 1e-15 && (x[1] - 1.0).abs() < 1e-15);
/// # Ok::<(), qless_solve::enforce::SolverError>(())
/// ```
pub trait Solver {
    /// Factors a matrix. All calls have the same pattern, so that the symbolic analysis can be kept.
    ///
    /// # Errors
    /// [`SolverError`] if the factorization fails.
    fn factor(&mut self, matrix: SolverMatrix) -> Result<(), SolverError>;

    /// `b <- A^-1 b` for the matrix of the last factorization.
    ///
    /// # Errors
    /// [`SolverError`].
    fn solve(&mut self, b: &mut [f64]) -> Result<(), SolverError>;
}

/// Why a solver failed, in its own words.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("the solver: {0}")]
pub struct SolverError(pub String);

impl SolverError {
    pub(super) fn from_debug(error: impl std::fmt::Debug) -> Self {
        Self(format!("{error:?}"))
    }

    fn not_factored() -> Self {
        Self("solve was called before factor".into())
    }
}

impl<'a> SolverMatrix<'a> {
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

/// faer's `L L^T`, for symmetric positive definite matrices.
pub type Llt = Cholesky<false>;

/// faer's `L D L^T` without pivoting, for symmetric matrices.
///
/// An indefinite matrix may have no such factors, or factors with large entries: [`super::Steps`] measures the error, and refines or
/// refuses the solution. For a saddle matrix use [`Lu`].
pub type Ldlt = Cholesky<true>;

/// Factors of a symmetric matrix, [`Llt`] or [`Ldlt`]: the symbolic factorization of the first call, and the values of the last successful
/// one.
#[derive(Debug, Default)]
pub struct Cholesky<const DIAGONAL: bool> {
    symbolic: Option<SymbolicCholesky<u32>>,
    values: Option<Vec<f64>>,
}

impl<const DIAGONAL: bool> Solver for Cholesky<DIAGONAL> {
    fn factor(&mut self, matrix: SolverMatrix) -> Result<(), SolverError> {
        let (a, side, par) = (matrix.matrix(), matrix.side(), Par::Seq);
        let (order, params) = (SymmetricOrdering::Amd, CholeskySymbolicParams::default());
        let new = || factorize_symbolic_cholesky(matrix.pattern(), side, order, params);
        let symbolic = self.symbolic.take().map_or_else(new, Ok).map_err(SolverError::from_debug)?;
        let symbolic = &*self.symbolic.insert(symbolic);
        let mut values = self.values.take().unwrap_or_default();
        values.resize(symbolic.len_val(), 0.0);
        let done = if DIAGONAL {
            let mut room = room(symbolic.factorize_numeric_ldlt_scratch::<f64>(par, Spec::default()))?;
            let (stack, none) = (MemStack::new(&mut room), LdltRegularization::default());
            let done = symbolic.factorize_numeric_ldlt(&mut values, a, side, none, par, stack, Spec::default());
            done.map(drop).map_err(SolverError::from_debug)
        } else {
            let mut room = room(symbolic.factorize_numeric_llt_scratch::<f64>(par, Spec::default()))?;
            let (stack, none) = (MemStack::new(&mut room), LltRegularization::default());
            let done = symbolic.factorize_numeric_llt(&mut values, a, side, none, par, stack, Spec::default());
            done.map(drop).map_err(SolverError::from_debug)
        };
        self.values = done.is_ok().then_some(values);
        done
    }

    fn solve(&mut self, b: &mut [f64]) -> Result<(), SolverError> {
        let (Some(symbolic), Some(values)) = (&self.symbolic, &self.values) else {
            return Err(SolverError::not_factored());
        };
        let mut room = room(symbolic.solve_in_place_scratch::<f64>(1, Par::Seq))?;
        let (rows, stack) = (b.len(), MemStack::new(&mut room));
        let b = MatMut::from_column_major_slice_mut(b, rows, 1);
        if DIAGONAL {
            LdltRef::new(symbolic, values).solve_in_place_with_conj(Conj::No, b, Par::Seq, stack);
        } else {
            LltRef::new(symbolic, values).solve_in_place_with_conj(Conj::No, b, Par::Seq, stack);
        }
        Ok(())
    }
}

/// Allocates the working memory for one call of faer.
fn room(request: StackReq) -> Result<MemBuffer, SolverError> {
    MemBuffer::try_new(request).map_err(SolverError::from_debug)
}

/// faer's LU with partial pivoting, for any nonsingular matrix; all entries must be stored.
#[derive(Debug, Default)]
pub struct Lu {
    symbolic: Option<SymbolicLu<u32>>,
    factors: Option<NumericLu<u32, f64>>,
}

impl Solver for Lu {
    fn factor(&mut self, matrix: SolverMatrix) -> Result<(), SolverError> {
        if matrix.storage != Storage::Full {
            return Err(SolverError("LU needs all entries of the matrix, not one half".into()));
        }
        let new = || factorize_symbolic_lu(matrix.pattern(), LuSymbolicParams::default());
        let symbolic = self.symbolic.take().map_or_else(new, Ok).map_err(SolverError::from_debug)?;
        let symbolic = &*self.symbolic.insert(symbolic);
        let mut room = room(symbolic.factorize_numeric_lu_scratch::<f64>(Par::Seq, Spec::default()))?;
        let mut factors = self.factors.take().unwrap_or_default();
        let stack = MemStack::new(&mut room);
        let done = symbolic.factorize_numeric_lu(&mut factors, matrix.matrix(), Par::Seq, stack, Spec::default());
        done.map(drop).map_err(SolverError::from_debug)?;
        self.factors = Some(factors);
        Ok(())
    }

    fn solve(&mut self, b: &mut [f64]) -> Result<(), SolverError> {
        let (Some(symbolic), Some(factors)) = (&self.symbolic, &self.factors) else {
            return Err(SolverError::not_factored());
        };
        let mut room = room(symbolic.solve_in_place_scratch::<f64>(1, Par::Seq))?;
        let (rows, stack) = (b.len(), MemStack::new(&mut room));
        let b = MatMut::from_column_major_slice_mut(b, rows, 1);
        LuRef::new_unchecked(symbolic, factors).solve_in_place_with_conj(Conj::No, b, Par::Seq, stack);
        Ok(())
    }
}
