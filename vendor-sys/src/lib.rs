//! `A P = Q R`: raw bindings to SuiteSparseQR's C interface, made from the headers found at build time.
//!
//! SuiteSparseQR is GPL-2.0-or-later, so a binary that links this crate is too; the code of this crate
//! itself is MIT OR Apache-2.0. No logic lives here beyond [`version`], [`blas`], [`memory`], [`solve`] and, with the feature
//! `tbb`, the task tree on oneTBB: `qless` wraps the calls safely.
//!
//! Searched in this order: the folders in `SUITESPARSE_INCLUDE_DIR` and `SUITESPARSE_LIB_DIR`, pkg-config,
//! the usual folders. With `DOCS_RS` set, a stub of the bindings stands in for the library.
#![allow(unsafe_code, reason = "bindings to a C library are unsafe by nature; qless holds the safe side")]

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
