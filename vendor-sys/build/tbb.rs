//! Compiles the task tree if oneTBB is installed and the version of SuiteSparseQR is the one that it was written for.

use std::path::PathBuf;

const CALLS_TBB: &str =
    "#include <tbb/task_arena.h>\nint main() { return tbb::task_arena(2).max_concurrency() < 0; }\n";
const NEEDS_RELEASE: &str = "#include \"SuiteSparseQR_definitions.h\"\n\
    #if SPQR_MAIN_VERSION != 2 || SPQR_SUB_VERSION != 1\n#error \"another release\"\n#endif\nint main() { return 0; }\n";

/// With another version of SuiteSparseQR it prints a warning and compiles no task tree.
pub fn compile(include: &[PathBuf]) -> Result<(), String> {
    println!("cargo::rerun-if-changed=cpp");
    if !compiles(include, "tbb_test.cpp", CALLS_TBB)? {
        return Err(
            "oneTBB is missing: tbb/task_arena.h does not compile; install it with `sudo apt-get install libtbb-dev`, \
            or build without it by leaving out `--features tbb`"
                .into(),
        );
    }
    if !compiles(include, "release_test.cpp", NEEDS_RELEASE)? {
        println!("cargo::warning=the task tree needs SuiteSparseQR 2.1; this version runs sequentially");
        return Ok(());
    }
    let mut build = builder(include);
    build.files(["cpp/tree.cpp", "cpp/result.cpp"]);
    if std::env::var_os("CARGO_FEATURE_FAULTS").is_some() {
        build.file("cpp/faults.cpp");
    }
    build.try_compile("qless_tree").map_err(|e| format!("the task tree: {e}"))?;
    println!("cargo::rustc-link-lib=tbb");
    println!("cargo::rustc-cfg=task_tree");
    Ok(())
}

fn compiles(include: &[PathBuf], name: &str, text: &str) -> Result<bool, String> {
    let source = PathBuf::from(std::env::var_os("OUT_DIR").unwrap_or_default()).join(name);
    std::fs::write(&source, text).map_err(|e| format!("the test of the compiler cannot be written: {e}"))?;
    let mut build = builder(include);
    build.cargo_metadata(false).cargo_warnings(false).file(&source);
    Ok(build.try_compile(name.trim_end_matches(".cpp")).is_ok())
}

fn builder(include: &[PathBuf]) -> cc::Build {
    let mut build = cc::Build::new();
    build.cpp(true).std("c++17").includes(include).warnings(false);
    build
}
