//! Raw bindings to the C interface of SuiteSparseQR (`A P = Q R`), generated from the installed headers at build time.
//!
//! SuiteSparseQR is GPL-2.0-or-later, and so is a binary that links this crate. The code of this crate itself is
//! MIT OR Apache-2.0. `qless` wraps the calls safely. Besides the bindings this crate has [`version`], [`blas`], [`memory`], [`solve`]
//! and, with the feature `tbb`, the task tree on oneTBB.
//!
//! The build script searches for the library in this order: the folders in `SUITESPARSE_INCLUDE_DIR` and `SUITESPARSE_LIB_DIR`,
//! pkg-config, the usual folders. If `DOCS_RS` is set, it uses a stub of the bindings and no library.
#![allow(unsafe_code, reason = "bindings to a C library are unsafe by nature; qless wraps them safely")]

pub mod blas;
#[cfg(interposition)]
mod guard;
pub mod memory;
pub mod solve;
pub mod tree;
mod version;

pub use bindings::*;
pub use version::{HEADERS, SPQR, Version, VersionMismatch, version};

#[allow(missing_docs, reason = "generated; the headers of SuiteSparse document these names")]
#[allow(non_camel_case_types, non_snake_case, non_upper_case_globals, reason = "C's own names")]
#[allow(dead_code, clippy::all, clippy::pedantic, reason = "generated")]
mod bindings {
    include!(concat!(env!("OUT_DIR"), "/bindings.rs"));
}
