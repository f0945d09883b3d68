//! OpenBLAS held at one thread, with working memory, while SuiteSparseQR runs.
//!
//! Threads inside BLAS calls change the order of sums, and with it the last bits and, near the tolerance, the rank; inside a task
//! tree they also cost far more than they gain. The setting is the process's: other callers of OpenBLAS have one thread
//! for that time too. Found at run time: with another BLAS nothing happens.
//!
//! OpenBLAS makes a buffer for each call that runs at the same time as others, keeps it, and asks for ever where there is no memory for one. So
//! [`hold`] has it make what is needed, after a look whether there is room.
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

struct State {
    /// How many hold it, ...
    holders: usize,
    /// ... and how many threads of theirs call it at once.
    callers: usize,
    /// Buffers that OpenBLAS has at least.
    buffers: usize,
    /// Threads before the first holder.
    before: c_int,
}

static STATE: Mutex<State> = Mutex::new(State { holders: 0, callers: 0, buffers: 0, before: 1 });

/// Some of those who hold it have ended.
static ENDED: Condvar = Condvar::new();

/// Holds OpenBLAS, if that is the BLAS, at one thread for each of so many callers at once, or of fewer if there is no memory
/// for their buffers. Waits for others who hold it if there is none for one; none if there are no others.
///
/// Nobody may ask again while holding it.
pub fn hold(callers: usize) -> Option<Held> {
    let mut state = STATE.lock().unwrap_or_else(PoisonError::into_inner);
    let mut granted = reserve(&mut state, callers.max(1));
    while granted == 0 && state.holders > 0 {
        state = ENDED.wait(state).unwrap_or_else(PoisonError::into_inner);
        granted = reserve(&mut state, callers.max(1));
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

/// For how many more callers, of those wanted, there are buffers: takes as many at once as all may need, and gives them back.
fn reserve(state: &mut State, wanted: usize) -> usize {
    let Some((take, give_back)) = buffer_functions() else { return wanted };
    let mut taken = Vec::new();
    if taken.try_reserve_exact(state.callers + wanted).is_err() {
        return 0;
    }
    // Some of those that it has may be in use.
    let unused = state.buffers.saturating_sub(state.callers);
    while taken.len() < state.callers + wanted && (taken.len() < unused || room::is_left()) {
        taken.push(take(0));
    }
    taken.iter().filter(|buffer| !buffer.is_null()).for_each(|&buffer| give_back(buffer));
    state.buffers = state.buffers.max(taken.len());
    taken.len().saturating_sub(state.callers)
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

    /// A buffer of OpenBLAS on x86-64 and ARM64, and something for what comes between.
    const BUFFER: usize = (128 << 20) + (1 << 20);

    /// Whether there is room for another buffer: the same request as OpenBLAS's, given back at once.
    pub fn is_left() -> bool {
        let (access, kind) = (libc::PROT_READ | libc::PROT_WRITE, libc::MAP_PRIVATE | libc::MAP_ANONYMOUS);
        // SAFETY: new memory, which nobody else knows of, and no other.
        unsafe {
            let block = libc::mmap(null_mut(), BUFFER, access, kind, -1, 0);
            block != libc::MAP_FAILED && libc::munmap(block, BUFFER) == 0
        }
    }
}

#[cfg(not(unix))]
mod room {
    pub fn is_left() -> bool {
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
    use super::*;

    #[test]
    fn the_last_of_several_holders_restores_the_number() {
        let Some(before) = threads() else { return };
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
