//! The memory of a run: one limit for all of it, and an end in order where there is no more.
//!
//! Three lines of defence, from early to late:
//!
//! 1. **What can be foreseen is refused before it is tried.** A limit that the program itself does not fit in is refused at the start
//!    ([`limit`]). What the input leaves of it ([`left`]) goes to the library as [`qless::Options::memory`]: each factorization compares
//!    what it will allocate with that, or counts as it fills in, and refuses with an error that has both numbers.
//! 2. **Every allocation asks.** All of Rust's memory comes through [`Guard`]. With `--memory` it refuses what would go beyond the
//!    limit: the larger of the bytes handed out and of the resident pages, which also hold what C allocates, code and stacks. The
//!    system refuses beyond `ulimit -v`. Either way the caller gets null and [`refusal`] keeps both numbers. Code that can go
//!    on (`try_reserve`) returns an error, and [`crate::failure`] adds the numbers.
//! 3. **What cannot go on ends in order.** Code that cannot go on calls `handle_alloc_error`, which aborts; [`exit_report`] takes that signal,
//!    says what was needed and what was allowed, removes staged files, and exits with 3. Nothing unwinds.
//!
//! | module | holds |
//! | --- | --- |
//! | [`guard`] | the allocator: counts and refuses |
//! | [`refusal`] | the numbers of a refusal, in words |
//! | [`reserve`] | memory for what must not be cut off |
//! | [`exit_report`] | the end of a run that cannot go on |
//! | [`threads`] | as many threads as there is address space for |
//! | [`size`] | `8MiB` and how sizes are written |
//! | [`system`] | what the operating system tells and is told |
//! | `faults` | allocations that fail on purpose, for tests |
//!
//! The counts cost nothing without `--memory`: [`Guard`] then looks at one number that no thread changes.

mod exit_report;
#[cfg(feature = "faults")]
mod faults;
mod guard;
mod refusal;
mod reserve;
mod size;
mod system;
pub mod threads;

pub use exit_report::on_out_of_memory;
pub use guard::Guard;
use refusal::Refusal;
pub use size::{Size, parse};

/// Bytes that the smallest of runs takes after its start: code that is first used then, stacks, buffers of files.
const SMALLEST_RUN: usize = 4 << 20;

/// Bounds the memory of the whole run.
///
/// # Errors
/// What is needed and what is allowed, if the program itself does not fit.
pub fn limit(bytes: usize) -> Result<(), String> {
    system::give_back_early();
    let needed = system::resident() + SMALLEST_RUN;
    if needed > bytes {
        let (needed, bytes) = (Size(needed), Size(bytes));
        return Err(format!("the smallest of runs needs {needed} and --memory allows {bytes}: allow more"));
    }
    guard::limit(bytes);
    Ok(())
}

/// Bytes that may still be allocated; none without a limit.
pub fn left() -> Option<usize> {
    guard::left()
}

/// The largest refusal in this process; where it was not ours, what the system says now.
pub fn refusal() -> Refusal {
    refusal::largest().unwrap_or_else(|| Refusal::of_system(0))
}
