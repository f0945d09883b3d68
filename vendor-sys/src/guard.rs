//! Replacements for CHOLMOD's `malloc`, `calloc` and `realloc`; [`crate::memory`] explains why.
//!
//! Each calls the library's function, unless an earlier allocation with the same `cholmod_common` of ours has failed: then it fails too.

use core::ffi::{CStr, c_void};
use core::mem::transmute;
use core::ptr::null_mut;
use core::sync::atomic::{AtomicI32, AtomicPtr, Ordering::Relaxed, Ordering::SeqCst};

use crate::memory::AllocatorState;
use crate::{CHOLMOD_OUT_OF_MEMORY, cholmod_common};

type Allocate = unsafe extern "C" fn(usize, usize, *mut cholmod_common) -> *mut c_void;
type Reallocate = unsafe extern "C" fn(usize, usize, *mut c_void, *mut usize, *mut cholmod_common) -> *mut c_void;

/// The library's own function of a name: the next definition after ours in the order of the dynamic linker.
struct LibraryFunction(&'static CStr, AtomicPtr<c_void>);

impl LibraryFunction {
    const fn new(name: &'static CStr) -> Self {
        Self(name, AtomicPtr::new(null_mut()))
    }

    fn get(&self) -> *mut c_void {
        let known = self.1.load(Relaxed);
        if !known.is_null() {
            return known;
        }
        // SAFETY: the name is a C string, and the lookup calls nothing.
        let found = unsafe { libc::dlsym(libc::RTLD_NEXT, self.0.as_ptr()) };
        self.1.store(found, Relaxed);
        found
    }

    fn allocate(&self) -> Option<Allocate> {
        // SAFETY: the pointer is null, which is `None`, or a function of this type.
        unsafe { transmute::<*mut c_void, Option<Allocate>>(self.get()) }
    }

    fn reallocate(&self) -> Option<Reallocate> {
        // SAFETY: as above.
        unsafe { transmute::<*mut c_void, Option<Reallocate>>(self.get()) }
    }
}

static MALLOC: LibraryFunction = LibraryFunction::new(c"cholmod_l_malloc");
static CALLOC: LibraryFunction = LibraryFunction::new(c"cholmod_l_calloc");
static REALLOC: LibraryFunction = LibraryFunction::new(c"cholmod_l_realloc");

/// # Safety
/// As for CHOLMOD's function of the same name.
#[unsafe(export_name = "cholmod_l_malloc")]
pub unsafe extern "C" fn malloc(count: usize, size: usize, common: *mut cholmod_common) -> *mut c_void {
    // SAFETY: the arguments are passed on unchanged.
    unsafe { allocated(&MALLOC, count, size, common) }
}

/// # Safety
/// As for CHOLMOD's function of the same name.
#[unsafe(export_name = "cholmod_l_calloc")]
pub unsafe extern "C" fn calloc(count: usize, size: usize, common: *mut cholmod_common) -> *mut c_void {
    // SAFETY: the arguments are passed on unchanged.
    unsafe { allocated(&CALLOC, count, size, common) }
}

/// # Safety
/// As for CHOLMOD's function of the same name. A failure leaves the block and its count unchanged.
#[unsafe(export_name = "cholmod_l_realloc")]
pub unsafe extern "C" fn realloc(
    wanted: usize,
    size: usize,
    block: *mut c_void,
    count: *mut usize,
    common: *mut cholmod_common,
) -> *mut c_void {
    // SAFETY: the arguments are passed on unchanged; `count` is valid, and after the call it is the length of the block.
    unsafe {
        let Some(own) = REALLOC.reallocate() else { return block };
        let Some(failure) = AllocatorState::behind(common) else { return own(wanted, size, block, count, common) };
        if is_refused(failure, common) {
            return block;
        }
        let block = own(wanted, size, block, count, common);
        if *count != wanted {
            remember(failure, common);
        }
        block
    }
}

/// # Safety
/// The arguments are those of CHOLMOD.
unsafe fn allocated(own: &LibraryFunction, count: usize, size: usize, common: *mut cholmod_common) -> *mut c_void {
    // SAFETY: the arguments are passed on unchanged.
    unsafe {
        let Some(own) = own.allocate() else { return null_mut() };
        let Some(failure) = AllocatorState::behind(common) else { return own(count, size, common) };
        if is_refused(failure, common) {
            return null_mut();
        }
        let block = own(count, size, common);
        if block.is_null() {
            remember(failure, common);
        }
        block
    }
}

/// Whether an earlier allocation failed, or tests inject a failure. Then CHOLMOD's status is set again.
///
/// # Safety
/// `common` points to our `cholmod_common`.
unsafe fn is_refused(failure: &AtomicI32, common: *mut cholmod_common) -> bool {
    if failure.load(SeqCst) == 0 && fails_on_purpose() {
        failure.store(CHOLMOD_OUT_OF_MEMORY, SeqCst);
    }
    let status = failure.load(SeqCst);
    if status != 0 {
        // SAFETY: valid by the caller's promise.
        unsafe { (*common).status = status };
    }
    status != 0
}

/// Stores the status of the allocation that has just failed, unless another thread failed first.
///
/// # Safety
/// `common` points to our `cholmod_common`.
unsafe fn remember(failure: &AtomicI32, common: *mut cholmod_common) {
    // SAFETY: the caller's promise.
    let status = unsafe { (*common).status };
    let why = if status < 0 { status } else { CHOLMOD_OUT_OF_MEMORY };
    _ = failure.compare_exchange(0, why, SeqCst, SeqCst);
}

#[cfg(feature = "faults")]
fn fails_on_purpose() -> bool {
    crate::memory::faults::fails()
}

#[cfg(not(feature = "faults"))]
fn fails_on_purpose() -> bool {
    false
}
