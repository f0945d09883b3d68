//! ThreadSanitizer on the task tree: several concurrent callers, each with a tree on two threads.
//!
//! oneTBB and SuiteSparseQR are not compiled for it. It cannot see their synchronization and reports races there too, so a report
//! counts only if both accesses are in our own code.

use std::path::Path;
use std::process::Command;

const SOURCES: [&str; 3] = ["tests/tsan.cpp", "cpp/tree.cpp", "cpp/result.cpp"];
/// Our files, as the frames of a report name them.
const OURS: [&str; 3] = ["cpp/tree.cpp", "cpp/result.cpp", "cpp/threads.hpp"];

#[test]
fn the_sanitizer_finds_no_race_in_the_task_tree() {
    let program = Path::new(env!("CARGO_TARGET_TMPDIR")).join("tsan");
    let mut compiler = Command::new("c++");
    compiler.args(["-std=c++17", "-g", "-O1", "-fsanitize=thread"]).args(SOURCES).arg("-o").arg(&program);
    compiler.args(std::env::split_paths(env!("SPQR_TEST_INCLUDE")).map(|folder| format!("-I{}", folder.display())));
    compiler.args(["-lspqr", "-lcholmod", "-lsuitesparseconfig", "-ltbb", "-ldl", "-lpthread"]);
    assert!(compiler.status().expect("a C++ compiler").success());
    // The sanitizer's runtime does not support every memory layout that the kernel may choose.
    let mut run = Command::new("setarch");
    let output = run.arg("-R").arg(&program).env("OPENBLAS_NUM_THREADS", "1").output().expect("setarch");
    let (text, reports) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    if reports.contains("failed to set personality") || reports.contains("unexpected memory mapping") {
        // Only an explicit request skips the test.
        let is_known = std::env::var_os("SPQR_WITHOUT_TSAN").is_some();
        return assert!(is_known, "ThreadSanitizer cannot run here; SPQR_WITHOUT_TSAN=1 skips this test: {reports}");
    }
    assert!(text.contains("20 trees, 20 copies of R, ranks as expected"), "{text}{reports}");
    let ours: Vec<&str> = reports.split("WARNING: ").skip(1).filter(|report| is_ours(report)).collect();
    assert!(ours.is_empty(), "{}", ours.join("\n"));
}

/// Whether both accesses are in our own files, possibly through the standard library.
fn is_ours(report: &str) -> bool {
    let accesses = report.split("\n\n").take(2);
    let is_own = |access: &str| {
        let mut frames = access.lines().filter(|line| line.trim_start().starts_with('#'));
        let maker = frames.find(|frame| !frame.contains("/c++/") && !frame.contains("libsanitizer"));
        maker.is_some_and(|frame| OURS.iter().any(|file| frame.contains(file)))
    };
    accesses.filter(|access| is_own(access)).count() == 2
}
