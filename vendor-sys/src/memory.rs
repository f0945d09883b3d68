//! A `cholmod_common` in which every allocation fails after the first failure.
//!
//! SuiteSparseQR 2.1 continues after some failed allocations. The next successful allocation then resets CHOLMOD's status, and the
//! library dereferences the null pointer of the failed one. If every later allocation fails too, the library stops, frees its memory and
//! returns the reason.
//!
//! The failure is stored directly behind the `cholmod_common`. CHOLMOD passes that pointer to every allocation on every thread, so all
//! workers of a call's task tree share one state. The library calls its allocation functions through the dynamic linker, and the
//! functions that `guard.rs` exports replace them. They forward every call with a foreign `cholmod_common` unchanged. This module
//! changes no global state, not even SuiteSparse's allocation hooks. Other code in the process may use the library and its hooks at
//! any time.
//!
//! The guard misses some or all allocations if the library was loaded before this code (by another `dlopen`ed library), if it was
//! linked with `-Bsymbolic-functions`, and on systems without ELF. There SuiteSparseQR behaves as without the guard.

use core::ffi::c_char;
use core::ptr::{NonNull, fn_addr_eq};
use core::sync::atomic::{AtomicI32, AtomicU64, Ordering::SeqCst};
use std::alloc::{Layout, alloc, dealloc};

use crate::cholmod_common;

/// The parameters of one call and its failure. Drop it after everything that was allocated with it.
///
/// The struct that CHOLMOD knows owns memory by raw pointers, which the drop frees. So safe code gets no reference to it. Safe code
/// calls [`Common::set_task_tree`] and reads single numbers.
///
/// ```compile_fail
/// let mut common = spqr_sys::memory::Common::start().expect("memory");
/// common.Flag = 8 as *mut _; // The drop would free this pointer.
/// ```
#[derive(Debug)]
pub struct Common(NonNull<AllocatorState>);

/// The struct that CHOLMOD knows, followed by a field of ours.
#[repr(C)]
#[derive(Debug)]
pub(crate) struct AllocatorState {
    common: cholmod_common,
    /// CHOLMOD's status at the first failed allocation; 0 before.
    failure: AtomicI32,
}

impl Common {
    /// CHOLMOD's defaults without printing; `None` if memory runs out.
    #[allow(clippy::cast_ptr_alignment, reason = "the layout is that of the struct")]
    pub fn start() -> Option<Self> {
        let layout = Layout::new::<AllocatorState>();
        // SAFETY: the struct is not zero-sized, and all-zero bytes are a valid value: it holds numbers, arrays and nullable pointers.
        let state = unsafe {
            let state = NonNull::new(alloc(layout).cast::<AllocatorState>())?;
            state.write_bytes(0, 1);
            state
        };
        let mut common = Self(state);
        // SAFETY: the struct is as large as C's (`tests/layout.rs` checks that) and does not move.
        unsafe {
            crate::cholmod_l_start(common.as_mut_ptr());
            (*common.as_mut_ptr()).print = 0;
            (*common.as_mut_ptr()).error_handler = Some(MARK);
        }
        Some(common)
    }

    /// The task tree of the next call: `SPQR_grain` (a tree if above 1) and `SPQR_small`, the least floating-point operations of a task.
    pub fn set_task_tree(&mut self, grain: f64, small: f64) {
        // SAFETY: initialized by `start`; both are plain numbers, and the library only accesses them during a call.
        unsafe {
            (*self.as_mut_ptr()).SPQR_grain = grain;
            (*self.as_mut_ptr()).SPQR_small = small;
        }
    }

    /// CHOLMOD's status after the last call.
    pub fn status(&self) -> i32 {
        self.get(|common| common.status)
    }

    /// Number of tasks of the last factorization.
    pub fn tasks(&self) -> i64 {
        self.get(|common| common.SPQR_istat[3])
    }

    /// Largest memory so far, in bytes.
    pub fn memory_usage(&self) -> usize {
        self.get(|common| common.memory_usage)
    }

    /// Seconds of the last analysis and of the last factorization.
    pub fn times(&self) -> [f64; 2] {
        self.get(|common| [common.SPQR_analyze_time, common.SPQR_factorize_time])
    }

    /// Frobenius norm of the entries that the last factorization dropped.
    pub fn dropped(&self) -> f64 {
        self.get(|common| common.SPQR_norm_E_fro)
    }

