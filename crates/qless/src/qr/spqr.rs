//! `Q^T A P = [R1 R2; 0 0]` and `Q^T B` by SuiteSparseQR (Davis 2011, Algorithm 915), so W = Q^T.
//!
//! Multifrontal Householder QR with Heath's rank detection. One call of its C interface factors A and
//! transforms B; Q is neither formed nor kept. Results are copied to owned data and the C memory is freed
//! before the call returns, so that nothing here holds a C pointer and threads need no care.
//! SuiteSparseQR is GPL-2.0-or-later; a binary built with the feature `spqr` is too.
#![allow(unsafe_code, reason = "the one module that calls spqr-sys")]

use super::{Backend, BackendError, Factor};
use crate::Csr;
use spqr_sys::{cholmod_common, cholmod_dense, cholmod_sparse};
use std::collections::TryReserveError;
use std::ptr::{from_mut, null_mut};

const NAME: &str = "spqr";

/// SuiteSparseQR, sequential, ordering by its own default (COLAMD, AMD or METIS).
#[derive(Clone, Copy, Debug, Default)]
pub struct Spqr;

impl Backend for Spqr {
    fn name(&self) -> &'static str {
        NAME
    }

    fn version(&self) -> String {
        let library = spqr_sys::version().unwrap_or_else(|mismatch| mismatch.library);
        format!("SuiteSparseQR {}, SuiteSparse {library}", spqr_sys::SPQR)
    }

    /// # Panics
    /// If `tolerance` is negative or not a number: SuiteSparseQR reads those as other settings.
    fn factor(&self, columns: &Csr, rhs: &[f64], tolerance: f64) -> Result<Factor, BackendError> {
        assert!(tolerance >= 0.0, "the tolerance {tolerance} is no distance");
        spqr_sys::version().map_err(|mismatch| failed(mismatch.to_string()))?;
        let (m, n) = (columns.cols, columns.rows());
        if u32::try_from(n).is_err() || i64::try_from(m).is_err() {
            return Err(BackendError::TooLarge { backend: NAME, rows: m, cols: n });
        }
        if !all_finite(&columns.val) || !all_finite(rhs) {
            return Err(failed(format!("a number of the {m} x {n} block or of its right-hand sides is not finite")));
        }
        let tall = Tall { rows: m, count: rhs.len().checked_div(m).unwrap_or(0), values: rhs };
        debug_assert_eq!(tall.rows * tall.count, rhs.len(), "B is not m x k");
        if columns.nnz() == 0 { Ok(nothing_to_factor(n, tall)) } else { factor_in_c(columns, tall, tolerance) }
    }
}

/// A dense m x k matrix by columns.
#[derive(Clone, Copy)]
struct Tall<'a> {
    rows: usize,
    count: usize,
    values: &'a [f64],
}

impl<'a> Tall<'a> {
    fn columns(self) -> impl Iterator<Item = &'a [f64]> {
        self.values.chunks_exact(self.rows.max(1))
    }

    fn head(self, rank: usize) -> Vec<f64> {
        self.columns().flat_map(|b| &b[..rank]).copied().collect()
    }

    fn rest(self, rank: usize) -> Vec<f64> {
        self.columns().map(|b| norm(&b[rank..])).collect()
    }
}

/// SuiteSparseQR takes a NaN for an independent entry and reports success.
fn all_finite(values: &[f64]) -> bool {
    values.iter().all(|v| v.is_finite())
}

/// The 2-norm; scaled, so that squares neither overflow nor vanish.
fn norm(x: &[f64]) -> f64 {
    let largest = x.iter().fold(0.0, |max: f64, v| max.max(v.abs()));
    if largest == 0.0 { 0.0 } else { largest * x.iter().map(|v| (v / largest).powi(2)).sum::<f64>().sqrt() }
}

/// A = 0 or without rows or columns: W = I. C is not asked, it does not take every empty matrix.
fn nothing_to_factor(n: usize, b: Tall) -> Factor {
    let r = Csr::empty(n);
    Factor { rank: 0, order: (0..n).collect(), r, rhs: Vec::new(), rest: b.rest(0), dropped: 0.0 }
}

