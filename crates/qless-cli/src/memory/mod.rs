//! Limits the memory of a run, and ends it cleanly if memory runs out.
//!
//! There are three lines of defence, from early to late:
//!
//! 1. **Predicted needs are checked first.** [`limit`] refuses a limit that is too small for the program itself. The memory that remains
//!    after reading the input ([`remaining`]) becomes [`qless::Options::memory`]: each factorization compares its predicted size with this
//!    limit, or checks its size while it fills in, and returns an error with both numbers.
//! 2. **Every allocation is checked.** Rust allocates through [`Guard`], which enforces `--memory`; the system enforces `ulimit -v`. In
//!    both cases the caller gets null, and [`refusal`] records the needed and the allowed bytes. Code that can continue
//!    (`try_reserve`) returns an error, and [`crate::failure`] adds the numbers.
//! 3. **Code that cannot continue ends the program.** It calls `handle_alloc_error`, which aborts. [`exit_report`] handles the signal:
//!    it writes the needed and the allowed bytes, removes staged files, and exits with 3. Nothing unwinds.
//!
//! | module | holds |
//! | --- | --- |
//! | [`guard`] | the allocator: counts and refuses |
//! | [`refusal`] | the numbers of a refusal, in words |
//! | [`reserve`] | memory for operations that must complete |
//! | [`exit_report`] | the end of a run that cannot continue |
//! | [`threads`] | as many threads as the address space allows |
//! | [`size`] | parses and writes sizes, such as `8MiB` |
//! | [`system`] | calls of the operating system |
//! | `faults` | allocations that fail on purpose, for tests |
//!
//! Without `--memory` the counts cost nothing: [`Guard`] then reads one number that no thread changes.

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
pub use guard::{Guard, remaining};
use refusal::Refusal;
pub use size::{Size, parse};

/// Bytes that the smallest run needs after its start: code pages, stacks, file buffers.
const SMALLEST_RUN: usize = 4 << 20;

/// Limits the memory of the whole run.
///
/// # Errors
/// The needed and the allowed bytes, if the program itself needs more.
pub fn limit(bytes: usize) -> Result<(), String> {
    system::give_back_early();
    let needed = system::resident() + SMALLEST_RUN;
    if needed > bytes {
        let (needed, bytes) = (Size(needed), Size(bytes));
        return Err(format!("the smallest run needs {needed} and --memory allows {bytes}: allow more"));
    }
    guard::limit(bytes);
    Ok(())
}

/// The largest refused allocation in this process; if none was recorded, the system's current numbers.
pub fn refusal() -> Refusal {
    refusal::largest().unwrap_or_else(|| Refusal::of_system(0))
}
