//! Limits OpenBLAS to one thread, and reserves its work buffers, while SuiteSparseQR runs.
//!
//! Threads inside BLAS calls change the order of summation, and so the last bits and, near the tolerance, the rank. Inside a task
//! tree they also cost far more than they gain. The limit applies to the whole process: other callers of OpenBLAS have one thread
//! too until it is lifted. OpenBLAS is looked up at run time; another BLAS is left alone.
//!
//! OpenBLAS gives each call the first free buffer. If all are in use it allocates another one, keeps it, and retries for ever if
//! there is no memory for it. [`hold`] therefore checks the free memory, makes OpenBLAS allocate the buffers, and admits at most as many
//! callers as there are buffers. OpenBLAS allocates a buffer only while all others are taken. Callers that run at that time may need
//! buffers too, so the check includes theirs. (This holds for builds with one set of buffers for all threads: OpenBLAS's default
//! and that of the distributions. With `USE_TLS` each thread allocates its own buffers.)
//!
//! When OpenBLAS is loaded, it starts a thread with such a buffer for each core. Without memory for the buffers these threads
//! never end, and `exit` waits for them. A program (not a library) can prevent this with the feature `serial-blas` of this
//! crate and the linker option `--export-dynamic-symbol=openblas_num_threads_env` (in the program's `build.rs`,
//! `cargo::rustc-link-arg-bins`): then OpenBLAS starts with one thread unless `OPENBLAS_NUM_THREADS` is set, and starts others only on
//! request. Setting `OPENBLAS_NUM_THREADS=1` in the environment has the same effect for any program.

use core::ffi::{CStr, c_int, c_void};
use core::mem::transmute;
use core::num::NonZero;
use std::sync::{Condvar, Mutex, PoisonError};

/// Keeps OpenBLAS at one thread. When the last value is dropped, OpenBLAS gets its previous number of threads.
#[derive(Debug)]
pub struct Held {
    callers: usize,
}

struct BlasState {
    /// Number of [`Held`] values.
    holders: usize,
    /// Number of threads that may call OpenBLAS at once, for all holders.
    callers: usize,
    /// Lower bound of the buffers that OpenBLAS has.
    buffers: usize,
    /// Number of threads before the first holder.
    before: c_int,
}

static STATE: Mutex<BlasState> = Mutex::new(BlasState { holders: 0, callers: 0, buffers: 0, before: 1 });

/// Signals that a holder has ended.
static ENDED: Condvar = Condvar::new();

/// Limits OpenBLAS to one thread per call, for up to `callers` concurrent callers; fewer if memory for their buffers is short.
/// If there is no memory for one buffer, it waits for other holders to end, and returns `None` if there are none.
///
/// A thread must not call `hold` again while it has a [`Held`]: it could wait for itself.
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
    /// Number of threads that may call OpenBLAS at once.
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

/// Number of threads that OpenBLAS uses; `None` with another BLAS.
pub fn threads() -> Option<c_int> {
    // SAFETY: only OpenBLAS has this name, and this is the function's type there.
    let get =
        unsafe { find(c"openblas_get_num_threads").map(|at| transmute::<*mut c_void, extern "C" fn() -> c_int>(at)) };
    get.map(|get| get())
}

/// Changes the number of threads if OpenBLAS is there and the numbers differ.
fn set(from: c_int, to: c_int) {
    // SAFETY: as above.
    let set = unsafe { find(c"openblas_set_num_threads").map(|at| transmute::<*mut c_void, extern "C" fn(c_int)>(at)) };
    if let Some(set) = set.filter(|_| from != to) {
        set(to);
    }
}

/// Number of further callers, at most `wanted`, for whom there are buffers.
fn admit(state: &mut BlasState, wanted: usize) -> usize {
    let Some((take, give_back)) = buffer_functions() else { return wanted };
    if state.buffers < state.callers + wanted {
        make(state, state.callers + wanted, take, give_back);
    }
    wanted.min(state.buffers.saturating_sub(state.callers))
}

/// Makes OpenBLAS allocate buffers, up to `wanted` or the free memory, by taking as many at once and returning them.
fn make(state: &mut BlasState, wanted: usize, take: Take, give_back: GiveBack) {
    let taken = taken(state, wanted, room::is_left, || take(0));
    taken.iter().filter(|buffer| !buffer.is_null()).for_each(|&buffer| give_back(buffer));
    state.buffers = state.buffers.max(taken.len());
}

/// Takes `wanted` buffers, or fewer if `is_left` finds no memory for those that OpenBLAS may have to allocate.
fn taken<T>(state: &BlasState, wanted: usize, is_left: impl Fn(usize) -> bool, mut take: impl FnMut() -> T) -> Vec<T> {
    let mut taken = Vec::new();
    if taken.try_reserve_exact(wanted).is_ok() {
        while taken.len() < wanted && is_left(made_at_most(state, taken.len())) {
            taken.push(take());
        }
    }
    taken
}

/// Upper bound of the buffers that OpenBLAS allocates, for us and for running callers, if one more than `taken` is taken.
fn made_at_most(state: &BlasState, taken: usize) -> usize {
    (taken + 1 + state.callers).saturating_sub(state.buffers.max(taken))
}

type Take = extern "C" fn(c_int) -> *mut c_void;
type GiveBack = extern "C" fn(*mut c_void);

fn buffer_functions() -> Option<(Take, GiveBack)> {
    let (take, give_back) = (find(c"blas_memory_alloc")?, find(c"blas_memory_free")?);
    // SAFETY: only OpenBLAS has these names, and these are the functions' types there.
    Some(unsafe { (transmute::<*mut c_void, Take>(take), transmute::<*mut c_void, GiveBack>(give_back)) })
}

#[cfg(unix)]
mod room {
    use core::ptr::null_mut;

    /// Size of a buffer of OpenBLAS on x86-64 and ARM64.
    const BUFFER: usize = 128 << 20;

    /// Reserve for other threads that allocate between this check and OpenBLAS's own request; the two cannot be one step.
    const BETWEEN: usize = 16 << 20;

    /// Whether memory for more buffers is free: maps as much as OpenBLAS would, and unmaps it at once.
    pub fn is_left(buffers: usize) -> bool {
        if buffers == 0 {
            return true;
        }
        let size = buffers.saturating_mul(BUFFER).saturating_add(BETWEEN);
        let (access, kind) = (libc::PROT_READ | libc::PROT_WRITE, libc::MAP_PRIVATE | libc::MAP_ANONYMOUS);
        // SAFETY: it unmaps only the memory that it has just mapped.
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

/// Replaces the function by which OpenBLAS reads the number of threads from the environment when it is loaded, before `main`.
#[cfg(all(feature = "serial-blas", interposition))]
#[unsafe(export_name = "openblas_num_threads_env")]
pub extern "C" fn threads_at_start() -> c_int {
    // SAFETY: the name is a C string, nothing changes the environment before `main`, and the value is a C string or null.
    let wanted = unsafe {
        let value = libc::getenv(c"OPENBLAS_NUM_THREADS".as_ptr());
        if value.is_null() { 0 } else { libc::atoi(value) }
    };
    wanted.max(1)
}

#[cfg(unix)]
fn find(name: &CStr) -> Option<*mut c_void> {
    // SAFETY: the name is a C string, and the lookup calls nothing.
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

    /// Tests all combinations of small numbers. At one moment, all other callers take a buffer; they return it at the next moment or never.
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
            // Another BLAS has no limit.
            return assert_eq!([hold(1), hold(2)].map(|held| held.expect("no limit").callers), [1, 2]);
        };
        // With one core the previous number is 1 already, so the test sets another one.
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
