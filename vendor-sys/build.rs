//! Finds SuiteSparseQR, links it, and writes the bindings of the headers found to `OUT_DIR/bindings.rs`.
//!
//! `sizeof(cholmod_common)` differs between releases of SuiteSparse, so the crate contains no bindings.

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
    println!("cargo::rustc-check-cfg=cfg(task_tree, interposition)");
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
    if calls_go_through_the_dynamic_linker() {
        println!("cargo::rustc-cfg=interposition");
    }
    if env::var_os("CARGO_FEATURE_TBB").is_some() {
        tbb::compile(&include)?;
    }
    bindings::generate(&include, &target)
}

/// True with ELF: a function of the program replaces the library's function of the same name.
fn calls_go_through_the_dynamic_linker() -> bool {
    let target = |what: &str| env::var(format!("CARGO_CFG_TARGET_{what}")).unwrap_or_default();
    target("FAMILY") == "unix" && target("VENDOR") != "apple"
}

/// docs.rs has no SuiteSparse. The stub has the same names, for documentation and type checks, and cannot be linked.
fn copy_stub(target: &Path) -> Result<(), String> {
    fs::copy("build/docs_stub.rs", target).map(drop).map_err(|e| format!("the bindings' stub cannot be copied: {e}"))
}

/// `tests/layout.rs` compiles C against the same headers.
fn export_to_tests(include: &[PathBuf]) {
    let joined = env::join_paths(include).unwrap_or_default();
    println!("cargo::rustc-env=SPQR_TEST_INCLUDE={}", joined.to_string_lossy());
    println!("cargo::rustc-env=SPQR_TEST_TARGET={}", env::var("TARGET").unwrap_or_default());
}
