//! Memory that stays in the process from one round to the next.
//!
//! By its own rule glibc gives large arrays back to the kernel, which then fills page after page with zeros for the next: a cost
//! of large systems alone, as small arrays are kept. `-- --fresh` leaves glibc its rule.

use std::process::{Command, ExitCode};

/// Settings of glibc by which freed memory stays in the process.
const KEPT: &str =
    "glibc.malloc.mmap_threshold=8000000000:glibc.malloc.trim_threshold=32000000000:glibc.malloc.top_pad=3000000000";

/// Runs this program again with memory kept, and there `run`: glibc reads its settings at the start alone.
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
