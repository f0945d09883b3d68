//! Sizes, field offsets, constants and signatures are those of the installed headers; the library loads, starts and finishes.
#![allow(unsafe_code, reason = "calls the library without a wrapper")]

use spqr_sys::{cholmod_common, cholmod_dense, cholmod_sparse};
use std::ffi::{c_int, c_void};
use std::mem::{MaybeUninit, offset_of, size_of};
use std::path::Path;
use std::process::Command;

/// C expressions: sizes, then offsets of the fields that are used, then constants, then comparisons of function types.
const QUESTIONS: [&str; 38] = [
    "sizeof(cholmod_common)",
    "sizeof(cholmod_sparse)",
    "sizeof(cholmod_dense)",
    "sizeof(SuiteSparse_long)",
    "offsetof(cholmod_common, print)",
    "offsetof(cholmod_common, status)",
    "offsetof(cholmod_common, error_handler)",
    "offsetof(cholmod_common, malloc_count)",
    "offsetof(cholmod_common, memory_usage)",
    "offsetof(cholmod_common, SPQR_grain)",
    "offsetof(cholmod_common, SPQR_small)",
    "offsetof(cholmod_common, SPQR_analyze_time)",
    "offsetof(cholmod_common, SPQR_factorize_time)",
    "offsetof(cholmod_common, SPQR_norm_E_fro)",
    "offsetof(cholmod_common, SPQR_istat)",
    "offsetof(cholmod_sparse, p)",
    "offsetof(cholmod_sparse, packed)",
    "offsetof(cholmod_dense, x)",
    "offsetof(cholmod_dense, dtype)",
    "CHOLMOD_OK",
    "CHOLMOD_NOT_INSTALLED",
    "CHOLMOD_OUT_OF_MEMORY",
    "CHOLMOD_TOO_LARGE",
    "CHOLMOD_INVALID",
    "CHOLMOD_LONG",
    "CHOLMOD_REAL",
    "CHOLMOD_DOUBLE",
    "SPQR_ORDERING_DEFAULT",
    "SPQR_MAIN_VERSION",
    "SUITESPARSE_MAIN_VERSION",
    "SAME(SuiteSparseQR_C, L (*)(int, double, L, int, cholmod_sparse *, cholmod_sparse *, cholmod_dense *, \
        cholmod_sparse **, cholmod_dense **, cholmod_sparse **, L **, cholmod_sparse **, L **, cholmod_dense **, cholmod_common *))",
    "SAME(cholmod_l_start, int (*)(cholmod_common *))",
    "SAME(cholmod_l_finish, int (*)(cholmod_common *))",
    "SAME(cholmod_l_free, void *(*)(size_t, size_t, void *, cholmod_common *))",
    "SAME(cholmod_l_malloc, void *(*)(size_t, size_t, cholmod_common *))",
    "SAME(cholmod_l_calloc, void *(*)(size_t, size_t, cholmod_common *))",
    "SAME(cholmod_l_realloc, void *(*)(size_t, size_t, void *, size_t *, cholmod_common *))",
    "SAME(cholmod_l_free_sparse, int (*)(cholmod_sparse **, cholmod_common *))",
];

/// The compiler checks the same types in Rust; `guard.rs` states those of the functions that it replaces.
fn signatures() {
    type Sparse = *mut cholmod_sparse;
    type Dense = *mut cholmod_dense;
    type Common = *mut cholmod_common;
    let _: unsafe extern "C" fn(
        c_int,
        f64,
        i64,
        c_int,
        Sparse,
        Sparse,
        Dense,
        *mut Sparse,
        *mut Dense,
        *mut Sparse,
        *mut *mut i64,
        *mut Sparse,
        *mut *mut i64,
        *mut Dense,
        Common,
    ) -> i64 = spqr_sys::SuiteSparseQR_C;
    let _: [unsafe extern "C" fn(Common) -> c_int; 2] = [spqr_sys::cholmod_l_start, spqr_sys::cholmod_l_finish];
    let _: unsafe extern "C" fn(usize, usize, *mut c_void, Common) -> *mut c_void = spqr_sys::cholmod_l_free;
    let _: unsafe extern "C" fn(*mut Sparse, Common) -> c_int = spqr_sys::cholmod_l_free_sparse;
}

