//! OpenBLAS held at one thread, with working memory, while SuiteSparseQR runs.
//!
//! Threads inside BLAS calls change the order of sums, and with it the last bits and, near the tolerance, the rank; inside a task
//! tree they also cost far more than they gain. The setting is the process's: other callers of OpenBLAS have one thread
//! for that time too. Found at run time: with another BLAS nothing happens.
//!
//! OpenBLAS gives each call the first of its buffers that no other call has at that moment. Where all are in use it makes another, keeps it,
//! and asks for ever where there is no memory for it. So [`hold`] has it make what is needed, after a look whether there is room, and lets no
//! more callers in than there are buffers. To have one made, all others must be taken, which callers that run at that time may miss: the
//! look is for theirs too. (So it is in builds with one set of buffers for all threads, OpenBLAS's default and that of the
//! distributions; with `USE_TLS` each thread has its own, which nobody else can make.)
//!
//! When it is loaded, OpenBLAS starts a thread for each core, each with such a buffer: where there is no room they run for ever,
//! and `exit` waits for them. A program, not a library, may say that it wants none, with the feature `serial-blas` of this
//! crate and the linker's option `--export-dynamic-symbol=openblas_num_threads_env` (in the program's `build.rs`,
//! `cargo::rustc-link-arg-bins`): then OpenBLAS starts with one thread, unless `OPENBLAS_NUM_THREADS` says otherwise, and
//! starts others only when it is told to. Any other program does the same by `OPENBLAS_NUM_THREADS=1` in its environment.

use core::ffi::{CStr, c_int, c_void};
use core::mem::transmute;
use core::num::NonZero;
use std::sync::{Condvar, Mutex, PoisonError};

/// One thread until this is dropped; the number before is restored with the last of several.
#[derive(Debug)]
pub struct Held {
    callers: usize,
}

struct BlasState {
    /// How many hold it, ...
    holders: usize,
    /// ... and how many threads of theirs call it at once.
    callers: usize,
    /// Buffers that OpenBLAS has at least.
    buffers: usize,
    /// Threads before the first holder.
    before: c_int,
}

static STATE: Mutex<BlasState> = Mutex::new(BlasState { holders: 0, callers: 0, buffers: 0, before: 1 });

/// Some of those who hold it have ended.
static ENDED: Condvar = Condvar::new();

/// Holds OpenBLAS, if that is the BLAS, at one thread for each of so many callers at once, or of fewer if there is no memory
/// for their buffers. Waits for others who hold it if there is none for one; none if there are no others.
///
/// Nobody may ask again while holding it.
pub fn hold(callers: usize) -> Option<Held> {
    let mut state = STATE.lock().unwrap_or_else(PoisonError::into_inner);
    let mut granted = admit(&mut state, callers.max(1));
    while granted == 0 && state.holders > 0 {
        state = ENDED.wait(state).unwrap_or_else(PoisonError::into_inner);
        granted = admit(&mut state, callers.max(1));
    }
    let callers = NonZero::new(granted)?.get();
    if state.holders == 0 {
        state.before = threads().unwrap_or(1);
        set(state.before, 1);
    }
    state.holders += 1;
    state.callers += callers;
    Some(Held { callers })
}

impl Held {
    /// How many threads may call it at once.
    pub fn callers(&self) -> usize {
        self.callers
    }
}

impl Drop for Held {
    fn drop(&mut self) {
        let mut state = STATE.lock().unwrap_or_else(PoisonError::into_inner);
        state.holders -= 1;
        state.callers -= self.callers;
        if state.holders == 0 {
            set(1, state.before);
        }
        ENDED.notify_all();
    }
}

/// Number of threads that OpenBLAS uses; none with another BLAS.
pub fn threads() -> Option<c_int> {
    // SAFETY: this is the function's type in OpenBLAS, which alone has this name.
    let get =
        unsafe { find(c"openblas_get_num_threads").map(|at| transmute::<*mut c_void, extern "C" fn() -> c_int>(at)) };
    get.map(|get| get())
}

/// Changes the number of threads, unless it is as wanted or there is no OpenBLAS.
fn set(from: c_int, to: c_int) {
    // SAFETY: as above.
    let set = unsafe { find(c"openblas_set_num_threads").map(|at| transmute::<*mut c_void, extern "C" fn(c_int)>(at)) };
    if let Some(set) = set.filter(|_| from != to) {
        set(to);
    }
}

/// For how many more callers, of those wanted, there are buffers.
fn admit(state: &mut BlasState, wanted: usize) -> usize {
    let Some((take, give_back)) = buffer_functions() else { return wanted };
    if state.buffers < state.callers + wanted {
        make(state, state.callers + wanted, take, give_back);
    }
    wanted.min(state.buffers.saturating_sub(state.callers))
}

/// Has OpenBLAS make buffers, until there are `wanted` or no room: takes as many at once, and gives them back.
fn make(state: &mut BlasState, wanted: usize, take: Take, give_back: GiveBack) {
    let taken = taken(state, wanted, room::is_left, || take(0));
    taken.iter().filter(|buffer| !buffer.is_null()).for_each(|&buffer| give_back(buffer));
    state.buffers = state.buffers.max(taken.len());
}

