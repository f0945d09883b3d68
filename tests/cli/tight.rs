//! The build with SuiteSparseQR under a limit of address space ends with a proper exit code.

use std::process::{Command, Stdio};

use super::harness::Place;

/// The exit code with a limit in MiB, 124 after 20 seconds; BLAS settings of the environment are removed.
fn code(mebibytes: usize, arguments: &[&str]) -> i32 {
    let script = format!("ulimit -v {}; exec timeout 20 \"$@\"", mebibytes << 10);
    let mut run = Command::new("sh");
    run.args(["-c", &script, "sh", env!("CARGO_BIN_EXE_qless")]).args(arguments);
    run.env_remove("OPENBLAS_NUM_THREADS").stdout(Stdio::null()).stderr(Stdio::null());
    run.status().expect("a shell").code().expect("an end of its own")
}

/// When OpenBLAS is loaded, it would start a thread for each further core, which would never end without memory.
#[test]
fn no_blas_thread_is_started_for_what_needs_none() {
    assert_eq!(code(190, &["--version"]), 0);
}

/// OpenBLAS would retry for ever to allocate a buffer of 128 MiB.
#[test]
fn a_factorization_that_blas_has_no_memory_for_is_refused() {
    let place = Place::new();
    let case = place.path("rve").to_string_lossy().into_owned();
    assert_eq!(code(4096, &["generate", "rve", "--n", "4", "-o", &case]), 0);
    let check = ["check", &case, "--backend", "spqr", "--no-presolve", "--threads", "1"];
    assert_eq!(code(190, &check), 3);
    assert_eq!(code(1024, &check), 0);
}
