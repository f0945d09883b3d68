//! Columns that a QR without pivoting kept although they nearly depend on others.
//!
//! They are found by the right singular vectors of R1 for its smallest singular values: block inverse iteration
//! `X <- orth(R1^-1 R1^-T X)` with a Ritz step (Foster and Davis 2013, Algorithm 933). X gets more columns until one of its Ritz values is
//! above the limit. A step costs O(nnz(R1) k) for k columns, which are solved in parallel. Dense factorizations run on one thread, so that
//! the result is the same to the last bit for every number of threads.

use faer::diag::Diag;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::householder::{
    apply_block_householder_sequence_on_the_left_in_place_scratch as apply_scratch,
    apply_block_householder_sequence_on_the_left_in_place_with_conj as apply,
};
use faer::linalg::matmul::matmul;
use faer::linalg::qr::no_pivoting::factor::{qr_in_place, qr_in_place_scratch, recommended_block_size};
use faer::linalg::svd::{ComputeSvdVectors, SvdParams, svd, svd_scratch};
use faer::{Accum, Conj, Mat, Par, Spec};
use rayon::prelude::*;

use super::faer::Faer;
use super::many::{Slab, WIDTH, slabs};
use super::{Backend, BackendError, Factor};
use crate::Csr;
use crate::common::random::randoms;

/// Largest number of steps of inverse iteration. The first step is enough if the singular values below the limit are far smaller than all
/// others.
const STEPS: usize = 2;
/// Singular values below the limit have converged if they are smaller than all others by this factor.
const CLEAR: f64 = 1e3;
/// Initial number of vectors of the inverse iteration.
const BLOCK: usize = WIDTH;
/// Factor by which the number of vectors grows if they are not enough.
const GROWTH: usize = 2;
/// Largest number of vectors: a matrix with more small singular values is not nearly of full rank.
const MOST: usize = 512;

/// Columns of the triangular factor R1 that are nearly combinations of others.
pub(crate) struct Weak {
    /// Positions of the weak columns in the triangular factor R1.
    pub columns: Vec<usize>,
    /// An orthonormal basis of the near null space of the triangular factor R1 (r x r); r x k for k weak columns.
    pub null: Mat<f64>,
}

impl Factor {
    /// Finds one weak column of R1 for each singular value that is at most `limit`; without these columns R1 has no such singular values.
    /// The weak columns are those in which the singular vectors are most independent. `expected` is a guess of their number. None if there
    /// are [`MOST`] values or more, or if the iteration fails.
    pub(crate) fn weak_columns(&self, limit: f64, expected: usize) -> Result<Option<Weak>, BackendError> {
        let Some(null) = self.near_null(limit, expected) else { return Ok(None) };
        if null.ncols() == 0 {
            return Ok(Some(Weak { columns: Vec::new(), null }));
        }
        // QR with pivoting of the transposed basis (k x r) chooses its k most independent columns.
        let mut rows = Csr::empty(null.ncols());
        (0..null.nrows()).for_each(|i| rows.append((0..null.ncols()).map(|k| (k, null[(i, k)]))));
        let factor = Faer.factor(&rows, &[], 0.0)?;
        Ok(Some(Weak { columns: factor.order[..factor.rank].to_vec(), null }))
    }

    /// An orthonormal basis of the near null space of the triangular factor R1 (r x r): r x k for k singular values up to `limit`.
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

    /// Ritz vectors and values of the triangular factor R1 after inverse iteration with `width` vectors; the values descend.
    fn ritz(&self, width: usize, limit: f64) -> Option<(Mat<f64>, Vec<f64>)> {
        let random: Vec<f64> = randoms(7).take(self.rank * width).map(|x| x - 1.0).collect();
        let mut x = slabs(width, self.rank, |c, i| random[c * self.rank + i]);
        for step in 1.. {
            x.par_iter_mut().for_each(|slab| self.inverse_step(slab));
            if x.iter().flatten().flatten().any(|v| !v.is_finite()) {
                return None;
            }
            let basis = orthonormal_basis(joined(&x, width));
            x = slabs(width, self.rank, |c, i| basis[(i, c)]);
            let products: Vec<Slab> = x.par_iter().map(|slab| self.times_slab(slab)).collect();
            let (values, vectors) = singular(&triangle(joined(&products, width)))?;
            let small = values.partition_point(|&value| value > limit);
            let separated =
                small == 0 || small == width || values[small - 1] > CLEAR * values[small].max(limit / CLEAR);
            if step == STEPS || separated {
                let mut rotated = Mat::zeros(self.rank, width);
                matmul(rotated.as_mut(), Accum::Replace, &basis, &vectors, 1.0, Par::Seq);
                return Some((rotated, values));
            }
        }
        None
    }

