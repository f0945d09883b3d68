//! A shared library with SuiteSparseQR's task tree in it: `tests/tree.rs` calls it from a program in C.
#![allow(unsafe_code, reason = "exports one function to C")]

use qless::Csr;
use qless::backend::Backend;
use qless::backend::spqr::Spqr;

/// Factors a banded matrix on two threads; the number of task trees that ran.
#[unsafe(no_mangle)]
pub extern "C" fn example_trees() -> u64 {
    let mut columns = Csr::empty(2000);
    for j in 0..1500 {
        columns.push_row((0..6).map(|k| (j + 80 * k, 1.0 + ((j * 7 + k * 3) % 11) as f64))).expect("rows ascend");
    }
    let spqr = Spqr { small: 1.0, grain: 32.0, ..Spqr::on(2) };
    if spqr.factor(&columns, &[], 1e-10).is_err() { 0 } else { Spqr::trees() }
}