/// So many buffers, or fewer where there is no room (`is_left`) for those that may have to be made.
fn taken<T>(state: &BlasState, wanted: usize, is_left: impl Fn(usize) -> bool, mut take: impl FnMut() -> T) -> Vec<T> {
    let mut taken = Vec::new();
    if taken.try_reserve_exact(wanted).is_ok() {
        while taken.len() < wanted && is_left(made_at_most(state, taken.len())) {
            taken.push(take());
        }
    }
    taken
}

/// How many buffers OpenBLAS may have to make, for us and for callers that run, if one more is taken than so many.
fn made_at_most(state: &BlasState, taken: usize) -> usize {
    (taken + 1 + state.callers).saturating_sub(state.buffers.max(taken))
}

type Take = extern "C" fn(c_int) -> *mut c_void;
type GiveBack = extern "C" fn(*mut c_void);

fn buffer_functions() -> Option<(Take, GiveBack)> {
    let (take, give_back) = (find(c"blas_memory_alloc")?, find(c"blas_memory_free")?);
    // SAFETY: these are the functions' types in OpenBLAS, which alone has these names.
    Some(unsafe { (transmute::<*mut c_void, Take>(take), transmute::<*mut c_void, GiveBack>(give_back)) })
}

#[cfg(unix)]
mod room {
    use core::ptr::null_mut;

    /// A buffer of OpenBLAS on x86-64 and ARM64.
    const BUFFER: usize = 128 << 20;

    /// What other threads may allocate between the look and OpenBLAS's request, which nothing can make one.
    const BETWEEN: usize = 16 << 20;

    /// Whether there is room for so many more buffers: a request as large as OpenBLAS's, given back at once.
    pub fn is_left(buffers: usize) -> bool {
        if buffers == 0 {
            return true;
        }
        let size = buffers.saturating_mul(BUFFER).saturating_add(BETWEEN);
        let (access, kind) = (libc::PROT_READ | libc::PROT_WRITE, libc::MAP_PRIVATE | libc::MAP_ANONYMOUS);
        // SAFETY: new memory, which nobody else knows of, and no other.
        unsafe {
            let block = libc::mmap(null_mut(), size, access, kind, -1, 0);
            block != libc::MAP_FAILED && libc::munmap(block, size) == 0
        }
    }
}

#[cfg(not(unix))]
mod room {
    pub fn is_left(_: usize) -> bool {
        true
    }
}

/// OpenBLAS asks itself, when it is loaded, how many threads the environment wants; before `main`.
#[cfg(all(feature = "serial-blas", interposition))]
#[unsafe(export_name = "openblas_num_threads_env")]
pub extern "C" fn threads_at_start() -> c_int {
    // SAFETY: a C string, and nothing changes the environment before `main`; the value is a C string or null.
    let wanted = unsafe {
        let value = libc::getenv(c"OPENBLAS_NUM_THREADS".as_ptr());
        if value.is_null() { 0 } else { libc::atoi(value) }
    };
    wanted.max(1)
}

#[cfg(unix)]
fn find(name: &CStr) -> Option<*mut c_void> {
    // SAFETY: the name is a C string; nothing is loaded or called.
    let found = unsafe { libc::dlsym(libc::RTLD_DEFAULT, name.as_ptr()) };
    (!found.is_null()).then_some(found)
}

#[cfg(not(unix))]
fn find(_: &CStr) -> Option<*mut c_void> {
    None
}

#[cfg(test)]
mod tests {
    use core::cell::Cell;

    use super::*;

    /// For all small numbers: others take all that they may at any moment, and give them back at the next or never.
    #[test]
    fn no_buffer_is_asked_for_without_room() {
        for k in 0..4_usize.pow(5) {
            let [buffers, callers, more, room, moment] =
                core::array::from_fn(|digit| k / 4_usize.pow(digit as u32) % 4);
            if callers > buffers {
                continue;
            }
            for stays in [false, true] {
                let state = BlasState { holders: callers, callers, buffers, before: 1 };
                let (ours, made) = (Cell::new(0), Cell::new(buffers));
                let take = || {
                    let others = if ours.get() == moment || (stays && ours.get() > moment) { callers } else { 0 };
                    ours.set(ours.get() + 1);
                    made.set(made.get().max(ours.get() + others));
                };
                let is_left = |count| made.get() + count <= buffers + room;
                let taken = taken(&state, callers + more, is_left, take).len();
                assert!(made.get().max(taken + callers) <= buffers.max(callers) + room, "{k}: {}", made.get());
                assert!(callers > 0 || taken == more.min(buffers + room), "{k}: {taken}");
            }
        }
    }

    #[test]
    fn the_last_of_several_holders_restores_the_number() {
        let Some(before) = threads() else {
            // Another BLAS: everybody has as many as he wants.
            return assert_eq!([hold(1), hold(2)].map(|held| held.expect("no limit").callers), [1, 2]);
        };
        // Set by hand, so that there is something to restore on a machine with one core too.
        set(before, 3);
        let (first, second) = (hold(1), hold(2));
        assert_eq!(second.as_ref().map(Held::callers), Some(2));
        assert_eq!(threads(), Some(1));
        drop(first);
        assert_eq!(threads(), Some(1));
        drop(second);
        assert_eq!(threads(), Some(3));
        set(3, before);
    }
}
