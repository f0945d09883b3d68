//! Searches for the library: environment variables, then pkg-config, then the usual folders with a link test.

use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::{env, fs};

/// Debian and Fedora install the headers in a folder of their own; others do not.
const USUAL_INCLUDES: [&str; 6] = [
    "/usr/include/suitesparse",
    "/usr/local/include/suitesparse",
    "/opt/homebrew/include/suitesparse",
    "/usr/include",
    "/usr/local/include",
    "/opt/homebrew/include",
];
const USUAL_LIBS: [&str; 2] = ["/usr/local/lib", "/opt/homebrew/lib"];
const LIBRARIES: [&str; 3] = ["spqr", "cholmod", "suitesparseconfig"];
const HEADER: &str = "SuiteSparseQR_C.h";

const CALLS_EVERY_LIBRARY: &str = "#include \"SuiteSparseQR_C.h\"\n\
    int main(void) { void *f[3] = {(void *) SuiteSparseQR_C, (void *) cholmod_l_start, (void *) SuiteSparse_version};\n\
    return f[0] == f[1] && f[1] == f[2]; }\n";

/// Passes the libraries to cargo and returns the folders of the headers.
pub fn find_and_link() -> Result<Vec<PathBuf>, String> {
    println!("cargo::rerun-if-env-changed=SUITESPARSE_INCLUDE_DIR");
    println!("cargo::rerun-if-env-changed=SUITESPARSE_LIB_DIR");
    let include = env::var_os("SUITESPARSE_INCLUDE_DIR").map(PathBuf::from);
    let lib = env::var_os("SUITESPARSE_LIB_DIR").map(PathBuf::from);
    if include.is_some() || lib.is_some() {
        return from_environment(include, lib);
    }
    if let Some(include) = from_pkg_config() {
        return Ok(include);
    }
    from_usual_folders(&existing(&USUAL_INCLUDES), &existing(&USUAL_LIBS))
}

/// A folder that the user named is used, or it is an error.
fn from_environment(include: Option<PathBuf>, lib: Option<PathBuf>) -> Result<Vec<PathBuf>, String> {
    let includes = include.map_or_else(|| existing(&USUAL_INCLUDES), |folder| vec![folder]);
    let libs = lib.map_or_else(|| existing(&USUAL_LIBS), |folder| vec![folder]);
    from_usual_folders(&includes, &libs)
        .map_err(|why| format!("SUITESPARSE_INCLUDE_DIR or SUITESPARSE_LIB_DIR is set, but {why}"))
}

/// SuiteSparse 7 and newer install these files; Debian 12's 5.12 has none.
fn from_pkg_config() -> Option<Vec<PathBuf>> {
    let mut include = Vec::new();
    for name in ["SPQR", "CHOLMOD", "SuiteSparse_config"] {
        // The libraries go to cargo only if all three exist.
        include.extend(pkg_config::Config::new().cargo_metadata(false).probe(name).ok()?.include_paths);
    }
    for name in ["SPQR", "CHOLMOD", "SuiteSparse_config"] {
        pkg_config::Config::new().probe(name).ok()?;
    }
    Some(include)
}

fn from_usual_folders(includes: &[PathBuf], libs: &[PathBuf]) -> Result<Vec<PathBuf>, String> {
    let include = includes
        .iter()
        .find(|folder| folder.join(HEADER).exists())
        .ok_or_else(|| format!("SuiteSparseQR is missing: there is no {HEADER} in {}", listed(includes)))?;
    link_test(include, libs)?;
    for folder in libs {
        println!("cargo::rustc-link-search=native={}", folder.display());
    }
    for library in LIBRARIES {
        println!("cargo::rustc-link-lib={library}");
    }
    Ok(vec![include.clone()])
}

/// Without this test, a header without its library would fail much later, with an error of the linker.
fn link_test(include: &Path, libs: &[PathBuf]) -> Result<(), String> {
    let out = PathBuf::from(env::var_os("OUT_DIR").unwrap_or_default());
    let source = out.join("link_test.c");
    fs::write(&source, CALLS_EVERY_LIBRARY).map_err(|e| format!("the link test cannot be written: {e}"))?;
    let mut compiler = cc::Build::new()
        .cargo_metadata(false)
        .include(include)
        .try_get_compiler()
        .map_err(|e| format!("no C compiler for the link test: {e}"))?
        .to_command();
    compiler.arg(&source).arg("-o").arg(out.join("link_test"));
    compiler.args(libs.iter().map(|folder| format!("-L{}", folder.display())));
    compiler.args(LIBRARIES.map(|library| format!("-l{library}")));
    let linked = compiler.stderr(Stdio::null()).status().is_ok_and(|status| status.success());
    linked.then_some(()).ok_or_else(|| {
        format!("SuiteSparseQR is missing: {} has its headers, but -lspqr -lcholmod do not link", include.display())
    })
}

fn existing(folders: &[&str]) -> Vec<PathBuf> {
    folders.iter().map(PathBuf::from).filter(|folder| folder.is_dir()).collect()
}

fn listed(folders: &[PathBuf]) -> String {
    folders.iter().map(|folder| folder.display().to_string()).collect::<Vec<_>>().join(", ")
}