    fn get<T: Copy>(&self, read: impl FnOnce(&cholmod_common) -> T) -> T {
        // SAFETY: initialized by `start`. The library changes it only through `as_mut_ptr`, whose borrow has ended.
        read(unsafe { &(*self.0.as_ptr()).common })
    }

    /// The pointer to pass to the library.
    pub fn as_mut_ptr(&mut self) -> *mut cholmod_common {
        self.0.as_ptr().cast()
    }

    /// CHOLMOD's status at the first failed allocation, if any.
    pub fn failure(&self) -> Option<i32> {
        // SAFETY: the state is alive, and other threads access only this atomic.
        let status = unsafe { &(*self.0.as_ptr()).failure }.load(SeqCst);
        (status != 0).then_some(status)
    }
}

impl Drop for Common {
    fn drop(&mut self) {
        // SAFETY: started once and finished once; no pointer to it remains.
        unsafe {
            crate::cholmod_l_finish(self.as_mut_ptr());
            #[cfg(feature = "faults")]
            faults::finished(self.get(|common| common.malloc_count));
            dealloc(self.0.as_ptr().cast(), Layout::new::<AllocatorState>());
        }
    }
}

type Handler = unsafe extern "C" fn(i32, *const c_char, i32, *const c_char);

/// Identifies our `cholmod_common`. A static, so that it has one address.
static MARK: Handler = reported;

/// Number of errors that the library reported in our calls. It gives `reported` a body, so that a linker does not merge the function
/// with another empty one, whose address foreign code may use as its own handler.
static REPORTED: AtomicU64 = AtomicU64::new(0);

extern "C" fn reported(_: i32, _: *const c_char, _: i32, _: *const c_char) {
    REPORTED.fetch_add(1, SeqCst);
}

#[cfg_attr(not(interposition), allow(dead_code, reason = "for the guard"))]
impl AllocatorState {
    /// The failure behind our `cholmod_common`; `None` for a foreign one, which is only read.
    ///
    /// # Safety
    /// The pointer is null or points to a valid `cholmod_common`.
    pub(crate) unsafe fn behind<'a>(common: *mut cholmod_common) -> Option<&'a AtomicI32> {
        // SAFETY: valid by the caller's promise; with our mark it is the first field of an `AllocatorState`.
        unsafe {
            let handler = common.as_ref()?.error_handler?;
            fn_addr_eq(handler, MARK).then(|| &(*common.cast::<Self>()).failure)
        }
    }
}

/// Injects allocation failures into our calls, for tests. The counters are global, so only one test may use them at a time.
#[cfg(feature = "faults")]
#[cfg_attr(not(interposition), allow(dead_code, reason = "only the guard calls it"))]
pub mod faults {
    use core::sync::atomic::{AtomicI64, Ordering::SeqCst};

    /// Allocations until the one that fails; negative if none shall fail.
    static LEFT: AtomicI64 = AtomicI64::new(-1);
    static ASKED: AtomicI64 = AtomicI64::new(0);
    static LEAKED: AtomicI64 = AtomicI64::new(0);
    static INJECTED: AtomicI64 = AtomicI64::new(0);

    /// The `k`-th allocation from now (counted from 0) fails, and so do all later ones of the same call.
    pub fn fail_at(k: u32) {
        LEFT.store(i64::from(k), SeqCst);
    }

    /// Stops the injection.
    pub fn stop() {
        LEFT.store(-1, SeqCst);
    }

    /// Allocations requested so far.
    pub fn asked() -> i64 {
        ASKED.load(SeqCst)
    }

    /// Blocks that calls leaked.
    pub fn leaked() -> i64 {
        LEAKED.load(SeqCst)
    }

    /// Failures injected so far.
    pub fn injected() -> i64 {
        INJECTED.load(SeqCst)
    }

    /// Whether the current allocation shall fail.
    pub(crate) fn fails() -> bool {
        ASKED.fetch_add(1, SeqCst);
        let fails = LEFT.fetch_update(SeqCst, SeqCst, |left| (left >= 0).then(|| left - 1)) == Ok(0);
        INJECTED.fetch_add(i64::from(fails), SeqCst);
        fails
    }

    /// Called by `cpp/faults.cpp` for the allocations of C++.
    #[cfg(task_tree)]
    #[unsafe(export_name = "qless_fails_on_purpose")]
    pub extern "C" fn cpp_fails() -> bool {
        fails()
    }

    pub(super) fn finished(blocks: usize) {
        LEAKED.fetch_add(blocks as i64, SeqCst);
    }
}
