// Replaces the bindings if SuiteSparse is not installed (docs.rs). Sizes and versions are not real.
use core::ffi::{c_char, c_int, c_void};

pub const CHOLMOD_OK: i32 = 0;
pub const CHOLMOD_NOT_INSTALLED: i32 = -1;
pub const CHOLMOD_OUT_OF_MEMORY: i32 = -2;
pub const CHOLMOD_TOO_LARGE: i32 = -3;
pub const CHOLMOD_INVALID: i32 = -4;
pub const CHOLMOD_GPU_PROBLEM: i32 = -5;
pub const CHOLMOD_LONG: i32 = 2;
pub const CHOLMOD_REAL: i32 = 1;
pub const CHOLMOD_DOUBLE: i32 = 0;
pub const SPQR_ORDERING_DEFAULT: i32 = 7;
pub const SPQR_DEFAULT_TOL: i32 = -2;
pub const SPQR_RTX_EQUALS_ETB: i32 = 3;
pub const SPQR_QX: i32 = 1;
pub const SPQR_MAIN_VERSION: i32 = 0;
pub const SPQR_SUB_VERSION: i32 = 0;
pub const SPQR_SUBSUB_VERSION: i32 = 0;
pub const SUITESPARSE_MAIN_VERSION: i32 = 0;
pub const SUITESPARSE_SUB_VERSION: i32 = 0;
pub const SUITESPARSE_SUBSUB_VERSION: i32 = 0;

#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct cholmod_common {
    pub print: c_int,
    pub error_handler: Option<unsafe extern "C" fn(c_int, *const c_char, c_int, *const c_char)>,
    pub status: c_int,
    pub malloc_count: usize,
    pub memory_usage: usize,
    pub SPQR_grain: f64,
    pub SPQR_small: f64,
    pub SPQR_analyze_time: f64,
    pub SPQR_factorize_time: f64,
    pub SPQR_norm_E_fro: f64,
    pub SPQR_istat: [i64; 10],
}

#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct cholmod_sparse {
    pub nrow: usize,
    pub ncol: usize,
    pub nzmax: usize,
    pub p: *mut c_void,
    pub i: *mut c_void,
    pub nz: *mut c_void,
    pub x: *mut c_void,
    pub z: *mut c_void,
    pub stype: c_int,
    pub itype: c_int,
    pub xtype: c_int,
    pub dtype: c_int,
    pub sorted: c_int,
    pub packed: c_int,
}

#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct cholmod_dense {
    pub nrow: usize,
    pub ncol: usize,
    pub nzmax: usize,
    pub d: usize,
    pub x: *mut c_void,
    pub z: *mut c_void,
    pub xtype: c_int,
    pub dtype: c_int,
}

#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct SuiteSparseQR_C_factorization {
    pub xtype: c_int,
    pub factors: *mut c_void,
}

unsafe extern "C" {
    pub fn cholmod_l_transpose(A: *mut cholmod_sparse, values: c_int, cc: *mut cholmod_common) -> *mut cholmod_sparse;
    pub fn SuiteSparseQR_C_backslash_default(
        A: *mut cholmod_sparse,
        B: *mut cholmod_dense,
        cc: *mut cholmod_common,
    ) -> *mut cholmod_dense;
    pub fn SuiteSparseQR_C_factorize(
        ordering: c_int,
        tol: f64,
        A: *mut cholmod_sparse,
        cc: *mut cholmod_common,
    ) -> *mut SuiteSparseQR_C_factorization;
    pub fn SuiteSparseQR_C_solve(
        system: c_int,
        QR: *mut SuiteSparseQR_C_factorization,
        B: *mut cholmod_dense,
        cc: *mut cholmod_common,
    ) -> *mut cholmod_dense;
    pub fn SuiteSparseQR_C_qmult(
        method: c_int,
        QR: *mut SuiteSparseQR_C_factorization,
        X: *mut cholmod_dense,
        cc: *mut cholmod_common,
    ) -> *mut cholmod_dense;
    pub fn SuiteSparseQR_C_free(QR: *mut *mut SuiteSparseQR_C_factorization, cc: *mut cholmod_common) -> c_int;
    pub fn SuiteSparse_version(version: *mut c_int) -> c_int;
    pub fn cholmod_l_start(common: *mut cholmod_common) -> c_int;
    pub fn cholmod_l_finish(common: *mut cholmod_common) -> c_int;
    pub fn cholmod_l_free(n: usize, size: usize, p: *mut c_void, common: *mut cholmod_common) -> *mut c_void;
    pub fn cholmod_l_free_sparse(a: *mut *mut cholmod_sparse, common: *mut cholmod_common) -> c_int;
    pub fn cholmod_l_free_dense(x: *mut *mut cholmod_dense, common: *mut cholmod_common) -> c_int;
    pub fn SuiteSparseQR_C(
        ordering: c_int,
        tol: f64,
        econ: i64,
        getCTX: c_int,
        A: *mut cholmod_sparse,
        Bsparse: *mut cholmod_sparse,
        Bdense: *mut cholmod_dense,
        Zsparse: *mut *mut cholmod_sparse,
        Zdense: *mut *mut cholmod_dense,
        R: *mut *mut cholmod_sparse,
        E: *mut *mut i64,
        H: *mut *mut cholmod_sparse,
        HPinv: *mut *mut i64,
        HTau: *mut *mut cholmod_dense,
        cc: *mut cholmod_common,
    ) -> i64;
}
