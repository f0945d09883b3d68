//! Calls of the C shims (`peers`).
#![allow(unsafe_code, reason = "calls into C; every block says why it is sound")]

use std::ffi::{CStr, c_char, c_int, c_void};
use std::{ptr, slice};

use qless::Csr;

/// Errors of a call.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum CallError {
    NoMemory,
    /// More rows, columns or entries than a C int counts.
    TooLarge,
    Failed(String),
}

/// The factorization `A P = Q R` of a sparse A.
#[derive(Debug)]
pub struct SparseFactor {
    pub order: Vec<usize>,
    /// R, rank x n.
    pub r: Csr,
    /// Seconds of the factorization, and of copying R and computing `Q^T B`.
    pub compute: f64,
    pub extract: f64,
}

/// The result of a factorization, as eigen.cpp declares it.
#[repr(C)]
struct RawFactor {
    rank: i64,
    entries: i64,
    order: *const c_int,
    start: *const c_int,
    column: *const c_int,
    value: *const f64,
    compute: f64,
    extract: f64,
    owner: *mut c_void,
    message: [c_char; 128],
}

impl Drop for RawFactor {
    fn drop(&mut self) {
        // SAFETY: `owner` is null or was made by qless_eigen_factor, and is freed here only.
        unsafe { qless_eigen_free(self) }
    }
}

const DONE: c_int = 0;
const NO_MEMORY: c_int = 1;

unsafe extern "C" {
    fn qless_eigen_factor(
        m: c_int,
        n: c_int,
        start: *const c_int,
        row: *const c_int,
        value: *const f64,
        k: c_int,
        rhs: *mut f64,
        threshold: f64,
        out: *mut RawFactor,
    ) -> c_int;
    fn qless_eigen_free(out: *mut RawFactor);
    fn qless_eigen_version() -> c_int;
    fn qless_lapack_factor(
        m: c_int,
        n: c_int,
        a: *mut f64,
        order: *mut c_int,
        tau: *mut f64,
        seconds: *mut f64,
    ) -> c_int;
    fn qless_lapack_apply(
        m: c_int,
        rank: c_int,
        a: *const f64,
        tau: *const f64,
        k: c_int,
        b: *mut f64,
        seconds: *mut f64,
    ) -> c_int;
}

/// Eigen's version as three numbers.
pub fn eigen_version() -> [i32; 3] {
    // SAFETY: reads constants.
    let version = unsafe { qless_eigen_version() };
    [version / 10_000, version / 100 % 100, version % 100]
}

/// Eigen's SparseQR of A (row j of `columns` is its column j, no row of A is empty); `rhs`, m x k, becomes `Q^T B`.
/// Without a threshold Eigen uses its own.
pub fn eigen(columns: &Csr, rhs: &mut [f64], threshold: Option<f64>) -> Result<SparseFactor, CallError> {
    let (m, n) = (columns.cols(), columns.rows());
    let k = rhs.len().checked_div(m).unwrap_or(0);
    assert_eq!(rhs.len(), m * k, "B is not m x k");
    let start: Vec<c_int> = columns.starts().iter().map(|&at| int(at)).collect::<Result<_, _>>()?;
    let row: Vec<c_int> = columns.columns().iter().map(|&i| int(i as usize)).collect::<Result<_, _>>()?;
    let (rows, cols, count, threshold) = (int(m)?, int(n)?, int(k)?, threshold.unwrap_or(-1.0));
    let mut out = RawFactor {
        rank: 0,
        entries: 0,
        order: ptr::null(),
        start: ptr::null(),
        column: ptr::null(),
        value: ptr::null(),
        compute: 0.0,
        extract: 0.0,
        owner: ptr::null_mut(),
        message: [0; 128],
    };
    // SAFETY: the lengths of all arrays follow from m, n, k and start[n], which was checked to be that of `row` when the
    // Csr was made; C writes into `rhs` and `out` only and keeps no pointer to them.
    let status = unsafe {
        let (start, row, value) = (start.as_ptr(), row.as_ptr(), columns.values().as_ptr());
        qless_eigen_factor(rows, cols, start, row, value, count, rhs.as_mut_ptr(), threshold, &raw mut out)
    };
    match status {
        DONE => Ok(read(&out, n)),
        NO_MEMORY => Err(CallError::NoMemory),
        // SAFETY: the shim ends the message with a zero, within its 128 characters.
        _ => Err(CallError::Failed(unsafe { CStr::from_ptr(out.message.as_ptr()) }.to_string_lossy().into_owned())),
    }
}

