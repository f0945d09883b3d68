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
mod tests;
