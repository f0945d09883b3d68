//! `A = L L^T` and `A = L D L^T` of symmetric matrices, of which one half is read.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::ldlt::factor::LdltRegularization;
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LdltRef, LltRef, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::{Conj, MatMut, Par, Spec};

use super::{Columns, Solver, SolverError};

/// faer's `L L^T`, for symmetric positive definite matrices.
#[derive(Debug, Default)]
pub struct Llt(Cholesky);

/// faer's `L D L^T` without pivoting, for symmetric matrices that have it.
///
/// Indefinite matrices may have it or not, and nothing bounds its entries then: [`super::super::Steps`] finds what that costs,
/// refines it or refuses it. For a saddle matrix take [`super::Lu`].
#[derive(Debug, Default)]
pub struct Ldlt(Cholesky);

/// The pattern of the factors, made at the first call, and their values; none where there are no factors.
#[derive(Debug, Default)]
struct Cholesky {
    symbolic: Option<SymbolicCholesky<u32>>,
    values: Option<Vec<f64>>,
}

impl Cholesky {
    fn factor(&mut self, matrix: Columns, diagonal: bool) -> Result<(), SolverError> {
        let symbolic = if let Some(symbolic) = self.symbolic.take() {
            symbolic
        } else {
            let (order, params) = (SymmetricOrdering::Amd, CholeskySymbolicParams::default());
            factorize_symbolic_cholesky(matrix.pattern(), matrix.side(), order, params).map_err(SolverError::of)?
        };
        let symbolic = &*self.symbolic.insert(symbolic);
        let mut values = self.values.take().unwrap_or_default();
        values.resize(symbolic.len_val(), 0.0);
        let (a, side, par) = (matrix.matrix(), matrix.side(), Par::Seq);
        if diagonal {
            let room = symbolic.factorize_numeric_ldlt_scratch::<f64>(par, Spec::default());
            let (mut room, none) = (MemBuffer::try_new(room).map_err(SolverError::of)?, LdltRegularization::default());
            let stack = MemStack::new(&mut room);
            let done = symbolic.factorize_numeric_ldlt(&mut values, a, side, none, par, stack, Spec::default());
            done.map(drop).map_err(SolverError::of)?;
        } else {
            let room = symbolic.factorize_numeric_llt_scratch::<f64>(par, Spec::default());
            let (mut room, none) = (MemBuffer::try_new(room).map_err(SolverError::of)?, LltRegularization::default());
            let stack = MemStack::new(&mut room);
            let done = symbolic.factorize_numeric_llt(&mut values, a, side, none, par, stack, Spec::default());
            done.map(drop).map_err(SolverError::of)?;
        }
        self.values = Some(values);
        Ok(())
    }

    fn solve(&self, b: &mut [f64], diagonal: bool) -> Result<(), SolverError> {
        let (Some(symbolic), Some(values)) = (&self.symbolic, &self.values) else {
            return Err(SolverError::not_factored());
        };
        let room = symbolic.solve_in_place_scratch::<f64>(1, Par::Seq);
        let mut room = MemBuffer::try_new(room).map_err(SolverError::of)?;
        let (rows, stack) = (b.len(), MemStack::new(&mut room));
        let b = MatMut::from_column_major_slice_mut(b, rows, 1);
        if diagonal {
            LdltRef::new(symbolic, values).solve_in_place_with_conj(Conj::No, b, Par::Seq, stack);
        } else {
            LltRef::new(symbolic, values).solve_in_place_with_conj(Conj::No, b, Par::Seq, stack);
        }
        Ok(())
    }
}

impl Solver for Llt {
    fn factor(&mut self, matrix: Columns) -> Result<(), SolverError> {
        self.0.factor(matrix, false)
    }

    fn solve(&mut self, b: &mut [f64]) -> Result<(), SolverError> {
        self.0.solve(b, false)
    }
}

impl Solver for Ldlt {
    fn factor(&mut self, matrix: Columns) -> Result<(), SolverError> {
        self.0.factor(matrix, true)
    }

    fn solve(&mut self, b: &mut [f64]) -> Result<(), SolverError> {
        self.0.solve(b, true)
    }
}
