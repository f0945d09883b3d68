//! Sparse matrices by columns: `A B`, `A x`, `A^T x`, and the same of sizes, `|A| |x|`.

use std::borrow::Cow;

use faer::sparse::linalg::matmul::sparse_sparse_matmul;
use faer::sparse::{SparseColMat, Triplet};

use super::EnforceError;

pub type Matrix = SparseColMat<usize, f64>;

/// From `(row, column, value)`, summed where they repeat; all indices are in range.
pub fn from_triplets(
    rows: usize,
    cols: usize,
    entries: impl IntoIterator<Item = (usize, usize, f64)>,
) -> Result<Matrix, EnforceError> {
    let entries: Vec<_> = entries.into_iter().map(|(i, j, v)| Triplet::new(i, j, v)).collect();
    // What can go wrong here is memory.
    Matrix::try_new_from_triplets(rows, cols, &entries).map_err(|_| EnforceError::TooLarge { rows, cols })
}

/// The same matrix with its columns one after the other, as [`qless::elimination::View`] takes it.
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
        .map_err(|_| EnforceError::TooLarge { rows: a.nrows(), cols: b.ncols() })
}

/// `A^T`.
pub fn transposed(a: &Matrix) -> Result<Matrix, EnforceError> {
    from_triplets(a.ncols(), a.nrows(), entries(a).map(|(i, j, v)| (j, i, v)))
}

/// `y += A x`.
pub fn add(a: &Matrix, x: &[f64], y: &mut [f64]) {
    entries(a).for_each(|(i, j, v)| y[i] += v * x[j]);
}

/// `y += A^T x`.
pub fn add_transposed(a: &Matrix, x: &[f64], y: &mut [f64]) {
    entries(a).for_each(|(i, j, v)| y[j] += v * x[i]);
}

/// `y += |A| |x|`: the sizes of the terms of A x.
pub fn add_sizes(a: &Matrix, x: &[f64], y: &mut [f64]) {
    entries(a).for_each(|(i, j, v)| y[i] += (v * x[j]).abs());
}

/// `y += |A|^T |x|`.
pub fn add_sizes_transposed(a: &Matrix, x: &[f64], y: &mut [f64]) {
    entries(a).for_each(|(i, j, v)| y[j] += (v * x[i]).abs());
}

/// `A x`.
pub fn times(a: &Matrix, x: &[f64]) -> Vec<f64> {
    let mut y = vec![0.0; a.nrows()];
    add(a, x, &mut y);
    y
}

/// `[A B^T; B 0]`.
pub fn bordered(a: &Matrix, b: &Matrix) -> Result<Matrix, EnforceError> {
    let (n, size) = (a.nrows(), a.nrows() + b.nrows());
    let border = entries(b).flat_map(|(i, j, v)| [(n + i, j, v), (j, n + i, v)]);
    from_triplets(size, size, entries(a).chain(border))
}
