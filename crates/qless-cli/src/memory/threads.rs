//! Starts as many threads as the user asks for and the address space allows.

use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Sender, channel};
use std::thread::{Builder, JoinHandle};

use rayon::{ThreadPoolBuildError, ThreadPoolBuilder};

use super::system;

/// Bytes of a thread's stack.
const STACK: usize = 2 << 20;

/// Bytes that a thread may take beside its stack when it begins: its alternative stack for signals (at most 16 KiB) and one growth of the
/// heap (132 KiB).
const BESIDE_STACK: usize = 256 << 10;

/// Stacks may take at most one part in this many of the address space.
const STACKS: usize = 8;

/// Whether [`start`] was called before.
static IS_STARTED: AtomicBool = AtomicBool::new(false);

/// Creates the global thread pool with `wanted` threads, by default one for each core. The pool has fewer threads if the address space or
/// the system does not allow as many, but at least the current one. A second call does nothing: a command that reads two models has one
/// pool.
///
/// # Errors
/// Something else has created the pool.
pub fn start(wanted: Option<NonZeroUsize>) -> Result<(), ThreadPoolBuildError> {
    if IS_STARTED.swap(true, Ordering::Relaxed) {
        return Ok(());
    }
    let cores = || std::thread::available_parallelism().map_or(1, NonZeroUsize::get);
    let count = wanted.map_or_else(cores, NonZeroUsize::get);
    let room = system::address_space_allowed().map_or(usize::MAX, |bytes| bytes / STACKS / STACK);
    let found = possible(count.min(room));
    let builder = ThreadPoolBuilder::new();
    match (wanted, found) {
        (_, 0) => builder.num_threads(1).use_current_thread().build_global(),
        (None, found) if found == count => builder.build_global(),
        _ => builder.num_threads(found).build_global(),
    }
}

/// Whether there is room for one more thread.
pub fn is_one_more_possible() -> bool {
    possible(1) == 1
}

/// How many of `count` threads can run at once: starts them and ends them again. The system keeps their stacks for the threads of the pool.
fn possible(count: usize) -> usize {
    let started: Vec<(JoinHandle<()>, Sender<()>)> = (0..count).map_while(|_| waiting().ok()).collect();
    let count = started.len();
    for (thread, end) in started {
        drop(end);
        // The thread only waited and cannot have failed.
        let _ = thread.join();
    }
    count
}

/// A thread that ends when the sender is dropped.
fn waiting() -> std::io::Result<(JoinHandle<()>, Sender<()>)> {
    let (end, wait) = channel::<()>();
    let thread = begin(Builder::new(), move || {
        // This waits until the sender is dropped, which sends nothing.
        let _ = wait.recv();
    })?;
    Ok((thread, end))
}

/// Starts a thread and waits until it is about to run `work`. A new thread maps an alternative stack for signals first, and the process
/// aborts if it cannot. So there must be room for that before, and the caller must not take it meanwhile.
///
/// # Errors
/// The system provides no thread.
pub fn begin(builder: Builder, work: impl FnOnce() + Send + 'static) -> std::io::Result<JoinHandle<()>> {
    if !system::is_room_for(STACK + BESIDE_STACK) {
        return Err(std::io::ErrorKind::OutOfMemory.into());
    }
    let (runs, wait) = channel::<()>();
    let thread = builder.stack_size(STACK).spawn(move || {
        drop(runs);
        work();
    })?;
    // This waits until the new thread drops its end, which sends nothing.
    let _ = wait.recv();
    Ok(thread)
}
