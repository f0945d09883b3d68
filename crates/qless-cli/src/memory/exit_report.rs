//! The end of a run that got no memory and cannot go on.
//!
//! `handle_alloc_error` aborts, and the signal comes on the thread that failed, outside of the allocator and of its locks: so
//! the handler may do what ordinary code may. It allocates nothing; what removes files has [`super::reserve`].

use std::cell::Cell;
use std::fmt::Write;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering::SeqCst};
use std::time::Duration;

use super::{guard, refusal, system};
use crate::exit_code;

/// Below this much address space each thread's own heap would take what the model needs.
const SCARCE: usize = 2 << 30;

static CLEAN: OnceLock<fn()> = OnceLock::new();
static ENDING: AtomicBool = AtomicBool::new(false);

thread_local! {
    static ENDING_HERE: Cell<bool> = const { Cell::new(false) };
}

/// At the start: from now on a run that cannot go on without memory says so, calls `clean`, and exits with 3.
///
/// `clean` removes what must not stay behind. It must not wait for what the thread that failed may hold. What it allocates comes from
/// the [`reserve`](super::reserve) if need be, if it counts as [`qless_io::write::is_at_work`].
pub fn on_out_of_memory(clean: fn()) {
    if system::address_space_allowed().is_some_and(|bytes| bytes < SCARCE) {
        system::share_heap();
    }
    CLEAN.get_or_init(|| clean);
    system::on_abort(end_of_abort);
    let other = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        // Some libraries panic where they get no memory.
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
    // Something else went wrong.
    system::abort_as_ever();
}

fn end() -> ! {
    if ENDING_HERE.replace(true) {
        // Not even the reserve was enough.
        system::exit(i32::from(exit_code::RESOURCE));
    }
    while ENDING.swap(true, SeqCst) {
        // Another thread is at it.
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

/// Text of bounded length.
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
