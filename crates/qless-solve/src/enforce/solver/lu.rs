//! `P A Q = L U` with partial pivoting.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::linalg::lu::{LuRef, LuSymbolicParams, NumericLu, SymbolicLu, factorize_symbolic_lu};
use faer::{Conj, MatMut, Par, Spec};
use qless::elimination::Storage;

use super::{Columns, Solver, SolverError};

/// faer's LU with partial pivoting, for whatever is not singular; all entries must be stored.
#[derive(Debug, Default)]
pub struct Lu {
    symbolic: Option<SymbolicLu<u32>>,
    factors: Option<NumericLu<u32, f64>>,
}

impl Solver for Lu {
    fn factor(&mut self, matrix: Columns) -> Result<(), SolverError> {
        if matrix.storage != Storage::Full {
            return Err(SolverError("LU needs all entries of the matrix, not one half".into()));
        }
        let symbolic = match self.symbolic.take() {
            Some(symbolic) => symbolic,
            None => factorize_symbolic_lu(matrix.pattern(), LuSymbolicParams::default()).map_err(SolverError::of)?,
        };
        let symbolic = &*self.symbolic.insert(symbolic);
        let room = symbolic.factorize_numeric_lu_scratch::<f64>(Par::Seq, Spec::default());
        let mut room = MemBuffer::try_new(room).map_err(SolverError::of)?;
        let mut factors = self.factors.take().unwrap_or_default();
        let stack = MemStack::new(&mut room);
        let done = symbolic.factorize_numeric_lu(&mut factors, matrix.matrix(), Par::Seq, stack, Spec::default());
        done.map(drop).map_err(SolverError::of)?;
        self.factors = Some(factors);
        Ok(())
    }

    fn solve(&mut self, b: &mut [f64]) -> Result<(), SolverError> {
        let (Some(symbolic), Some(factors)) = (&self.symbolic, &self.factors) else {
            return Err(SolverError::not_factored());
        };
        let room = symbolic.solve_in_place_scratch::<f64>(1, Par::Seq);
        let mut room = MemBuffer::try_new(room).map_err(SolverError::of)?;
        let rows = b.len();
        let b = MatMut::from_column_major_slice_mut(b, rows, 1);
        let stack = MemStack::new(&mut room);
        LuRef::new_unchecked(symbolic, factors).solve_in_place_with_conj(Conj::No, b, Par::Seq, stack);
        Ok(())
    }
}
