//! A `cholmod_common` of our own, in which the first allocation that fails makes all after it fail.
//!
//! SuiteSparseQR 2.1 goes on after some failures, and the next allocation that succeeds resets CHOLMOD's status: it then uses what it
//! did not get, and crashes. When every later allocation of the call fails as well it stops in time, frees what it has, and
//! says why.
//!
//! The failure is kept behind the `cholmod_common` itself, which each allocation of CHOLMOD is given, on whatever thread it is made: so a call
//! has one owner of its state, shared by the workers of its task tree. The library calls its allocation functions through the dynamic
//! linker, and those exported by `guard.rs` take their place. They hand all calls with a `cholmod_common` that is not ours to the
//! library as they came. Nothing global is written, SuiteSparse's own hooks neither, so that others in the process may use
//! the library, set hooks and change them, before and while we run.
//!
//! Where the library was loaded before this code, as by another `dlopen`ed library, where it is linked with
//! `-Bsymbolic-functions`, and on other systems than ELF, some or all allocations are the library's own, with its own faults.

use core::ffi::c_char;
use core::ops::{Deref, DerefMut};
use core::ptr::{NonNull, fn_addr_eq};
use core::sync::atomic::{AtomicI32, AtomicU64, Ordering::SeqCst};
use std::alloc::{Layout, alloc, dealloc};

use crate::cholmod_common;

/// The parameters of one call and its failure; freed when dropped, after all that was made with it.
#[derive(Debug)]
pub struct Common(NonNull<AllocatorState>);

/// What CHOLMOD gets a pointer to, and behind it what only we know.
#[repr(C)]
#[derive(Debug)]
pub(crate) struct AllocatorState {
    common: cholmod_common,
    /// CHOLMOD's status when an allocation failed first; 0 before.
    failure: AtomicI32,
}

impl Common {
    /// CHOLMOD's defaults, and nothing printed; none without memory.
    #[allow(clippy::cast_ptr_alignment, reason = "the layout asked for is that of the struct")]
    pub fn start() -> Option<Self> {
        let layout = Layout::new::<AllocatorState>();
        // SAFETY: the struct has a size; it is numbers, arrays of them and nullable pointers, of which all zeros is a value.
        let state = unsafe {
            let state = NonNull::new(alloc(layout).cast::<AllocatorState>())?;
            state.write_bytes(0, 1);
            state
        };
        let mut common = Self(state);
        // SAFETY: the struct is as large as C's (`tests/layout.rs` checks) and stays in place.
        unsafe { crate::cholmod_l_start(common.as_mut_ptr()) };
        common.print = 0;
        common.error_handler = Some(MARK);
        Some(common)
    }

    /// For calls of the library.
    pub fn as_mut_ptr(&mut self) -> *mut cholmod_common {
        self.0.as_ptr().cast()
    }

    /// CHOLMOD's status when an allocation failed, if one did.
    pub fn failure(&self) -> Option<i32> {
        // SAFETY: ours, and shared only through the atomic.
        let status = unsafe { &(*self.0.as_ptr()).failure }.load(SeqCst);
        (status != 0).then_some(status)
    }
}

impl Deref for Common {
    type Target = cholmod_common;

    fn deref(&self) -> &cholmod_common {
        // SAFETY: started, in place; the library runs only while it is borrowed mutably.
        unsafe { &(*self.0.as_ptr()).common }
    }
}

impl DerefMut for Common {
    fn deref_mut(&mut self) -> &mut cholmod_common {
        // SAFETY: as above.
        unsafe { &mut (*self.0.as_ptr()).common }
    }
}

impl Drop for Common {
    fn drop(&mut self) {
        // SAFETY: started once, and finished once; nobody has the pointer any more.
        unsafe {
            crate::cholmod_l_finish(self.as_mut_ptr());
            #[cfg(feature = "faults")]
            faults::finished(self.malloc_count);
            dealloc(self.0.as_ptr().cast(), Layout::new::<AllocatorState>());
        }
    }
}

type Handler = unsafe extern "C" fn(i32, *const c_char, i32, *const c_char);

/// Tells a `cholmod_common` of ours from others. In a static, so that it has one address.
static MARK: Handler = reported;

/// Errors that the library reported in calls of ours. The number keeps a linker from folding the function into another that
/// does nothing, which somebody else may have put there.
static REPORTED: AtomicU64 = AtomicU64::new(0);

extern "C" fn reported(_: i32, _: *const c_char, _: i32, _: *const c_char) {
    REPORTED.fetch_add(1, SeqCst);
}

#[cfg_attr(not(interposition), allow(dead_code, reason = "for the guard"))]
impl AllocatorState {
    /// What is behind a `cholmod_common` of ours; none for another's, which is only read.
    ///
    /// # Safety
    /// The pointer is null or the library's to use.
    pub(crate) unsafe fn behind<'a>(common: *mut cholmod_common) -> Option<&'a AtomicI32> {
        // SAFETY: the caller's promise; with our mark it is the first field of a `State`.
        unsafe {
            let handler = common.as_ref()?.error_handler?;
            fn_addr_eq(handler, MARK).then(|| &(*common.cast::<Self>()).failure)
        }
    }
}

/// Failures on purpose, for tests: of the calls that are ours, in the whole process, so that one test at a time uses them.
#[cfg(feature = "faults")]
#[cfg_attr(not(interposition), allow(dead_code, reason = "nothing calls it without the guard"))]
pub mod faults {
    use core::sync::atomic::{AtomicI64, Ordering::SeqCst};

    /// Allocations until the one that fails; negative for none.
    static LEFT: AtomicI64 = AtomicI64::new(-1);
    static ASKED: AtomicI64 = AtomicI64::new(0);
    static LEAKED: AtomicI64 = AtomicI64::new(0);
    static INJECTED: AtomicI64 = AtomicI64::new(0);

    /// The `k`-th allocation from now (from 0) fails, and with it all after it in its call.
    pub fn fail_at(k: u32) {
        LEFT.store(i64::from(k), SeqCst);
    }

    /// None fails any more.
    pub fn stop() {
        LEFT.store(-1, SeqCst);
    }

    /// Allocations asked for so far.
    pub fn asked() -> i64 {
        ASKED.load(SeqCst)
    }

    /// Blocks that calls had not freed when they ended.
    pub fn leaked() -> i64 {
        LEAKED.load(SeqCst)
    }

    /// Failures made so far.
    pub fn injected() -> i64 {
        INJECTED.load(SeqCst)
    }

    /// Whether the allocation that is asked for now is to fail.
    pub(crate) fn fails() -> bool {
        ASKED.fetch_add(1, SeqCst);
        let fails = LEFT.fetch_update(SeqCst, SeqCst, |left| (left >= 0).then(|| left - 1)) == Ok(0);
        INJECTED.fetch_add(i64::from(fails), SeqCst);
        fails
    }

    /// For `cpp/faults.cpp`: C++ allocates too.
    #[cfg(task_tree)]
    #[unsafe(export_name = "qless_fails_on_purpose")]
    pub extern "C" fn cpp_fails() -> bool {
        fails()
    }

    pub(super) fn finished(blocks: usize) {
        LEAKED.fetch_add(blocks as i64, SeqCst);
    }
}
