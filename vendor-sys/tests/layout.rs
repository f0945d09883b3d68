//! `size_of::<T>()` in Rust = `sizeof(T)` in C, and the library loads, starts and finishes.
#![allow(unsafe_code, reason = "calls the library without a wrapper")]

use spqr_sys::{cholmod_common, cholmod_dense, cholmod_sparse};
use std::mem::{MaybeUninit, offset_of, size_of};
use std::path::Path;
use std::process::Command;

const PRINTS_SIZES: &str = "#include <stdio.h>\n#include <stddef.h>\n#include \"SuiteSparseQR_C.h\"\n\
    int main(void) { printf(\"%zu %zu %zu %zu %zu %zu\", sizeof(cholmod_common), sizeof(cholmod_sparse),\n\
    sizeof(cholmod_dense), sizeof(SuiteSparse_long), offsetof(cholmod_common, status),\n\
    offsetof(cholmod_common, SPQR_norm_E_fro)); return 0; }\n";

#[test]
fn structs_have_the_sizes_of_c() {
    let in_rust = [
        size_of::<cholmod_common>(),
        size_of::<cholmod_sparse>(),
        size_of::<cholmod_dense>(),
        size_of::<i64>(),
        offset_of!(cholmod_common, status),
        offset_of!(cholmod_common, SPQR_norm_E_fro),
    ];
    assert_eq!(in_rust.to_vec(), sizes_in_c(Path::new(env!("CARGO_TARGET_TMPDIR"))));
}

#[test]
fn the_library_is_the_one_of_the_headers() {
    let library = spqr_sys::version().expect("tests run where the crate was built");
    assert_eq!((library.major, library.minor), (spqr_sys::HEADERS.major, spqr_sys::HEADERS.minor));
}

#[test]
fn starts_and_finishes() {
    let mut common = MaybeUninit::<cholmod_common>::zeroed();
    // SAFETY: cholmod_l_start fills the struct, which stays where it is until cholmod_l_finish.
    let (started, status, finished) = unsafe {
        let started = spqr_sys::cholmod_l_start(common.as_mut_ptr());
        let status = (*common.as_ptr()).status;
        (started, status, spqr_sys::cholmod_l_finish(common.as_mut_ptr()))
    };
    assert_eq!((started, status, finished), (1, spqr_sys::CHOLMOD_OK, 1));
}

fn sizes_in_c(folder: &Path) -> Vec<usize> {
    let (source, program) = (folder.join("sizes.c"), folder.join("sizes"));
    std::fs::write(&source, PRINTS_SIZES).unwrap();
    let compiled = c_compiler().arg(&source).arg("-o").arg(&program).status().unwrap();
    assert!(compiled.success());
    let printed = Command::new(program).output().unwrap().stdout;
    String::from_utf8(printed).unwrap().split(' ').map(|size| size.parse().unwrap()).collect()
}

fn c_compiler() -> Command {
    let mut build = cc::Build::new();
    let target = env!("SPQR_TEST_TARGET");
    build.cargo_metadata(false).target(target).host(target).opt_level(0);
    build.includes(std::env::split_paths(env!("SPQR_TEST_INCLUDE")));
    build.get_compiler().to_command()
}