fn factor_in_c(columns: &Csr, b: Tall, tolerance: f64) -> Result<Factor, BackendError> {
    let (m, n) = (columns.cols, columns.rows());
    let mut call = Call::start(n + b.count);
    let rank = call.run(columns, b, tolerance).map_err(|status| error_of(status, m, n))?;
    let (order, r) = (call.order(n), call.r(rank, n));
    let r = r.map_err(|_| error_of(spqr_sys::CHOLMOD_OUT_OF_MEMORY, m, n))?;
    if !is_trapezoidal(&r) {
        return Err(failed("SuiteSparseQR returned an R that is not [R1 R2]".into()));
    }
    let z = call.transformed(b.count);
    if !all_finite(&r.val) || !all_finite(z.values) {
        return Err(failed(format!("the {m} x {n} block overflows: scale it")));
    }
    Ok(Factor { rank, order, r, rhs: z.head(rank), rest: z.rest(rank), dropped: call.common.SPQR_norm_E_fro })
}

/// Row i begins at column i: then R1 is upper triangular and nonsingular.
fn is_trapezoidal(r: &Csr) -> bool {
    (0..r.rows()).all(|i| r.row(i).next().is_some_and(|(j, _)| j == i))
}

/// What C allocates for one factorization. Dropping it frees all of it, however the call went.
struct Call {
    common: Box<cholmod_common>,
    z: *mut cholmod_dense,
    r: *mut cholmod_sparse,
    order: *mut i64,
    order_length: usize,
}

impl Call {
    fn start(order_length: usize) -> Self {
        // SAFETY: the struct is numbers, arrays of them and nullable pointers; all zeros is a value of it.
        let mut common: Box<cholmod_common> = Box::new(unsafe { std::mem::zeroed() });
        // SAFETY: the struct is as large as C's (spqr-sys checks) and the box keeps it in place.
        unsafe { spqr_sys::cholmod_l_start(from_mut(&mut *common)) };
        common.print = 0;
        Self { common, z: null_mut(), r: null_mut(), order: null_mut(), order_length }
    }

    /// The rank, or CHOLMOD's status. The order must be asked for: without it SPQR 2.1 frees a deficient R twice.
    fn run(&mut self, columns: &Csr, b: Tall, tolerance: f64) -> Result<usize, i32> {
        let mut start: Vec<i64> = columns.start.iter().map(|&entry| entry as i64).collect();
        let mut index: Vec<i64> = columns.col.iter().map(|&row| i64::from(row)).collect();
        let mut a = sparse_view(columns, &mut start, &mut index);
        let mut dense = dense_view(b);
        let (b_in, z_out) =
            if b.count == 0 { (null_mut(), null_mut()) } else { (from_mut(&mut dense), &raw mut self.z) };
        // econ = m keeps every row of Q^T B; R has entries in its first rows only, so this costs nothing.
        let econ = b.rows as i64;
        // SAFETY: the views outlive the call, which reads them only; outputs are null or owned by `self`; Z is
        // asked for dense exactly when B is given; H, HPinv and HTau may be null.
        let rank = unsafe {
            spqr_sys::SuiteSparseQR_C(
                spqr_sys::SPQR_ORDERING_DEFAULT,
                tolerance,
                econ,
                0,
                &raw mut a,
                null_mut(),
                b_in,
                null_mut(),
                z_out,
                &raw mut self.r,
                &raw mut self.order,
                null_mut(),
                null_mut(),
                null_mut(),
                &raw mut *self.common,
            )
        };
        let complete = !self.r.is_null() && self.z.is_null() == z_out.is_null();
        let accepted = self.common.status >= spqr_sys::CHOLMOD_OK && complete;
        usize::try_from(rank).ok().filter(|_| accepted).ok_or(self.common.status)
    }

    /// P; C returns it for `[A B]`, B last, and returns nothing for the identity.
    fn order(&self, n: usize) -> Vec<usize> {
        if self.order.is_null() {
            return (0..n).collect();
        }
        // SAFETY: SPQR wrote `order_length` >= n entries.
        unsafe { slice(self.order, n) }.iter().map(|&j| j as usize).collect()
    }

    /// C's R: where its columns start, the row of each entry (in no promised order), its value.
    fn r_in_c(&self, n: usize) -> (&[i64], &[i64], &[f64]) {
        // SAFETY: after `run`, R is packed, real, of 64-bit indices: n + 1 starts and as many entries as they say.
        unsafe {
            let r = &*self.r;
            let start = slice(r.p.cast::<i64>(), n + 1);
            let count = start[n] as usize;
            (start, slice(r.i.cast::<i64>(), count), slice(r.x.cast::<f64>(), count))
        }
    }

