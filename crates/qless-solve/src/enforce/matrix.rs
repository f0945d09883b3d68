//! Sparse matrices by columns: products with matrices, vectors and absolute values, and factors of scaled matrices.
//!
//! `A x = b` is solved by `S A S = L L^T` if A may be definite, and by LU with partial pivoting otherwise. S removes the units
//! ([`super::units`]); without it, the units would choose the pivots of a saddle matrix. `L D L^T` is not used: faer's has no pivoting
//! outside of the diagonal, and a saddle matrix has zeros on its diagonal.

use std::borrow::Cow;

use faer::sparse::Triplet;
use faer::sparse::linalg::matmul::sparse_sparse_matmul;
use qless::elimination::Storage;

use super::EnforceError;
use super::solver::{Llt, Lu, Solver, SolverError, SolverMatrix};
use crate::common::SparseMatrix;

/// The matrix of `(row, column, value)`, all in range; repeated entries are summed.
pub fn from_triplets(
    rows: usize,
    cols: usize,
    entries: impl IntoIterator<Item = (usize, usize, f64)>,
) -> Result<SparseMatrix, EnforceError> {
    let entries: Vec<_> = entries.into_iter().map(|(i, j, v)| Triplet::new(i, j, v)).collect();
    // Only memory can fail here.
    SparseMatrix::try_new_from_triplets(rows, cols, &entries).map_err(|_| EnforceError::TooLarge { rows, cols })
}

/// The matrix without gaps between its columns, as [`qless::elimination::View`] needs it.
pub fn compressed(a: &SparseMatrix) -> Result<Cow<'_, SparseMatrix>, EnforceError> {
    if a.symbolic().col_nnz().is_none() && a.val().len() == a.symbolic().row_idx().len() {
        return Ok(Cow::Borrowed(a));
    }
    from_triplets(a.nrows(), a.ncols(), entries(a)).map(Cow::Owned)
}

/// All entries `(row, column, value)`, column by column.
pub fn entries(a: &SparseMatrix) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
    (0..a.ncols()).flat_map(|j| {
        let rows = a.symbolic().row_idx_of_col(j);
        rows.zip(a.val_of_col(j)).map(move |(i, &v)| (i, j, v))
    })
}

/// `A B`.
pub fn product(a: &SparseMatrix, b: &SparseMatrix) -> Result<SparseMatrix, EnforceError> {
    sparse_sparse_matmul(a.as_ref(), b.as_ref(), 1.0, faer::Par::Seq)
        .map_err(|_| EnforceError::TooLarge { rows: a.nrows(), cols: b.ncols() })
}

/// `A^T`.
pub fn transposed(a: &SparseMatrix) -> Result<SparseMatrix, EnforceError> {
    from_triplets(a.ncols(), a.nrows(), entries(a).map(|(i, j, v)| (j, i, v)))
}

/// `y += A^T x`.
pub fn add_transposed(a: &SparseMatrix, x: &[f64], y: &mut [f64]) {
    entries(a).for_each(|(i, j, v)| y[j] += v * x[i]);
}

/// `y += |A| |x|`: the sizes of the terms of A x.
pub fn add_sizes(a: &SparseMatrix, x: &[f64], y: &mut [f64]) {
    entries(a).for_each(|(i, j, v)| y[i] += (v * x[j]).abs());
}

/// `y += |A|^T |x|`.
pub fn add_sizes_transposed(a: &SparseMatrix, x: &[f64], y: &mut [f64]) {
    entries(a).for_each(|(i, j, v)| y[j] += (v * x[i]).abs());
}

/// `[A B^T; B 0]`.
pub fn bordered(a: &SparseMatrix, b: &SparseMatrix) -> Result<SparseMatrix, EnforceError> {
    let (n, size) = (a.nrows(), a.nrows() + b.nrows());
    let border = entries(b).flat_map(|(i, j, v)| [(n + i, j, v), (j, n + i, v)]);
    from_triplets(size, size, entries(a).chain(border))
}

/// Reusable factors of a scaled matrix.
pub struct ScaledFactor {
    units: Vec<f64>,
    solver: Option<Box<dyn Solver>>,
}

/// A scaled matrix with 32-bit indices, as the solvers take it.
struct ScaledColumns {
    starts: Vec<u32>,
    rows: Vec<u32>,
    values: Vec<f64>,
}

impl ScaledFactor {
    /// Factors A, whose unknowns have the given units; `definite` asks for Cholesky first.
    pub fn new(a: &SparseMatrix, units: Vec<f64>, definite: bool) -> Result<Self, EnforceError> {
        if a.nrows() == 0 {
            return Ok(Self { units, solver: None });
        }
        let scaled = ScaledColumns::new(a, &units)?;
        let mut solver: Box<dyn Solver> = Box::new(Llt::default());
        if !definite || solver.factor(scaled.columns()).is_err() {
            solver = Box::new(Lu::default());
            solver.factor(scaled.columns())?;
        }
        Ok(Self { units, solver: Some(solver) })
    }

    /// `A^-1 b`; an error if a pivot was zero.
    pub fn solve(&mut self, b: &[f64]) -> Result<Vec<f64>, EnforceError> {
        let mut x: Vec<f64> = b.iter().zip(&self.units).map(|(b, s)| b * s).collect();
        let Some(solver) = &mut self.solver else { return Ok(x) };
        solver.solve(&mut x)?;
        x.iter_mut().zip(&self.units).for_each(|(x, s)| *x *= s);
        if x.iter().all(|x| x.is_finite()) { Ok(x) } else { Err(SolverError("a pivot is zero".into()).into()) }
    }
}

/// Shift on the diagonal of unknown j, in its unit, that makes a singular matrix regular. All shifts differ: if the null spaces of A and
/// A^T are orthogonal, `A + s I` with the same s for all stays almost singular.
pub fn uneven(shift: f64, j: usize, unit: f64) -> f64 {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    shift * (1.0 + (j as f64 * GOLDEN).fract()) / (unit * unit)
}

/// A with shifts on its first `count` diagonal entries.
pub fn shifted(a: &SparseMatrix, units: &[f64], count: usize, shift: f64) -> Result<SparseMatrix, EnforceError> {
    let diagonal = (0..count).map(|j| (j, j, uneven(shift, j, units[j])));
    from_triplets(a.nrows(), a.ncols(), entries(a).chain(diagonal))
}

impl ScaledColumns {
    fn new(a: &SparseMatrix, units: &[f64]) -> Result<Self, EnforceError> {
        let too_large = |_| EnforceError::TooLarge { rows: a.nrows(), cols: a.ncols() };
        let (mut starts, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
        for j in 0..a.ncols() {
            for (i, v) in a.symbolic().row_idx_of_col(j).zip(a.val_of_col(j)) {
                rows.push(u32::try_from(i).map_err(too_large)?);
                values.push(units[i] * v * units[j]);
            }
            starts.push(u32::try_from(rows.len()).map_err(too_large)?);
        }
        Ok(Self { starts, rows, values })
    }

    fn columns(&self) -> SolverMatrix<'_> {
        SolverMatrix { starts: &self.starts, rows: &self.rows, values: &self.values, storage: Storage::Full }
    }
}
