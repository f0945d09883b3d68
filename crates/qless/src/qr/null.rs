//! Right singular vectors of R1 that belong to its smallest values: what a QR without pivoting kept and should not have.
//!
//! Block inverse iteration `X <- orth(R1^-1 R1^-T X)` with a Ritz step (Foster and Davis 2013, Algorithm 933), the block
//! doubled until it holds a value above the limit. O(nnz(R1) k) for k values, all columns of X in parallel.

use faer::Mat;
use rayon::prelude::*;

use super::faer::Faer;
use super::{Backend, BackendError, Factor};
use crate::Csr;
use crate::random::randoms;

/// Steps of inverse iteration: values well below the limit stand out after the first.
const STEPS: usize = 3;
/// Vectors at first.
const BLOCK: usize = 16;
/// Most of them: a matrix that has more such values is no near miss.
const MOST: usize = 512;

impl Factor {
    /// Columns (by position) without which the singular values of R1 at most `limit` are gone; as many as there are such values,
    /// those by which the singular vectors differ most. None if there are too many to count.
    pub(crate) fn weak_columns(&self, limit: f64) -> Result<Option<Vec<usize>>, BackendError> {
        let Some(null) = self.near_null(limit) else { return Ok(None) };
        if null.ncols() == 0 {
            return Ok(Some(Vec::new()));
        }
        // N^T, k x r, by its columns: QR with pivoting takes the k that are most independent.
        let mut rows = Csr::empty(null.ncols());
        (0..null.nrows()).for_each(|i| rows.push_row((0..null.ncols()).map(|k| (k, null[(i, k)]))));
        let factor = Faer.factor(&rows, &[], 0.0)?;
        Ok(Some(factor.order[..factor.rank].to_vec()))
    }

    /// An orthonormal basis, r x k.
    fn near_null(&self, limit: f64) -> Option<Mat<f64>> {
        let mut width = BLOCK.min(self.rank);
        while width > 0 {
            let (basis, values) = self.ritz(width)?;
            let small = values.iter().filter(|&&value| value <= limit).count();
            if small < width || width == self.rank {
                return Some(basis.get(.., width - small..).to_owned());
            }
            if width == MOST {
                return None;
            }
            width = (2 * width).min(MOST).min(self.rank);
        }
        Some(Mat::new())
    }

    /// Ritz vectors and values of R1, the values descending.
    fn ritz(&self, width: usize) -> Option<(Mat<f64>, Vec<f64>)> {
        let mut random = randoms(7);
        let mut x = Mat::from_fn(self.rank, width, |_, _| random.next().unwrap_or(1.0) - 1.0);
        for _ in 0..STEPS {
            let columns: Vec<_> = (0..width).into_par_iter().map(|c| self.inverse_step(&x, c)).collect();
            if columns.iter().flatten().any(|v| !v.is_finite()) {
                return None;
            }
            x = Mat::from_fn(self.rank, width, |i, c| columns[c][i]).qr().compute_thin_Q();
        }
        let columns: Vec<_> = (0..width).into_par_iter().map(|c| self.times(&x, c)).collect();
        let product = Mat::from_fn(self.rank, width, |i, c| columns[c][i]);
        let svd = product.thin_svd().ok()?;
        Some((&x * svd.V(), svd.S().column_vector().iter().copied().collect()))
    }

    /// `R1^-1 R1^-T x_c`, of size 1.
    fn inverse_step(&self, x: &Mat<f64>, c: usize) -> Vec<f64> {
        let mut y = self.solve(&self.solve_transposed(&column(x, c)));
        let largest = y.iter().fold(0.0, |a: f64, v| a.max(v.abs()));
        y.iter_mut().for_each(|v| *v /= largest);
        y
    }

    /// `R1 x_c`.
    fn times(&self, x: &Mat<f64>, c: usize) -> Vec<f64> {
        let x = column(x, c);
        let entries = |i: usize| self.r.row(i).take_while(|&(j, _)| j < self.rank);
        (0..self.rank).map(|i| entries(i).map(|(j, v)| v * x[j]).sum()).collect()
    }
}

fn column(x: &Mat<f64>, c: usize) -> Vec<f64> {
    (0..x.nrows()).map(|i| x[(i, c)]).collect()
}

#[cfg(test)]
mod tests {
    use super::super::check::Random;
    use super::*;

    /// R1 of full rank with sums of earlier columns, which a QR without pivoting keeps when their remainders are `left`.
    fn with_sums(rank: usize, sums: usize, left: f64) -> Factor {
        let mut random = Random(3);
        let mut columns: Vec<Vec<f64>> = Vec::new();
        for j in 0..rank {
            let mut column = vec![0.0; rank];
            if j >= rank - sums {
                let (a, b) = (random.below(rank - sums), random.below(rank - sums));
                (0..rank).for_each(|i| column[i] = columns[a][i] + columns[b][i]);
                column[j] += left;
            } else {
                (0..j)
                    .filter(|_| random.below(9) == 0)
                    .collect::<Vec<_>>()
                    .into_iter()
                    .for_each(|i| column[i] = random.signed());
                column[j] = 2.0;
            }
            columns.push(column);
        }
        let mut r = Csr::empty(rank);
        (0..rank).for_each(|i| r.push_row((i..rank).map(|j| (j, columns[j][i])).filter(|&(_, v)| v != 0.0)));
        Factor { rank, order: (0..rank).collect(), r, rhs: Vec::new(), rest: Vec::new(), dropped: 0.0 }
    }

    #[test]
    fn columns_that_are_sums_of_others_are_found_whatever_their_number() {
        for sums in [1, 5, 8, 9, 40] {
            let factor = with_sums(120, sums, 1e-9);
            let weak = factor.weak_columns(1e-6).expect("a small dense QR").expect("not too many");
            assert_eq!(weak.len(), sums);
            let kept: Vec<usize> = (0..120).filter(|j| !weak.contains(j)).collect();
            let columns = factor.r.transpose();
            let mut left = Csr::empty(120);
            kept.iter().for_each(|&j| left.push_row(columns.row(j)));
            let sigma = Faer.factor(&left, &[], 0.0).expect("small").smallest_singular_value().0;
            assert!(sigma > 1e-3, "{sums} sums: {sigma:e}");
        }
    }

    #[test]
    fn sound_factors_have_none() {
        assert_eq!(with_sums(60, 0, 0.0).weak_columns(1e-6), Ok(Some(Vec::new())));
        assert_eq!(with_sums(60, 4, 1e-3).weak_columns(1e-6), Ok(Some(Vec::new())));
    }
}