    /// Rows 0..rank of R without its exact zeros. By far the largest result, so it is copied once, and may fail to.
    fn r(&self, rank: usize, n: usize) -> Result<Csr, TryReserveError> {
        let (column_start, row, value) = self.r_in_c(n);
        let kept = |k: &usize| value[*k] != 0.0 && (row[*k] as usize) < rank;
        let mut start = vec![0; rank + 1];
        (0..row.len()).filter(kept).for_each(|k| start[row[k] as usize + 1] += 1);
        (0..rank).for_each(|i| start[i + 1] += start[i]);
        let (mut col, mut val) = (zeros::<u32>(start[rank])?, zeros::<f64>(start[rank])?);
        let mut next = start.clone();
        for j in 0..n {
            for k in (column_start[j] as usize..column_start[j + 1] as usize).filter(kept) {
                let slot = &mut next[row[k] as usize];
                (col[*slot], val[*slot]) = (j as u32, value[k]);
                *slot += 1;
            }
        }
        Ok(Csr { cols: n, start, col, val })
    }

    /// `Q^T B`, m x k.
    fn transformed(&self, count: usize) -> Tall<'_> {
        if count == 0 {
            return Tall { rows: 0, count, values: &[] };
        }
        // SAFETY: after `run`, Z is dense and real with `d` = `nrow`, as CHOLMOD allocates it.
        let (rows, values) = unsafe { ((*self.z).nrow, slice((*self.z).x.cast::<f64>(), (*self.z).nrow * count)) };
        Tall { rows, count, values }
    }
}

impl Drop for Call {
    fn drop(&mut self) {
        let common = &raw mut *self.common;
        // SAFETY: each pointer is null or was allocated by SPQR under this `common`; freeing null does nothing.
        unsafe {
            spqr_sys::cholmod_l_free_sparse(&raw mut self.r, common);
            spqr_sys::cholmod_l_free_dense(&raw mut self.z, common);
            spqr_sys::cholmod_l_free(self.order_length, size_of::<i64>(), self.order.cast(), common);
            spqr_sys::cholmod_l_finish(common);
        }
    }
}

fn zeros<T: Clone + Default>(length: usize) -> Result<Vec<T>, TryReserveError> {
    let mut values = Vec::new();
    values.try_reserve_exact(length)?;
    values.resize(length, T::default());
    Ok(values)
}

/// # Safety
/// `data` has `length` entries, or `length` is 0.
unsafe fn slice<'a, T>(data: *const T, length: usize) -> &'a [T] {
    // SAFETY: the caller's promise; C may leave the pointer of an empty array null, Rust may not.
    if length == 0 { &[] } else { unsafe { std::slice::from_raw_parts(data, length) } }
}

/// A as CHOLMOD sees it, m x n in compressed columns. C takes mutable pointers but only reads.
fn sparse_view(columns: &Csr, start: &mut [i64], index: &mut [i64]) -> cholmod_sparse {
    cholmod_sparse {
        nrow: columns.cols,
        ncol: columns.rows(),
        nzmax: columns.nnz(),
        p: start.as_mut_ptr().cast(),
        i: index.as_mut_ptr().cast(),
        nz: null_mut(),
        x: columns.val.as_ptr().cast_mut().cast(),
        z: null_mut(),
        stype: 0,
        itype: spqr_sys::CHOLMOD_LONG,
        xtype: spqr_sys::CHOLMOD_REAL,
        dtype: spqr_sys::CHOLMOD_DOUBLE,
        sorted: 1,
        packed: 1,
    }
}

/// B as CHOLMOD sees it; read only too.
fn dense_view(b: Tall) -> cholmod_dense {
    cholmod_dense {
        nrow: b.rows,
        ncol: b.count,
        nzmax: b.values.len(),
        d: b.rows,
        x: b.values.as_ptr().cast_mut().cast(),
        z: null_mut(),
        xtype: spqr_sys::CHOLMOD_REAL,
        dtype: spqr_sys::CHOLMOD_DOUBLE,
    }
}

fn error_of(status: i32, rows: usize, cols: usize) -> BackendError {
    match status {
        spqr_sys::CHOLMOD_OUT_OF_MEMORY => BackendError::OutOfMemory { backend: NAME, rows, cols, advice: "" },
        spqr_sys::CHOLMOD_TOO_LARGE => BackendError::TooLarge { backend: NAME, rows, cols },
        spqr_sys::CHOLMOD_INVALID => failed(format!("CHOLMOD calls the {rows} x {cols} block invalid input")),
        _ => failed(format!("no factorization of the {rows} x {cols} block, CHOLMOD status {status}")),
    }
}