#[test]
fn bindings_are_those_of_the_installed_headers() {
    signatures();
    let places = [
        size_of::<cholmod_common>(),
        size_of::<cholmod_sparse>(),
        size_of::<cholmod_dense>(),
        size_of::<i64>(),
        offset_of!(cholmod_common, print),
        offset_of!(cholmod_common, status),
        offset_of!(cholmod_common, error_handler),
        offset_of!(cholmod_common, malloc_count),
        offset_of!(cholmod_common, memory_usage),
        offset_of!(cholmod_common, SPQR_grain),
        offset_of!(cholmod_common, SPQR_small),
        offset_of!(cholmod_common, SPQR_analyze_time),
        offset_of!(cholmod_common, SPQR_factorize_time),
        offset_of!(cholmod_common, SPQR_norm_E_fro),
        offset_of!(cholmod_common, SPQR_istat),
        offset_of!(cholmod_sparse, p),
        offset_of!(cholmod_sparse, packed),
        offset_of!(cholmod_dense, x),
        offset_of!(cholmod_dense, dtype),
    ];
    let constants = [
        spqr_sys::CHOLMOD_OK,
        spqr_sys::CHOLMOD_NOT_INSTALLED,
        spqr_sys::CHOLMOD_OUT_OF_MEMORY,
        spqr_sys::CHOLMOD_TOO_LARGE,
        spqr_sys::CHOLMOD_INVALID,
        spqr_sys::CHOLMOD_LONG,
        spqr_sys::CHOLMOD_REAL,
        spqr_sys::CHOLMOD_DOUBLE,
        spqr_sys::SPQR_ORDERING_DEFAULT,
        spqr_sys::SPQR_MAIN_VERSION,
        spqr_sys::SUITESPARSE_MAIN_VERSION,
    ];
    let in_rust = places.iter().map(|&place| place as i64).chain(constants.map(i64::from)).chain([1; 8]);
    let in_c = answers(Path::new(env!("CARGO_TARGET_TMPDIR")));
    let in_rust: Vec<i64> = in_rust.collect();
    assert_eq!((in_rust.len(), in_c.len()), (QUESTIONS.len(), QUESTIONS.len()));
    for ((question, rust), c) in QUESTIONS.iter().zip(in_rust).zip(in_c) {
        assert_eq!(rust, c, "{question}");
    }
}

#[test]
fn the_library_is_the_one_of_the_headers() {
    let library = spqr_sys::version().expect("tests run where the crate was built");
    assert_eq!((library.major, library.minor), (spqr_sys::HEADERS.major, spqr_sys::HEADERS.minor));
}

#[test]
fn starts_and_finishes() {
    let mut common = MaybeUninit::<cholmod_common>::zeroed();
    // SAFETY: cholmod_l_start initializes the struct, which does not move until cholmod_l_finish.
    let (started, status, finished) = unsafe {
        let started = spqr_sys::cholmod_l_start(common.as_mut_ptr());
        let status = (*common.as_ptr()).status;
        (started, status, spqr_sys::cholmod_l_finish(common.as_mut_ptr()))
    };
    assert_eq!((started, status, finished), (1, spqr_sys::CHOLMOD_OK, 1));
}

/// The values of the expressions in C.
fn answers(folder: &Path) -> Vec<i64> {
    let (source, program) = (folder.join("questions.c"), folder.join("questions"));
    let line = |question: &str| format!("    printf(\"%ld\\n\", (long) {question});\n");
    let lines = QUESTIONS.map(line).concat();
    let text = format!(
        "#include <stdio.h>\n#include <stddef.h>\n#include \"SuiteSparseQR_C.h\"\n#define L SuiteSparse_long\n\
         #define SAME(f, type) __builtin_types_compatible_p(__typeof__(&f), type)\nint main(void) {{\n{lines}    return 0; }}\n"
    );
    std::fs::write(&source, text).unwrap();
    let compiled = c_compiler().arg(&source).arg("-o").arg(&program).status().unwrap();
    assert!(compiled.success());
    let printed = String::from_utf8(Command::new(program).output().unwrap().stdout).unwrap();
    printed.lines().map(|answer| answer.parse().unwrap()).collect()
}

fn c_compiler() -> Command {
    let mut build = cc::Build::new();
    let target = env!("SPQR_TEST_TARGET");
    build.cargo_metadata(false).target(target).host(target).opt_level(0);
    build.includes(std::env::split_paths(env!("SPQR_TEST_INCLUDE")));
    build.get_compiler().to_command()
}