/// Copies the arrays that the shim returned.
fn read(out: &RawFactor, n: usize) -> SparseFactor {
    let (rank, entries) = (out.rank as usize, out.entries as usize);
    // SAFETY: after QLESS_DONE the arrays have these lengths and live until `out` is dropped.
    let (order, start, column, value) =
        unsafe { (part(out.order, n), part(out.start, rank + 1), part(out.column, entries), part(out.value, entries)) };
    let mut r = Csr::empty(n);
    for i in 0..rank {
        let row = start[i] as usize..start[i + 1] as usize;
        let entries = column[row.clone()].iter().map(|&j| j as usize).zip(value[row].iter().copied());
        r.push_row(entries.filter(|&(_, v)| v != 0.0)).expect("the shim sorts the columns of a row");
    }
    let order = order.iter().map(|&j| j as usize).collect();
    SparseFactor { order, r, compute: out.compute, extract: out.extract }
}

/// A slice of a C array; an empty one may be null.
///
/// # Safety
/// `data` points to `len` values that live and do not change for 'a.
unsafe fn part<'a, T>(data: *const T, len: usize) -> &'a [T] {
    // SAFETY: the caller guarantees it, as `# Safety` requires.
    if len == 0 { &[] } else { unsafe { slice::from_raw_parts(data, len) } }
}

/// Overwrites A, m x n by columns, with R and below it the reflectors of dgeqp3; returns P, the factors of the reflectors, and seconds.
pub fn geqp3(a: &mut [f64], m: usize, n: usize) -> Result<(Vec<usize>, Vec<f64>, f64), CallError> {
    assert_eq!(a.len(), m * n, "A is not m x n");
    let (mut order, mut tau, mut seconds) = (vec![0; n], vec![0.0; m.min(n)], 0.0);
    // SAFETY: A, order and tau have the lengths that LAPACK asks for, and it keeps no pointer to them.
    let status = unsafe {
        qless_lapack_factor(int(m)?, int(n)?, a.as_mut_ptr(), order.as_mut_ptr(), tau.as_mut_ptr(), &raw mut seconds)
    };
    done(status)?;
    Ok((order.iter().map(|&j: &c_int| j as usize - 1).collect(), tau, seconds))
}

/// `B <- Q^T B` with the first `rank` reflectors of [`geqp3`]; returns seconds.
pub fn apply(a: &[f64], m: usize, rank: usize, tau: &[f64], b: &mut [f64]) -> Result<f64, CallError> {
    let k = b.len().checked_div(m).unwrap_or(0);
    assert!(b.len() == m * k && a.len() >= m * rank && tau.len() >= rank, "B is not m x k, or A is too small");
    if rank == 0 || k == 0 {
        return Ok(0.0);
    }
    let mut seconds = 0.0;
    // SAFETY: the lengths are checked above; LAPACK writes into `b` only and keeps no pointer.
    let status = unsafe {
        qless_lapack_apply(int(m)?, int(rank)?, a.as_ptr(), tau.as_ptr(), int(k)?, b.as_mut_ptr(), &raw mut seconds)
    };
    done(status).map(|()| seconds)
}

fn done(status: c_int) -> Result<(), CallError> {
    match status {
        DONE => Ok(()),
        NO_MEMORY => Err(CallError::NoMemory),
        _ => Err(CallError::Failed("LAPACK calls an argument invalid".to_owned())),
    }
}

fn int(value: usize) -> Result<c_int, CallError> {
    c_int::try_from(value).map_err(|_| CallError::TooLarge)
}
