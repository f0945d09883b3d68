//! Generates bindings of the functions that `qless` calls, by bindgen from the installed headers.

use std::panic::{catch_unwind, set_hook, take_hook};
use std::path::{Path, PathBuf};

const FUNCTIONS: &str = "SuiteSparseQR_C(_backslash_default|_factorize|_solve|_qmult|_free)?|\
    cholmod_l_(start|finish|free|free_sparse|free_dense|transpose)|SuiteSparse_version";
const CONSTANTS: &str = "CHOLMOD_(OK|NOT_INSTALLED|OUT_OF_MEMORY|TOO_LARGE|INVALID|GPU_PROBLEM|LONG|REAL|DOUBLE)|\
    SPQR_(ORDERING_DEFAULT|DEFAULT_TOL|RTX_EQUALS_ETB|QX)|(SPQR|SUITESPARSE)_(MAIN|SUB|SUBSUB)_VERSION";

/// Writes the bindings to `target`. A missing libclang is an error, not a panic.
pub fn generate(include: &[PathBuf], target: &Path) -> Result<(), String> {
    let bindings =
        quietly(|| builder(include).generate().map_err(|e| format!("bindgen cannot read the headers: {e}")))?;
    bindings.write_to_file(target).map_err(|e| format!("the bindings cannot be written: {e}"))
}

fn builder(include: &[PathBuf]) -> bindgen::Builder {
    bindgen::Builder::default()
        .header_contents("spqr_sys.h", "#include \"SuiteSparseQR_C.h\"\n")
        .clang_args(include.iter().map(|folder| format!("-I{}", folder.display())))
        .allowlist_function(FUNCTIONS)
        .allowlist_var(CONSTANTS)
        .default_macro_constant_type(bindgen::MacroTypeVariation::Signed)
        .rust_edition(bindgen::RustEdition::Edition2024)
        .use_core()
        .generate_comments(false)
        .formatter(bindgen::Formatter::None)
        .parse_callbacks(Box::new(bindgen::CargoCallbacks::new()))
}

/// bindgen panics if it cannot load libclang: returns the first line of the panic as an error, without a backtrace.
fn quietly<T>(work: impl FnOnce() -> Result<T, String> + std::panic::UnwindSafe) -> Result<T, String> {
    let hook = take_hook();
    set_hook(Box::new(|_| {}));
    let outcome = catch_unwind(work);
    set_hook(hook);
    outcome.unwrap_or_else(|panic| Err(in_plain_words(panic.downcast_ref::<String>().map_or("", String::as_str))))
}

fn in_plain_words(panic: &str) -> String {
    if panic.contains("libclang") {
        return "libclang is missing, which reads the headers of SuiteSparseQR (LIBCLANG_PATH may name its folder)"
            .into();
    }
    format!("bindgen failed on the headers of SuiteSparseQR: {}", panic.lines().next().unwrap_or("no reason given"))
}
