//! Sparse matrices by columns: their entries, bordered matrices, and factors of scaled matrices.
//!
//! `A x = b` is solved by `S A S = L L^T` if A is definite, and by LU with partial pivoting otherwise. S removes the units
//! ([`super::scale`]); without it, the units would choose the pivots of a saddle matrix. `L D L^T` is not used: faer's has no pivoting
//! outside of the diagonal, and a saddle matrix has zeros on its diagonal.

use faer::sparse::Triplet;
use qless::elimination::Storage;

use super::EnforceError;
use super::scale::times_power;
use super::solver::{Llt, Lu, Solver, SolverError, SolverMatrix};
use crate::common::SparseMatrix;

/// The matrix with the entries `(row, column, value)`, all in range; repeated entries are summed.
pub fn from_triplets(
    rows: usize,
    cols: usize,
    entries: impl IntoIterator<Item = (usize, usize, f64)>,
) -> Result<SparseMatrix, EnforceError> {
    let entries: Vec<_> = entries.into_iter().map(|(i, j, v)| Triplet::new(i, j, v)).collect();
    // All indices are in range, so that only a lack of memory can make this fail.
    SparseMatrix::try_new_from_triplets(rows, cols, &entries).map_err(|_| EnforceError::TooLarge { rows, cols })
}

/// All entries `(row, column, value)`, column by column.
pub fn entries(a: &SparseMatrix) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
    (0..a.ncols()).flat_map(|j| {
        let rows = a.symbolic().row_idx_of_col(j);
        rows.zip(a.val_of_col(j)).map(move |(i, &v)| (i, j, v))
    })
}

/// The saddle matrix `[K C^T; C -Z]` with a diagonal Z; C has `z.len()` rows.
pub fn bordered(
    k: &SparseMatrix,
    c: impl Iterator<Item = (usize, usize, f64)>,
    z: &[f64],
) -> Result<SparseMatrix, EnforceError> {
    let (n, size) = (k.nrows(), k.nrows() + z.len());
    let border = c.flat_map(|(i, j, v)| [(n + i, j, v), (j, n + i, v)]);
    let corner = z.iter().enumerate().filter(|(_, z)| **z != 0.0).map(|(i, z)| (n + i, n + i, -z));
    from_triplets(size, size, entries(k).chain(border).chain(corner))
}

/// Reusable factors of a scaled matrix.
pub struct ScaledFactor {
    scale: Vec<i32>,
    solver: Option<Box<dyn Solver>>,
}

impl ScaledFactor {
    /// Factors A, whose unknowns have scales with the given exponents; `definite` asks for Cholesky first.
    pub fn new(a: &SparseMatrix, scale: Vec<i32>, definite: bool) -> Result<Self, EnforceError> {
        if a.nrows() == 0 {
            return Ok(Self { scale, solver: None });
        }
        let narrow = |index: &[usize]| index.iter().map(|&i| u32::try_from(i)).collect::<Result<Vec<_>, _>>();
        let too_large = |_| EnforceError::TooLarge { rows: a.nrows(), cols: a.ncols() };
        let starts = narrow(a.symbolic().col_ptr()).map_err(too_large)?;
        let rows = narrow(a.symbolic().row_idx()).map_err(too_large)?;
        let values: Vec<f64> = entries(a).map(|(i, j, v)| times_power(v, scale[i] + scale[j])).collect();
        let scaled = SolverMatrix { starts: &starts, rows: &rows, values: &values, storage: Storage::Full };
        let mut solver: Box<dyn Solver> = Box::new(Llt::default());
        if !definite || solver.factor(scaled).is_err() {
            solver = Box::new(Lu::default());
            solver.factor(scaled)?;
        }
        Ok(Self { scale, solver: Some(solver) })
    }

    /// `A^-1 b`; an error if a pivot was zero.
    pub fn solve(&mut self, b: &[f64]) -> Result<Vec<f64>, EnforceError> {
        match &mut self.solver {
            Some(solver) => backsolve(&mut **solver, &self.scale, b),
            None => Ok(Vec::new()),
        }
    }
}

/// `S M^-1 S b`, where S holds the scales with the given exponents, and M is the matrix that the solver factored; an error if a number is
/// not finite.
pub fn backsolve(solver: &mut dyn Solver, scale: &[i32], b: &[f64]) -> Result<Vec<f64>, EnforceError> {
    let mut x: Vec<f64> = b.iter().zip(scale).map(|(b, &s)| times_power(*b, s)).collect();
    if !x.is_empty() {
        solver.solve(&mut x)?;
    }
    x.iter_mut().zip(scale).for_each(|(x, &s)| *x = times_power(*x, s));
    if x.iter().all(|x| x.is_finite()) { Ok(x) } else { Err(SolverError("a pivot is zero".into()).into()) }
}
