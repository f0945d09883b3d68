//! SuiteSparse's own allocation hooks: an allocation that failed stays failed until the call ends.
//!
//! SuiteSparseQR 2.1 goes on after some failures, and the next allocation that succeeds resets CHOLMOD's status: it then uses what it
//! did not get, and crashes. When every later allocation of the call fails as well it stops in time, frees what it has, and
//! says why. So within [`call`] the first failure is remembered by thread and all that follow are refused; other callers of
//! SuiteSparse in the process see their own allocators, as before.
//!
//! With SuiteSparse 5, whose hooks are a public struct; with others nothing is done.

use core::cell::Cell;

thread_local! {
    /// Calls open on this thread, and whether one of their allocations failed.
    static OPEN: Cell<(u32, bool)> = const { Cell::new((0, false)) };
}

/// An open call; ends when dropped.
#[derive(Debug)]
pub struct Call(());

/// Opens a call on this thread.
#[must_use]
pub fn call() -> Call {
    #[cfg(config_struct)]
    hooks::install();
    OPEN.with(|open| open.set((open.get().0 + 1, open.get().1)));
    Call(())
}

impl Call {
    /// Whether an allocation failed since it was opened.
    pub fn has_failed(&self) -> bool {
        OPEN.with(Cell::get).1
    }
}

impl Drop for Call {
    fn drop(&mut self) {
        OPEN.with(|open| {
            let (count, failed) = open.get();
            open.set((count - 1, failed && count > 1));
        });
    }
}

/// Failures on purpose, for tests: of the whole process, so that one test at a time uses them.
#[cfg(feature = "faults")]
#[cfg_attr(not(config_struct), allow(dead_code, reason = "nothing calls it without hooks"))]
pub mod faults {
    use core::sync::atomic::{AtomicBool, AtomicI64, Ordering::SeqCst};

    /// Allocations until the one that fails; negative for none.
    static LEFT: AtomicI64 = AtomicI64::new(-1);
    static PERSISTENT: AtomicBool = AtomicBool::new(false);
    static MADE: AtomicI64 = AtomicI64::new(0);
    static HELD: AtomicI64 = AtomicI64::new(0);
    static INJECTED: AtomicI64 = AtomicI64::new(0);

    /// The `k`-th allocation from now (from 0) fails; with `persistent` all after it too.
    pub fn fail_at(k: u32, persistent: bool) {
        PERSISTENT.store(persistent, SeqCst);
        LEFT.store(i64::from(k), SeqCst);
    }

    /// None fails any more.
    pub fn stop() {
        LEFT.store(-1, SeqCst);
        PERSISTENT.store(false, SeqCst);
    }

    /// Allocations asked for so far.
    pub fn asked() -> i64 {
        MADE.load(SeqCst)
    }

    /// Blocks allocated and not freed.
    pub fn held() -> i64 {
        HELD.load(SeqCst)
    }

    /// Failures made so far.
    pub fn injected() -> i64 {
        INJECTED.load(SeqCst)
    }

    pub(super) fn fails() -> bool {
        MADE.fetch_add(1, SeqCst);
        let before = LEFT.load(SeqCst);
        if before > 0 || (before == 0 && !PERSISTENT.load(SeqCst)) {
            LEFT.fetch_sub(1, SeqCst);
        }
        INJECTED.fetch_add(i64::from(before == 0), SeqCst);
        before == 0
    }

    pub(super) fn hold(blocks: i64) {
        HELD.fetch_add(blocks, SeqCst);
    }
}

#[cfg(not(feature = "faults"))]
#[cfg(config_struct)]
mod faults {
    pub fn fails() -> bool {
        false
    }

    pub fn hold(_: i64) {}
}

#[cfg(config_struct)]
mod hooks {
    use core::ffi::c_void;
    use core::ptr::null_mut;
    use std::sync::OnceLock;

    use super::{OPEN, faults};
    use crate::SuiteSparse_config_struct;

    /// What stood in SuiteSparse's struct before.
    static BEFORE: OnceLock<SuiteSparse_config_struct> = OnceLock::new();

    /// Puts our functions before those that are there, once.
    pub fn install() {
        BEFORE.get_or_init(|| {
            let config = &raw mut crate::SuiteSparse_config;
            // SAFETY: the struct lives as long as the process. SuiteSparse asks that it be changed before it is used from
            // several threads, which holds for all who come through here: none of them goes on before this is done.
            unsafe {
                let before = *config;
                (*config).malloc_func = Some(malloc);
                (*config).calloc_func = Some(calloc);
                (*config).realloc_func = Some(realloc);
                (*config).free_func = Some(free);
                before
            }
        });
    }

    /// `allocate`, unless the call has failed already.
    fn attempt(allocate: impl FnOnce() -> *mut c_void) -> *mut c_void {
        let (count, failed) = OPEN.try_with(core::cell::Cell::get).unwrap_or((0, false));
        let refused = count > 0 && failed || faults::fails();
        let block = if refused { null_mut() } else { allocate() };
        if block.is_null() && count > 0 {
            // An error here means that the thread is ending, and then no call is open.
            OPEN.try_with(|open| open.set((count, true))).unwrap_or(());
        }
        block
    }

    unsafe extern "C" fn malloc(size: usize) -> *mut c_void {
        let Some(malloc) = BEFORE.get().and_then(|before| before.malloc_func) else { return null_mut() };
        // SAFETY: passed on as it came.
        let block = attempt(|| unsafe { malloc(size) });
        faults::hold(i64::from(!block.is_null()));
        block
    }

    unsafe extern "C" fn calloc(count: usize, size: usize) -> *mut c_void {
        let Some(calloc) = BEFORE.get().and_then(|before| before.calloc_func) else { return null_mut() };
        // SAFETY: passed on as it came.
        let block = attempt(|| unsafe { calloc(count, size) });
        faults::hold(i64::from(!block.is_null()));
        block
    }

    unsafe extern "C" fn realloc(old: *mut c_void, size: usize) -> *mut c_void {
        let Some(realloc) = BEFORE.get().and_then(|before| before.realloc_func) else { return null_mut() };
        // SAFETY: passed on as it came.
        let block = attempt(|| unsafe { realloc(old, size) });
        faults::hold(i64::from(old.is_null() && !block.is_null()));
        block
    }

    unsafe extern "C" fn free(block: *mut c_void) {
        faults::hold(-i64::from(!block.is_null()));
        if let Some(free) = BEFORE.get().and_then(|before| before.free_func) {
            // SAFETY: passed on as it came.
            unsafe { free(block) };
        }
    }
}
