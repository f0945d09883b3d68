//! Ends the program when an allocation fails and the code cannot continue.
//!
//! `handle_alloc_error` aborts the process. The handler of `SIGABRT` then runs on the thread that failed. This thread is outside the
//! allocator and its locks, so the handler may do what ordinary code may. The handler allocates nothing; the removal of files may use the
//! [`reserve`](super::reserve).

use std::cell::Cell;
use std::fmt::Write;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering::SeqCst};
use std::time::Duration;

use super::{guard, refusal, system};
use crate::exit_code;

/// With less address space than this, all threads share one heap: a heap for each thread would leave too little for the model.
const SCARCE: usize = 2 << 30;

static CLEAN: OnceLock<fn()> = OnceLock::new();
static ENDING: AtomicBool = AtomicBool::new(false);

thread_local! {
    static ENDING_HERE: Cell<bool> = const { Cell::new(false) };
}

/// Call this first. If memory then runs out, the program writes an error, calls `clean`, and exits with 3.
///
/// `clean` removes temporary files. It must not wait for locks that the failed thread may hold. Its allocations may come from the
/// [`reserve`](super::reserve) while [`qless_io::write::is_at_work`].
pub fn on_out_of_memory(clean: fn()) {
    if system::address_space_allowed().is_some_and(|bytes| bytes < SCARCE) {
        system::share_heap();
    }
    CLEAN.get_or_init(|| clean);
    system::on_abort(end_of_abort);
    let other = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        // Some libraries panic if an allocation fails; such a panic ends the program like any lack of memory.
        if refusal::is_here() {
            end();
        }
        other(panic);
    }));
    #[cfg(feature = "faults")]
    super::faults::begin();
}

extern "C" fn end_of_abort(_: libc::c_int) {
    if refusal::is_here() {
        end();
    }
    // No allocation failed, so abort as usual.
    system::restore_abort();
}

fn end() -> ! {
    if ENDING_HERE.replace(true) {
        // Ending the program failed too, because the reserve was too small.
        system::exit(i32::from(exit_code::RESOURCE));
    }
    while ENDING.swap(true, SeqCst) {
        // Another thread is ending the program.
        std::thread::sleep(Duration::from_secs(1));
    }
    let mut line = OneLine { text: [0; 512], length: 0 };
    if let Some(refusal) = refusal::largest() {
        let _ = writeln!(line, "error: out of memory: {refusal}");
    }
    system::tell(&line.text[..line.length]);
    guard::lift();
    CLEAN.get().into_iter().for_each(|clean| clean());
    system::exit(i32::from(exit_code::RESOURCE));
}

/// Text of bounded length in a fixed buffer, so that writing it allocates nothing.
struct OneLine {
    text: [u8; 512],
    length: usize,
}

impl Write for OneLine {
    fn write_str(&mut self, more: &str) -> std::fmt::Result {
        let room = &mut self.text[self.length..];
        let count = more.len().min(room.len());
        room[..count].copy_from_slice(&more.as_bytes()[..count]);
        self.length += count;
        Ok(())
    }
}
