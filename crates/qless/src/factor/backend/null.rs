//! Right singular vectors of R1 that belong to its smallest values: what a QR without pivoting kept and should not have.
//!
//! Block inverse iteration `X <- orth(R1^-1 R1^-T X)` with a Ritz step (Foster and Davis 2013, Algorithm 933), the block
//! made wider until it holds a value above the limit. O(nnz(R1) k) for k values, all columns of X in parallel.

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, Par};
use rayon::prelude::*;

use super::faer::Faer;
use super::many::{Slab, WIDTH, slabs};
use super::tall::{Tall, singular};
use super::{Backend, BackendError, Factor};
use crate::Csr;
use crate::common::random::randoms;

/// Steps of inverse iteration: values well below the limit stand out after the first.
const STEPS: usize = 2;
/// Values below the limit that lie below all others by this factor have converged.
const CLEAR: f64 = 1e3;
/// Vectors at first, ...
const BLOCK: usize = WIDTH;
/// ... and how many times more where those are not enough.
const GROWTH: usize = 4;
/// Most of them: a matrix that has more such values is no near miss.
const MOST: usize = 512;

/// Columns of R1 that are nearly combinations of others.
pub(crate) struct Weak {
    /// Their positions.
    pub columns: Vec<usize>,
    /// An orthonormal basis of the near null space of R1, r x k, k columns being weak.
    pub null: Mat<f64>,
}

impl Factor {
    /// Columns without which the singular values of R1 at most `limit` are gone; as many as there are such values, those by which
    /// the singular vectors differ most. None if there are too many to count; `expected` tells where to begin.
    pub(crate) fn weak_columns(&self, limit: f64, expected: usize) -> Result<Option<Weak>, BackendError> {
        let Some(null) = self.near_null(limit, expected) else { return Ok(None) };
        if null.ncols() == 0 {
            return Ok(Some(Weak { columns: Vec::new(), null }));
        }
        // N^T, k x r, by its columns: QR with pivoting takes the k that are most independent.
        let mut rows = Csr::empty(null.ncols());
        (0..null.nrows()).for_each(|i| rows.append((0..null.ncols()).map(|k| (k, null[(i, k)]))));
        let factor = Faer.factor(&rows, &[], 0.0)?;
        Ok(Some(Weak { columns: factor.order[..factor.rank].to_vec(), null }))
    }

    /// An orthonormal basis, r x k. Blocks of vectors grow until one holds a value above the limit.
    fn near_null(&self, limit: f64, expected: usize) -> Option<Mat<f64>> {
        let mut width = (expected + BLOCK).next_multiple_of(BLOCK).min(MOST).min(self.rank);
        while width > 0 {
            let (basis, values) = self.ritz(width, limit)?;
            let small = values.iter().filter(|&&value| value <= limit).count();
            if small < width || width == self.rank {
                return Some(basis.get(.., width - small..).to_owned());
            }
            if width == MOST {
                return None;
            }
            width = (GROWTH * width).min(MOST).min(self.rank);
        }
        Some(Mat::zeros(self.rank, 0))
    }

    /// Ritz vectors and values of R1, the values descending.
    fn ritz(&self, width: usize, limit: f64) -> Option<(Mat<f64>, Vec<f64>)> {
        let random: Vec<f64> = randoms(7).take(self.rank * width).map(|x| x - 1.0).collect();
        let mut x = slabs(width, self.rank, |c, i| random[c * self.rank + i]);
        for step in 1.. {
            x.par_iter_mut().for_each(|slab| self.inverse_step(slab));
            if x.iter().flatten().flatten().any(|v| !v.is_finite()) {
                return None;
            }
            let basis = Tall::new(joined(&x, width)).basis();
            x = slabs(width, self.rank, |c, i| basis[(i, c)]);
            let products: Vec<Slab> = x.par_iter().map(|slab| self.times_slab(slab)).collect();
            let (values, vectors) = singular(&Tall::new(joined(&products, width)).triangle())?;
            let small = values.partition_point(|&value| value > limit);
            let parted = small == 0 || small == width || values[small - 1] > CLEAR * values[small].max(limit / CLEAR);
            if step == STEPS || parted {
                let mut turned = Mat::zeros(self.rank, width);
                matmul(turned.as_mut(), Accum::Replace, &basis, &vectors, 1.0, Par::Seq);
                return Some((turned, values));
            }
        }
        None
    }

    /// `X <- R1^-1 R1^-T X`, each vector brought to size 1.
    fn inverse_step(&self, x: &mut Slab) {
        self.solve_slab_transposed(x);
        self.solve_slab(x);
        let mut largest = [f64::MIN_POSITIVE; WIDTH];
        x.iter().for_each(|row| largest.iter_mut().zip(row).for_each(|(most, v)| *most = most.max(v.abs())));
        x.iter_mut().for_each(|row| row.iter_mut().zip(&largest).for_each(|(v, most)| *v /= most));
    }
}

fn joined(slabs: &[Slab], width: usize) -> Mat<f64> {
    Mat::from_fn(slabs[0].len(), width, |i, c| slabs[c / WIDTH][i][c % WIDTH])
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
        (0..rank).for_each(|i| r.append((i..rank).map(|j| (j, columns[j][i])).filter(|&(_, v)| v != 0.0)));
        Factor { rank, order: (0..rank).collect(), r, rhs: Vec::new(), rest: Vec::new(), dropped: 0.0 }
    }

    #[test]
    fn columns_that_are_sums_of_others_are_found_whatever_their_number() {
        for sums in [1, 5, 8, 9, 40] {
            let factor = with_sums(120, sums, 1e-9);
            let weak = factor.weak_columns(1e-6, 0).expect("a small dense QR").expect("not too many").columns;
            assert_eq!(weak.len(), sums);
            let kept: Vec<usize> = (0..120).filter(|j| !weak.contains(j)).collect();
            let columns = factor.r.transposed();
            let mut left = Csr::empty(120);
            kept.iter().for_each(|&j| left.append(columns.row(j)));
            let sigma = Faer.factor(&left, &[], 0.0).expect("small").smallest_singular_value().0;
            assert!(sigma > 1e-3, "{sums} sums: {sigma:e}");
        }
    }

    #[test]
    fn sound_factors_have_none() {
        for (sums, left) in [(0, 0.0), (4, 1e-3)] {
            let weak =
                with_sums(60, sums, left).weak_columns(1e-6, 0).expect("a small dense QR").expect("not too many");
            assert_eq!(weak.columns, [0; 0]);
        }
    }
}
