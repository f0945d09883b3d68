//! `x = A\b` and the minimum-norm solution of `A x = b`, by the usual calls of SuiteSparseQR; for comparisons.

use core::ptr::null_mut;

use crate::blas;
use crate::memory::Common;
use crate::{SuiteSparseQR_C_factorization as Factorization, cholmod_common, cholmod_dense, cholmod_sparse};

/// An m x n matrix by columns, row indices ascending.
#[derive(Clone, Debug)]
pub struct Columns {
    rows: usize,
    start: Vec<i64>,
    index: Vec<i64>,
    values: Vec<f64>,
}

impl Columns {
    /// `None` if the arrays are not such a matrix.
    pub fn new(rows: usize, start: Vec<i64>, index: Vec<i64>, values: Vec<f64>) -> Option<Self> {
        let ascends = start.first() == Some(&0) && start.windows(2).all(|pair| pair[0] <= pair[1]);
        let ends = start.last().and_then(|&end| usize::try_from(end).ok());
        let fits = ends == Some(index.len()) && index.len() == values.len();
        let inside = index.iter().all(|&i| usize::try_from(i).is_ok_and(|i| i < rows));
        let sorted = |pair: &[i64]| index[pair[0] as usize..pair[1] as usize].windows(2).all(|two| two[0] < two[1]);
        (ascends && fits && inside && start.windows(2).all(sorted)).then_some(Self { rows, start, index, values })
    }

    /// The matrix for C, which takes mutable pointers but does not write.
    fn view(&self) -> cholmod_sparse {
        cholmod_sparse {
            nrow: self.rows,
            ncol: self.start.len() - 1,
            nzmax: self.index.len(),
            p: self.start.as_ptr().cast_mut().cast(),
            i: self.index.as_ptr().cast_mut().cast(),
            nz: null_mut(),
            x: self.values.as_ptr().cast_mut().cast(),
            z: null_mut(),
            stype: 0,
            itype: crate::CHOLMOD_LONG,
            xtype: crate::CHOLMOD_REAL,
            dtype: crate::CHOLMOD_DOUBLE,
            sorted: 1,
            packed: 1,
        }
    }
}

/// An x that minimises `|A x - b|`, by `SuiteSparseQR_C_backslash_default`; a basic solution if columns are dependent.
///
/// # Errors
/// CHOLMOD's status; [`crate::CHOLMOD_INVALID`] if the length of b is not the number of rows.
pub fn backslash(a: &Columns, b: &[f64]) -> Result<Vec<f64>, i32> {
    let (mut common, mut a_view, mut b_view) = started(a, b)?;
    let held = blas::hold(1).ok_or(crate::CHOLMOD_OUT_OF_MEMORY)?;
    let cc = common.as_mut_ptr();
    // SAFETY: the views are valid, outlive the call and are only read; X is read and freed under the same `common`.
    unsafe {
        let x = crate::SuiteSparseQR_C_backslash_default(&raw mut a_view, &raw mut b_view, cc);
        drop(held);
        read(x, cc)
    }
}

/// The minimum-norm solution as `SuiteSparseQR_min2norm` computes it for a wide matrix: `A^T P = Q R`, `x = Q R^{-T} P^T b`.
///
/// # Errors
/// As [`backslash`].
pub fn minimum_norm(a: &Columns, b: &[f64]) -> Result<Vec<f64>, i32> {
    let (mut common, mut a_view, mut b_view) = started(a, b)?;
    let (ordering, tolerance) = (crate::SPQR_ORDERING_DEFAULT, f64::from(crate::SPQR_DEFAULT_TOL));
    let held = blas::hold(1).ok_or(crate::CHOLMOD_OUT_OF_MEMORY)?;
    let cc = common.as_mut_ptr();
    // SAFETY: as in `backslash`; a step runs only if the step before succeeded, and everything is freed once.
    unsafe {
        let mut transposed = crate::cholmod_l_transpose(&raw mut a_view, 2, cc);
        let mut qr: *mut Factorization = null_mut();
        let (mut y, mut x) = (null_mut(), null_mut());
        if !transposed.is_null() {
            qr = crate::SuiteSparseQR_C_factorize(ordering, tolerance, transposed, cc);
        }
        if !qr.is_null() {
            y = crate::SuiteSparseQR_C_solve(crate::SPQR_RTX_EQUALS_ETB, qr, &raw mut b_view, cc);
        }
        if !y.is_null() {
            x = crate::SuiteSparseQR_C_qmult(crate::SPQR_QX, qr, y, cc);
        }
        crate::cholmod_l_free_dense(&raw mut y, cc);
        if !qr.is_null() {
            crate::SuiteSparseQR_C_free(&raw mut qr, cc);
        }
        crate::cholmod_l_free_sparse(&raw mut transposed, cc);
        drop(held);
        read(x, cc)
    }
}

fn started(a: &Columns, b: &[f64]) -> Result<(Common, cholmod_sparse, cholmod_dense), i32> {
    if b.len() != a.rows {
        return Err(crate::CHOLMOD_INVALID);
    }
    let common = Common::start().ok_or(crate::CHOLMOD_OUT_OF_MEMORY)?;
    let dense = cholmod_dense {
        nrow: b.len(),
        ncol: 1,
        nzmax: b.len(),
        d: b.len(),
        x: b.as_ptr().cast_mut().cast(),
        z: null_mut(),
        xtype: crate::CHOLMOD_REAL,
        dtype: crate::CHOLMOD_DOUBLE,
    };
    Ok((common, a.view(), dense))
}

/// Copies a vector and frees it.
///
/// # Safety
/// `x` is null or a dense real vector allocated with this `common`.
unsafe fn read(mut x: *mut cholmod_dense, common: *mut cholmod_common) -> Result<Vec<f64>, i32> {
    // SAFETY: the caller's promise.
    unsafe {
        if x.is_null() {
            return Err((*common).status);
        }
        let (data, length) = ((*x).x.cast::<f64>(), (*x).nrow);
        let copy = if length == 0 { Vec::new() } else { core::slice::from_raw_parts(data, length).to_vec() };
        crate::cholmod_l_free_dense(&raw mut x, common);
        Ok(copy)
    }
}