    /// A step of inverse iteration, `X <- R1^-1 R1^-T X` with the triangular factor R1; each vector is scaled to a largest entry of 1.
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

/// QR of an m x k matrix in place, m >= k: A becomes R and the vectors of the reflections. Returns the coefficients of the reflections.
fn qr(a: &mut Mat<f64>) -> Mat<f64> {
    let (m, k) = a.shape();
    let block = recommended_block_size::<f64>(m, k);
    let mut coefficients = Mat::zeros(block, k.min(m));
    let params = Spec::default();
    let mut memory = MemBuffer::new(qr_in_place_scratch::<f64>(m, k, block, Par::Seq, params));
    qr_in_place(a.as_mut(), coefficients.as_mut(), Par::Seq, MemStack::new(&mut memory), params);
    coefficients
}

/// The first k columns of Q of the QR factorization of an m x k matrix.
fn orthonormal_basis(mut a: Mat<f64>) -> Mat<f64> {
    let coefficients = qr(&mut a);
    let (m, k) = a.shape();
    let mut q = Mat::identity(m, k);
    let mut memory = MemBuffer::new(apply_scratch::<f64>(m, coefficients.nrows(), k));
    apply(a.as_ref(), coefficients.as_ref(), Conj::No, q.as_mut(), Par::Seq, MemStack::new(&mut memory));
    q
}

/// The factor R (k x k) of the QR factorization of an m x k matrix.
fn triangle(mut a: Mat<f64>) -> Mat<f64> {
    qr(&mut a);
    let k = a.ncols();
    Mat::from_fn(k, k, |i, j| if i <= j { a[(i, j)] } else { 0.0 })
}

/// Singular values, descending, and right singular vectors of a small square matrix. The QR algorithm is used at every size: faer's default
/// from 128 rows on, divide and conquer, returned 2e-5 for a singular value that is zero, when many were zero.
fn singular(a: &Mat<f64>) -> Option<(Vec<f64>, Mat<f64>)> {
    let k = a.ncols();
    let mut params = Spec::<SvdParams, f64>::default();
    params.config.recursion_threshold = usize::MAX;
    let (mut values, mut vectors) = (Diag::zeros(k), Mat::zeros(k, k));
    let (none, all) = (ComputeSvdVectors::No, ComputeSvdVectors::Full);
    let mut memory = MemBuffer::new(svd_scratch::<f64>(k, k, none, all, Par::Seq, params));
    svd(a.as_ref(), values.as_mut(), None, Some(vectors.as_mut()), Par::Seq, MemStack::new(&mut memory), params)
        .ok()?;
    Some((values.column_vector().iter().copied().collect(), vectors))
}

#[cfg(test)]
mod tests {
    use super::super::check::Random;
    use super::*;

    /// A triangular factor R1 of full rank in which `sums` columns are sums of two others plus a remainder `left`. A QR without pivoting
    /// keeps them.
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
    fn any_number_of_columns_that_are_sums_of_others_is_found() {
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
    fn well_conditioned_factors_have_no_weak_columns() {
        for (sums, left) in [(0, 0.0), (4, 1e-3)] {
            let weak =
                with_sums(60, sums, left).weak_columns(1e-6, 0).expect("a small dense QR").expect("not too many");
            assert_eq!(weak.columns, [0; 0]);
        }
    }

    /// Singular values 1, 1/2, 1/4, ...: none is far smaller than all others.
    #[test]
    fn singular_values_near_the_limit_are_told_apart() {
        for count in [1, 5, 8, 20, 33] {
            let mut r = Csr::empty(41);
            (0..41).for_each(|i| r.append([(i, 0.5_f64.powi(i as i32))]));
            let factor =
                Factor { rank: 41, order: (0..41).collect(), r, rhs: Vec::new(), rest: Vec::new(), dropped: 0.0 };
            let limit = 0.7 * 0.5_f64.powi(40 - count);
            let mut weak = factor.weak_columns(limit, 0).expect("a small dense QR").expect("not too many").columns;
            weak.sort_unstable();
            assert_eq!(weak, (41 - count as usize..41).collect::<Vec<_>>());
        }
    }
}
