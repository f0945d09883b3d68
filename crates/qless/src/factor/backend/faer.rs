//! `A P = Q R` by Householder QR with column pivoting on faer's dense kernels: pure Rust, any shape, any rank.
//!
//! Pivoting takes the column with the largest remaining norm, so `|R_11| >= |R_22| >= ...`, and the rank is the number
//! of diagonal entries above the tolerance. O(m n min(m, n)) time, 8 m (n + k) bytes for A and B.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::householder::{
    apply_block_householder_sequence_transpose_on_the_left_in_place_scratch as apply_scratch,
    apply_block_householder_sequence_transpose_on_the_left_in_place_with_conj as apply_transpose,
};
use faer::linalg::qr::col_pivoting::factor::{qr_in_place, qr_in_place_scratch, recommended_block_size};
use faer::{Conj, Mat, Par, Spec};

use super::{Backend, BackendError, Factor, check_block};
use crate::Csr;

/// Largest number of entries of a dense block: they occupy 2 GiB.
const DENSE_LIMIT: usize = 1 << 28;

/// Dense QR with column pivoting as a [`Backend`].
#[derive(Clone, Copy, Debug, Default)]
pub struct Faer;

impl Backend for Faer {
    fn name(&self) -> &'static str {
        "faer"
    }

    fn version(&self) -> String {
        "faer 0.24".to_owned()
    }

    fn pivots(&self, _: usize, _: usize) -> bool {
        true
    }

    fn factor(&self, columns: &Csr, rhs: &[f64], tolerance: f64) -> Result<Factor, BackendError> {
        let (m, n) = (columns.cols, columns.rows());
        check_block(columns, rhs, tolerance)?;
        let k = rhs.len().checked_div(m).unwrap_or(0);
        if m.saturating_mul(n + k) > DENSE_LIMIT {
            let advice = "; keep presolve on, or use a sparse backend (sparse, spqr)";
            return Err(BackendError::OutOfMemory { backend: "faer", rows: m, cols: n + k, advice });
        }
        // faer returns NaN for the reflections of a zero matrix.
        if columns.val.iter().all(|&v| v == 0.0) {
            return Ok(empty(n, rhs, k));
        }
        let mut a = Mat::zeros(m, n);
        for j in 0..n {
            columns.row(j).for_each(|(i, v)| a[(i, j)] = v);
        }
        let mut b = Mat::from_fn(m, k, |i, c| rhs[c * m + i]);
        let (order, rank) = factor_in_place(&mut a, &mut b, tolerance);
        Ok(read(&a, &b, order, rank))
    }
}

/// Pivots below this times the first one of a stage are chosen again in the next stage: faer updates the norms of the remaining
/// columns, and below about 1e-8 of the first norm the updated values are rounding.
const GRADE: f64 = 1e-6;

/// Factors `A P = Q R` in place: A becomes R above its diagonal, and the right-hand sides B become `Q^T B`. Returns P and the rank. Each
/// stage computes the norms of the remaining columns afresh. If no pivot is small, one stage is enough.
fn factor_in_place(a: &mut Mat<f64>, b: &mut Mat<f64>, tolerance: f64) -> (Vec<usize>, usize) {
    let (n, steps) = (a.ncols(), a.nrows().min(a.ncols()));
    let (mut order, mut rank) = stage(a, b, tolerance);
    while rank < steps && largest_left(a, rank) > tolerance {
        let mut left = Mat::from_fn(steps - rank, n - rank, |i, j| if i > j { 0.0 } else { a[(rank + i, rank + j)] });
        let mut rest = Mat::from_fn(steps - rank, b.ncols(), |i, c| b[(rank + i, c)]);
        let (places, found) = stage(&mut left, &mut rest, tolerance);
        if found == 0 {
            break;
        }
        for i in 0..rank {
            let row: Vec<f64> = places.iter().map(|&j| a[(i, rank + j)]).collect();
            row.into_iter().enumerate().for_each(|(j, v)| a[(i, rank + j)] = v);
        }
        a.as_mut().get_mut(rank..steps, rank..).copy_from(&left);
        b.as_mut().get_mut(rank..steps, ..).copy_from(&rest);
        let names: Vec<usize> = places.iter().map(|&j| order[rank + j]).collect();
        order[rank..].copy_from_slice(&names);
        rank += found;
    }
    (order, rank)
}

/// The largest norm of a remaining column, from row `rank` on.
fn largest_left(r: &Mat<f64>, rank: usize) -> f64 {
    let steps = r.nrows().min(r.ncols());
    let norm = |j: usize| (rank..=j.min(steps - 1)).map(|i| r[(i, j)].powi(2)).sum::<f64>().sqrt();
    (rank..r.ncols()).map(norm).fold(0.0, f64::max)
}

