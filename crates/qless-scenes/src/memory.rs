//! Keeps freed memory in the process between the rounds of a benchmark.
//!
//! By default glibc returns large arrays to the kernel, and the kernel must zero every page of the next one. Small arrays are kept, so
//! only large systems pay for this. The argument `--fresh` keeps glibc's default.

use std::process::{Command, ExitCode};

/// Settings of glibc that keep freed memory in the process.
const KEPT: &str =
    "glibc.malloc.mmap_threshold=8000000000:glibc.malloc.trim_threshold=32000000000:glibc.malloc.top_pad=3000000000";

/// Starts this program again with `GLIBC_TUNABLES` set, because glibc reads its settings only at the start, and calls `run` there.
pub fn kept(run: fn()) -> ExitCode {
    const NAME: &str = "GLIBC_TUNABLES";
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if arguments.iter().any(|argument| argument == "--fresh") || std::env::var_os(NAME).is_some() {
        run();
        return ExitCode::SUCCESS;
    }
    let again = std::env::current_exe().expect("a program");
    let status = Command::new(again).args(arguments).env(NAME, KEPT).status().expect("runs again");
    if status.success() { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
