//! Sparse matrices by columns: `A B`, `A x`, `A^T x`, and `A x = b` by LU.

use std::borrow::Cow;

use faer::Mat;
use faer::prelude::Solve;
use faer::sparse::linalg::matmul::sparse_sparse_matmul;
use faer::sparse::linalg::solvers::Lu;
use faer::sparse::{SparseColMat, Triplet};
use qless::Csr;

use super::EnforceError;

pub type Matrix = SparseColMat<usize, f64>;

/// From `(row, column, value)`, summed where they repeat; all indices are in range.
pub fn from_triplets(
    rows: usize,
    cols: usize,
    entries: impl IntoIterator<Item = (usize, usize, f64)>,
) -> Result<Matrix, EnforceError> {
    let entries: Vec<_> = entries.into_iter().map(|(i, j, v)| Triplet::new(i, j, v)).collect();
    // What can go wrong here is memory: then the matrix is of no use.
    Matrix::try_new_from_triplets(rows, cols, &entries)
        .map_err(|_| EnforceError::Singular { what: "a matrix too large" })
}

/// The same matrix with its columns one after the other, as [`qless::View`] takes it.
pub fn compressed(a: &Matrix) -> Result<Cow<'_, Matrix>, EnforceError> {
    if a.symbolic().col_nnz().is_none() && a.val().len() == a.symbolic().row_idx().len() {
        return Ok(Cow::Borrowed(a));
    }
    from_triplets(a.nrows(), a.ncols(), entries(a)).map(Cow::Owned)
}

/// All entries `(row, column, value)`, column by column.
pub fn entries(a: &Matrix) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
    (0..a.ncols()).flat_map(|j| {
        let rows = a.symbolic().row_idx_of_col(j);
        rows.zip(a.val_of_col(j)).map(move |(i, &v)| (i, j, v))
    })
}

/// `A B`.
pub fn product(a: &Matrix, b: &Matrix) -> Result<Matrix, EnforceError> {
    sparse_sparse_matmul(a.as_ref(), b.as_ref(), 1.0, faer::Par::Seq)
        .map_err(|_| EnforceError::Singular { what: "a matrix too large" })
}

/// `A^T`.
pub fn transposed(a: &Matrix) -> Result<Matrix, EnforceError> {
    from_triplets(a.ncols(), a.nrows(), entries(a).map(|(i, j, v)| (j, i, v)))
}

/// `A x`.
pub fn times(a: &Matrix, x: &[f64]) -> Vec<f64> {
    let mut y = vec![0.0; a.nrows()];
    entries(a).for_each(|(i, j, v)| y[i] += v * x[j]);
    y
}

/// `A^T x` of compressed rows.
pub fn times_transposed(a: &Csr, x: &[f64]) -> Vec<f64> {
    let mut y = vec![0.0; a.cols()];
    (0..a.rows()).for_each(|i| a.row(i).for_each(|(j, v)| y[j] += v * x[i]));
    y
}

/// An LU factorization that can be used again.
pub struct Factor {
    lu: Option<Lu<usize, f64>>,
    what: &'static str,
}

impl Factor {
    pub fn new(a: &Matrix, what: &'static str) -> Result<Self, EnforceError> {
        let singular = |_| EnforceError::Singular { what };
        let lu = if a.nrows() == 0 { None } else { Some(a.sp_lu().map_err(singular)?) };
        Ok(Self { lu, what })
    }

    /// `A^-1 b`; a pivot that is zero shows in the result.
    pub fn solve(&self, b: &[f64]) -> Result<Vec<f64>, EnforceError> {
        let Some(lu) = &self.lu else { return Ok(Vec::new()) };
        let x = lu.solve(Mat::from_fn(b.len(), 1, |i, _| b[i]));
        let x: Vec<f64> = (0..b.len()).map(|i| x[(i, 0)]).collect();
        if x.iter().all(|x| x.is_finite()) { Ok(x) } else { Err(EnforceError::Singular { what: self.what }) }
    }
}