/// QR with column pivoting by faer; returns the column order P and the number of pivots that are large enough to be reliable. It runs on
/// one thread, so that the result is the same to the last bit for every number of threads. Only reflections of nonzero pivots are applied,
/// because the others are undefined.
fn stage(a: &mut Mat<f64>, b: &mut Mat<f64>, tolerance: f64) -> (Vec<usize>, usize) {
    let (m, n, steps) = (a.nrows(), a.ncols(), a.nrows().min(a.ncols()));
    let block = recommended_block_size::<f64>(m, n);
    let mut coefficients = Mat::zeros(block, steps);
    let (mut order, mut inverse) = (vec![0; n], vec![0; n]);
    let scratch = qr_in_place_scratch::<usize, f64>(m, n, block, Par::Seq, Spec::default());
    let mut memory = MemBuffer::new(scratch.or(apply_scratch::<f64>(m, block, b.ncols())));
    let stack = MemStack::new(&mut memory);
    let params = Spec::default();
    qr_in_place(a.as_mut(), coefficients.as_mut(), &mut order, &mut inverse, Par::Seq, stack, params);
    let limit = tolerance.max(GRADE * a[(0, 0)].abs());
    let sure = (0..steps).take_while(|&i| a[(i, i)].abs() > limit).count();
    // The remaining rows of the right-hand sides B are transformed only if another stage follows.
    let reflections = if sure < steps && largest_left(a, sure) > tolerance {
        (0..steps).take_while(|&i| a[(i, i)] != 0.0).count()
    } else {
        sure
    };
    if reflections > 0 {
        let basis = a.as_ref().get(.., ..reflections);
        apply_transpose(basis, coefficients.as_ref().get(.., ..reflections), Conj::No, b.as_mut(), Par::Seq, stack);
    }
    (order, sure)
}

fn read(a: &Mat<f64>, b: &Mat<f64>, order: Vec<usize>, rank: usize) -> Factor {
    let (steps, n) = (a.nrows().min(a.ncols()), a.ncols());
    let mut r = Csr::empty(n);
    for i in 0..rank {
        r.append((i..n).map(|j| (j, a[(i, j)])).filter(|&(_, v)| v != 0.0));
    }
    let dropped = (rank..steps).flat_map(|i| (i..n).map(move |j| (i, j))).map(|at| a[at].powi(2)).sum::<f64>();
    Factor {
        rank,
        order,
        r,
        rhs: (0..b.ncols()).flat_map(|c| (0..rank).map(move |i| (i, c))).map(|at| b[at]).collect(),
        rest: (0..b.ncols()).map(|c| (rank..b.nrows()).map(|i| b[(i, c)].powi(2)).sum::<f64>().sqrt()).collect(),
        dropped: dropped.sqrt(),
    }
}

fn empty(n: usize, rhs: &[f64], k: usize) -> Factor {
    let m = rhs.len().checked_div(k).unwrap_or(0);
    let norm = |c: usize| rhs[c * m..(c + 1) * m].iter().map(|v| v * v).sum::<f64>().sqrt();
    Factor {
        rank: 0,
        order: (0..n).collect(),
        r: Csr::empty(n),
        rhs: Vec::new(),
        rest: (0..k).map(norm).collect(),
        dropped: 0.0,
    }
}

#[cfg(test)]
mod tests {
    use crate::factor::backend::Backend;

    #[test]
    fn identities_hold_on_the_test_families() {
        crate::factor::backend::check::families(&super::Faer);
    }

    /// Half of the columns repeat the others up to a remainder of 1e-8 to 1e-13, in no order. The pivots must descend nevertheless: the
    /// norm of a column that is only updated from step to step is rounding at this size.
    #[test]
    fn pivots_descend_below_the_root_of_rounding() {
        let mut random = crate::factor::backend::check::Random(5);
        let left = |k: usize| 10_f64.powi(-8 - (k % 6) as i32);
        let mut rows = vec![vec![0.0; 60]; 60];
        for k in 0..30 {
            for row in &mut rows[..30] {
                row[k] = random.signed();
                row[30 + k] = row[k];
            }
            rows[30 + k][30 + k] = left(k);
        }
        let columns = crate::factor::backend::check::from_dense(&rows);
        let diagonal = |i: usize, r: &crate::Csr| r.row(i).next().map_or(0.0, |(_, v)| v.abs());
        for (tolerance, rank) in [(0.0, 60), (1e-14, 60), (1e-12, 55), (1e-9, 35)] {
            let factor = super::Faer.factor(&columns, &[], tolerance).expect("small");
            let pivots: Vec<f64> = (0..factor.rank).map(|i| diagonal(i, &factor.r)).collect();
            assert!(pivots.windows(2).all(|pair| pair[1] <= 1.01 * pair[0]), "{tolerance}: {pivots:?}");
            if tolerance == 0.0 || tolerance == 1e-14 {
                assert_eq!(factor.rank, rank, "{tolerance}: {pivots:?}");
            } else {
                assert!(factor.dropped <= 6.0 * tolerance, "{tolerance}: {}", factor.dropped);
            }
        }
    }
}
