//! Finds SuiteSparseQR, links it, and writes the bindings of the headers found to `OUT_DIR/bindings.rs`.
//!
//! `sizeof(cholmod_common)` changes between SuiteSparse releases, so bindings never ship with the crate.

#[path = "build/bindings.rs"]
mod bindings;
#[path = "build/probe.rs"]
mod probe;
#[path = "build/tbb.rs"]
mod tbb;

use std::path::{Path, PathBuf};
use std::{env, fs};

const HOW_TO_GO_ON: &str = "install it with `sudo apt-get install libsuitesparse-dev libopenblas-pthread-dev \
    libclang-dev`, or build without it by leaving out `--features spqr`";

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed=build");
    println!("cargo::rerun-if-env-changed=DOCS_RS");
    println!("cargo::rustc-check-cfg=cfg(task_tree, config_struct)");
    if let Err(missing) = write_bindings() {
        let advice = if missing.contains("apt-get") { String::new() } else { format!("; {HOW_TO_GO_ON}") };
        println!("cargo::error={}{advice}", missing.replace('\n', " "));
    }
}

fn write_bindings() -> Result<(), String> {
    let target = PathBuf::from(env::var_os("OUT_DIR").ok_or("OUT_DIR is not set: run this through cargo")?);
    let target = target.join("bindings.rs");
    if env::var_os("DOCS_RS").is_some() {
        return copy_stub(&target);
    }
    let include = probe::find_and_link()?;
    export_to_tests(&include);
    if has_config_struct(&include) {
        println!("cargo::rustc-cfg=config_struct");
    }
    if env::var_os("CARGO_FEATURE_TBB").is_some() {
        tbb::compile(&include)?;
    }
    bindings::generate(&include, &target)
}

/// SuiteSparse 5 has its allocation hooks in a public struct, later ones behind functions.
fn has_config_struct(include: &[PathBuf]) -> bool {
    let declares = |text: String| text.contains("extern struct SuiteSparse_config_struct SuiteSparse_config");
    include.iter().any(|folder| fs::read_to_string(folder.join("SuiteSparse_config.h")).is_ok_and(declares))
}

/// docs.rs has no SuiteSparse: the same names, good for documenting and type checking, never for linking.
fn copy_stub(target: &Path) -> Result<(), String> {
    fs::copy("build/docs_stub.rs", target).map(drop).map_err(|e| format!("the bindings' stub cannot be copied: {e}"))
}

/// `tests/layout.rs` compiles C against the same headers.
fn export_to_tests(include: &[PathBuf]) {
    let joined = env::join_paths(include).unwrap_or_default();
    println!("cargo::rustc-env=SPQR_TEST_INCLUDE={}", joined.to_string_lossy());
    println!("cargo::rustc-env=SPQR_TEST_TARGET={}", env::var("TARGET").unwrap_or_default());
}
