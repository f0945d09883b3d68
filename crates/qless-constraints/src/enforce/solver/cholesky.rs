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
pub struct Llt {
    symbolic: Option<SymbolicCholesky<u32>>,
    factors: Vec<f64>,
}

/// faer's `L D L^T` without pivoting, for symmetric matrices that have it.
///
/// Indefinite matrices may have it or not, and nothing bounds its entries then: [`super::super::Steps`] finds what that costs and
/// refuses it. For a saddle matrix take [`super::Lu`].
#[derive(Debug, Default)]
pub struct Ldlt {
    symbolic: Option<SymbolicCholesky<u32>>,
    factors: Vec<f64>,
}

/// The pattern of the factors, made at the first call.
fn analysed<'a>(
    kept: &'a mut Option<SymbolicCholesky<u32>>,
    matrix: Columns,
) -> Result<&'a SymbolicCholesky<u32>, SolverError> {
    let made = match kept.take() {
        Some(made) => made,
        None => {
            let (order, params) = (SymmetricOrdering::Amd, CholeskySymbolicParams::default());
            factorize_symbolic_cholesky(matrix.pattern(), matrix.side(), order, params).map_err(SolverError::of)?
        }
    };
    Ok(kept.insert(made))
}

impl Solver for Llt {
    fn factor(&mut self, matrix: Columns) -> Result<(), SolverError> {
        let symbolic = analysed(&mut self.symbolic, matrix)?;
        self.factors.resize(symbolic.len_val(), 0.0);
        let room = symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Spec::default());
        let mut room = MemBuffer::try_new(room).map_err(SolverError::of)?;
        let (a, side, regular) = (matrix.matrix(), matrix.side(), LltRegularization::default());
        let (values, stack) = (&mut self.factors, MemStack::new(&mut room));
        let done = symbolic.factorize_numeric_llt(values, a, side, regular, Par::Seq, stack, Spec::default());
        let done = done.map(drop).map_err(SolverError::of);
        if done.is_err() {
            self.factors.clear();
        }
        done
    }

    fn solve(&mut self, b: &mut [f64]) -> Result<(), SolverError> {
        let symbolic = self.symbolic.as_ref().filter(|symbolic| symbolic.len_val() == self.factors.len());
        let symbolic = symbolic.ok_or_else(SolverError::not_factored)?;
        let room = symbolic.solve_in_place_scratch::<f64>(1, Par::Seq);
        let mut room = MemBuffer::try_new(room).map_err(SolverError::of)?;
        let rows = b.len();
        let b = MatMut::from_column_major_slice_mut(b, rows, 1);
        LltRef::new(symbolic, &self.factors).solve_in_place_with_conj(Conj::No, b, Par::Seq, MemStack::new(&mut room));
        Ok(())
    }
}

impl Solver for Ldlt {
    fn factor(&mut self, matrix: Columns) -> Result<(), SolverError> {
        let symbolic = analysed(&mut self.symbolic, matrix)?;
        self.factors.resize(symbolic.len_val(), 0.0);
        let room = symbolic.factorize_numeric_ldlt_scratch::<f64>(Par::Seq, Spec::default());
        let mut room = MemBuffer::try_new(room).map_err(SolverError::of)?;
        let (a, side, regular) = (matrix.matrix(), matrix.side(), LdltRegularization::default());
        let (values, stack) = (&mut self.factors, MemStack::new(&mut room));
        let done = symbolic.factorize_numeric_ldlt(values, a, side, regular, Par::Seq, stack, Spec::default());
        let done = done.map(drop).map_err(SolverError::of);
        if done.is_err() {
            self.factors.clear();
        }
        done
    }

    fn solve(&mut self, b: &mut [f64]) -> Result<(), SolverError> {
        let symbolic = self.symbolic.as_ref().filter(|symbolic| symbolic.len_val() == self.factors.len());
        let symbolic = symbolic.ok_or_else(SolverError::not_factored)?;
        let room = symbolic.solve_in_place_scratch::<f64>(1, Par::Seq);
        let mut room = MemBuffer::try_new(room).map_err(SolverError::of)?;
        let rows = b.len();
        let b = MatMut::from_column_major_slice_mut(b, rows, 1);
        LdltRef::new(symbolic, &self.factors).solve_in_place_with_conj(Conj::No, b, Par::Seq, MemStack::new(&mut room));
        Ok(())
    }
}