fn failed(message: String) -> BackendError {
    BackendError::Failed { backend: NAME, message }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A by columns, and what the checks need of it.
    struct Case {
        name: &'static str,
        columns: Csr,
        rank: usize,
    }

    fn case(name: &'static str, rank: usize, rows: &[&[f64]]) -> Case {
        let n = rows.first().map_or(0, |row| row.len());
        let mut a = Csr::empty(n);
        for row in rows {
            a.push_row(row.iter().copied().enumerate().filter(|e| e.1 != 0.0));
        }
        Case { name, columns: a.transpose(), rank }
    }

    /// Numbers in -1..1 from a fixed seed.
    struct Seeded(u64);

    impl Seeded {
        fn next(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        }

        fn below(&mut self, n: usize) -> usize {
            (self.next().abs() * n as f64) as usize
        }
    }

    /// m x n with a dominant diagonal; of the n columns each `period`-th is the difference of the two before.
    fn random(name: &'static str, m: usize, n: usize, period: usize) -> Case {
        let mut seeded = Seeded((m * 1000 + n) as u64);
        let mut dense: Vec<Vec<f64>> = Vec::new();
        for j in 0..n {
            let mut column = vec![0.0; m];
            if j % period == period - 1 {
                column = dense[j - 1].iter().zip(&dense[j - 2]).map(|(a, b)| a - b).collect();
            } else {
                (0..3).for_each(|_| column[seeded.below(m)] += seeded.next());
                column[j % m] += 4.0;
            }
            dense.push(column);
        }
        let mut columns = Csr::empty(m);
        for column in &dense {
            columns.push_row(column.iter().copied().enumerate().filter(|e| e.1 != 0.0));
        }
        Case { name, columns, rank: (0..n).filter(|j| j % period != period - 1).count().min(m) }
    }

    fn cases() -> Vec<Case> {
        vec![
            case("one entry", 1, &[&[-3.0]]),
            case("tall", 2, &[&[1.0, 2.0], &[3.0, 4.0], &[5.0, 7.0]]),
            case("wide", 2, &[&[1.0, 2.0, 3.0, 1.0], &[4.0, 5.0, 7.0, 2.0]]),
            case("zero column between", 2, &[&[1.0, 0.0, 2.0], &[3.0, 0.0, 4.0], &[5.0, 0.0, 1.0]]),
            case("duplicate columns", 2, &[&[1.0, 1.0, 2.0], &[3.0, 3.0, 4.0], &[5.0, 5.0, 7.0]]),
            case("first column dead", 1, &[&[0.0, 1.0], &[0.0, 1.0]]),
            case("rank one", 1, &[&[1.0, 2.0, 3.0], &[2.0, 4.0, 6.0], &[3.0, 6.0, 9.0]]),
            case("singletons", 3, &[&[2.0, 1.0, 0.0, 1.0], &[0.0, 3.0, 0.0, 1.0], &[0.0, 0.0, 0.0, 5.0]]),
            case("singletons in one row", 1, &[&[1.0, 2.0, 3.0], &[0.0, 0.0, 0.0]]),
            case("all but one row empty", 2, &[&[0.0; 3], &[1.0, 0.0, 2.0], &[0.0; 3], &[3.0, 0.0, 4.0]]),
            case("zero", 0, &[&[0.0, 0.0], &[0.0, 0.0], &[0.0, 0.0]]),
            random("sparse and tall", 60, 40, 41),
            random("sparse and wide", 30, 45, 46),
            random("sparse, tall, deficient", 400, 300, 7),
            random("sparse, wide, deficient", 40, 50, 5),
        ]
    }

    fn right_hand_sides(m: usize, count: usize) -> Vec<f64> {
        let mut seeded = Seeded(count as u64);
        (0..m * count).map(|_| seeded.next()).collect()
    }

    fn dot(a: &[f64], b: &[f64]) -> f64 {
        a.iter().zip(b).map(|(x, y)| x * y).sum()
    }

    fn dense(rows: &Csr) -> Vec<Vec<f64>> {
        let fill = |i| {
            let mut row = vec![0.0; rows.cols];
            rows.row(i).for_each(|(j, v)| row[j] = v);
            row
        };
        (0..rows.rows()).map(fill).collect()
    }

    /// Columns of A in the factor's order.
    fn ordered(case: &Case, factor: &Factor) -> Vec<Vec<f64>> {
        let a = dense(&case.columns);
        factor.order.iter().map(|&j| a[j].clone()).collect()
    }

    fn assert_close(case: &Case, a: f64, b: f64, allowed: f64) {
        assert!((a - b).abs() <= allowed, "{}: {a} and {b} differ by more than {allowed}", case.name);
    }

    fn factored(case: &Case, rhs: &[f64]) -> Factor {
        let factor = Spqr.factor(&case.columns, rhs, 1e-10 * norm(&case.columns.val)).unwrap();
        assert_eq!(factor.rank, case.rank, "{}", case.name);
        factor
    }

    fn every_case(check: impl Fn(&Case, &[f64], &Factor)) {
        for (case, count) in cases().iter().flat_map(|case| [0, 1, 3].map(|count| (case, count))) {
            let rhs = right_hand_sides(case.columns.cols, count);
            check(case, &rhs, &factored(case, &rhs));
        }
    }

    #[test]
    fn shapes_are_those_promised() {
        every_case(|case, rhs, factor| {
            let (n, count) = (case.columns.rows(), rhs.len() / case.columns.cols);
            let mut order = factor.order.clone();
            order.sort_unstable();
            assert!(order.into_iter().eq(0..n), "{}", case.name);
            assert_eq!((factor.r.rows(), factor.r.cols), (factor.rank, n));
            assert_eq!((factor.rhs.len(), factor.rest.len()), (factor.rank * count, count));
        });
    }

    #[test]
    fn r_is_trapezoidal_and_ascends() {
        every_case(|case, _, factor| {
            assert!(is_trapezoidal(&factor.r), "{}", case.name);
            for i in 0..factor.rank {
                assert!(factor.r.row(i).zip(factor.r.row(i).skip(1)).all(|(a, b)| a.0 < b.0), "{}", case.name);
                assert!(factor.r.row(i).all(|(_, v)| v != 0.0), "{}", case.name);
            }
        });
    }

    #[test]
    fn r_has_the_products_of_the_columns() {
        every_case(|case, _, factor| {
            let size = norm(&case.columns.val);
            assert!(factor.dropped <= 1e-13 * size, "{}: dropped {}", case.name, factor.dropped);
            let (a, r) = (ordered(case, factor), dense(&factor.r.transpose()));
            for (i, j) in (0..a.len()).flat_map(|i| (0..=i).map(move |j| (i, j))) {
                let allowed = (1e-13 * size + 2.0 * factor.dropped) * size;
                assert_close(case, dot(&r[i], &r[j]), dot(&a[i], &a[j]), allowed);
            }
        });
    }

    #[test]
    fn right_hand_sides_have_the_products_with_the_columns() {
        every_case(|case, rhs, factor| {
            let (a, r) = (ordered(case, factor), dense(&factor.r.transpose()));
            let allowed = (1e-13 * norm(&case.columns.val) + factor.dropped) * norm(rhs);
            for (k, b) in rhs.chunks(case.columns.cols).enumerate() {
                let head = &factor.rhs[k * factor.rank..(k + 1) * factor.rank];
                (0..a.len()).for_each(|j| assert_close(case, dot(&r[j], head), dot(&a[j], b), allowed));
            }
        });
    }

    /// Subtracts from b its part along each direction, twice for accuracy.
    fn residual(directions: &[Vec<f64>], b: &[f64]) -> Vec<f64> {
        let mut left = b.to_vec();
        for q in directions.iter().chain(directions) {
            let along = dot(q, &left);
            left.iter_mut().zip(q).for_each(|(x, y)| *x -= along * y);
        }
        left
    }

    #[test]
    fn rest_is_the_least_squares_residual() {
        every_case(|case, rhs, factor| {
            let mut directions: Vec<Vec<f64>> = Vec::new();
            for column in &ordered(case, factor)[..factor.rank] {
                let left = residual(&directions, column);
                let length = norm(&left);
                directions.push(left.into_iter().map(|x| x / length).collect());
            }
            for (b, &rest) in rhs.chunks(case.columns.cols).zip(&factor.rest) {
                assert_close(case, rest, norm(&residual(&directions, b)), 1e-13 * norm(b));
            }
        });
    }

    #[test]
    fn rest_of_a_mean_is_its_deviation() {
        let mean = case("mean", 1, &[&[1.0], &[1.0]]);
        let rest = factored(&mean, &[1.0, 0.0, 2.0, 2.0, 3.0, -1.0]).rest;
        for (found, expected) in rest.into_iter().zip([0.5f64.sqrt(), 0.0, 8f64.sqrt()]) {
            assert_close(&mean, found, expected, 1e-15);
        }
    }

    #[test]
    fn matrices_without_rows_or_columns_have_rank_zero() {
        let without_columns = Spqr.factor(&Csr::empty(2), &[3.0, 4.0, 0.0, 1.0], 0.0).unwrap();
        assert_eq!((without_columns.rank, without_columns.rest), (0, vec![5.0, 1.0]));
        let without_rows = Spqr.factor(&Csr::empty(3).transpose(), &[], 0.0).unwrap();
        assert_eq!((without_rows.order, without_rows.r), (vec![0, 1, 2], Csr::empty(3)));
    }

    #[test]
    fn tolerance_zero_keeps_whatever_is_not_zero() {
        let tiny = case("tiny", 2, &[&[1e-150, 1e-150, 0.0], &[1e-150, -1e-150, 0.0], &[0.0; 3]]);
        assert_eq!(Spqr.factor(&tiny.columns, &[], 0.0).unwrap().rank, tiny.rank);
    }

    #[test]
    fn tolerance_is_absolute_and_what_falls_below_is_reported() {
        let square = case("square", 2, &[&[1.0, 1.0], &[1.0, -1.0]]);
        for tolerance in [2.0, f64::INFINITY] {
            let factor = Spqr.factor(&square.columns, &[3.0, 4.0], tolerance).unwrap();
            assert_eq!((factor.rank, factor.r.nnz()), (0, 0));
            assert_close(&square, factor.rest[0], 5.0, 1e-15);
            assert_close(&square, factor.dropped, 2.0, 1e-15);
        }
        assert_eq!(Spqr.factor(&square.columns, &[], 1.4).unwrap().rank, 2);
    }

    #[test]
    #[should_panic(expected = "the tolerance NaN is no distance")]
    fn a_tolerance_that_is_no_number_is_refused() {
        let _ = Spqr.factor(&cases()[0].columns, &[], f64::NAN);
    }

    #[test]
    #[should_panic(expected = "the tolerance -2 is no distance")]
    fn a_negative_tolerance_is_not_read_as_a_setting() {
        let _ = Spqr.factor(&cases()[0].columns, &[], -2.0);
    }

    #[test]
    fn numbers_that_are_not_finite_are_refused() {
        let (finite, nan) = (case("one", 1, &[&[1.0]]), case("NaN", 0, &[&[f64::NAN]]));
        let message = |case: &Case, rhs: &[f64]| Spqr.factor(&case.columns, rhs, 0.0).unwrap_err().to_string();
        assert!(message(&nan, &[]).contains("the 1 x 1 block"));
        assert!(message(&finite, &[f64::INFINITY]).contains("not finite"));
        let huge = case("huge", 0, &[&[1e308, 1e308], &[1e308, -1e308], &[1e308, 1e307], &[1e308, 1e308]]);
        assert!(message(&huge, &[]).contains("overflows"));
    }

    #[test]
    fn threads_do_not_disturb_each_other() {
        // Values may differ in the last bits where BLAS itself runs threads.
        let orders = || cases().iter().map(|case| factored(case, &[]).order).collect::<Vec<_>>();
        let alone = orders();
        std::thread::scope(|scope| {
            for _ in 0..4 {
                scope.spawn(|| assert_eq!(orders(), alone));
            }
        });
    }

    #[test]
    fn statuses_become_errors_that_name_the_block() {
        let text = |status| error_of(status, 7, 5).to_string();
        assert!(text(spqr_sys::CHOLMOD_OUT_OF_MEMORY).contains("a block of 7 x 5 needs more memory"));
        assert!(text(spqr_sys::CHOLMOD_TOO_LARGE).contains("a block of 7 x 5 is larger"));
        assert!(text(spqr_sys::CHOLMOD_INVALID).contains("7 x 5 block invalid"));
        assert!(text(spqr_sys::CHOLMOD_NOT_INSTALLED).contains("status -1"));
    }

    #[test]
    fn version_names_both_libraries() {
        let version = Spqr.version();
        assert!(version.starts_with("SuiteSparseQR ") && version.contains(", SuiteSparse "), "{version}");
        assert_eq!(Spqr.name(), "spqr");
    }
}
