//! SuiteSparseQR's task tree on oneTBB (`cpp/tree.cpp`), with the feature `tbb` and SuiteSparseQR 2.1; nothing happens without.
//!
//! The exported name is that of the library's kernel, which the library calls through the dynamic linker: this definition
//! takes its place in the whole process. A caller that asked for no threads gets the library's own kernel, as before.

#[cfg(task_tree)]
use linked as backend;
#[cfg(not(task_tree))]
use without as backend;

/// Runs `work`; factorizations started in it, on this thread, run their task trees on so many threads.
///
/// A tree is made only if `SPQR_grain` is above 1 in their `cholmod_common`.
pub fn with_threads<T>(threads: usize, work: impl FnOnce() -> T) -> T {
    struct Restore(i32);
    impl Drop for Restore {
        fn drop(&mut self) {
            backend::threads(self.0);
        }
    }
    let _restore = Restore(backend::threads(i32::try_from(threads).unwrap_or(i32::MAX)));
    work()
}

/// How many task trees have run in this process.
pub fn count() -> u64 {
    backend::count()
}

/// Whether SuiteSparseQR calls our kernel: not where it was loaded before this code was, as by a `dlopen`ed library.
pub fn is_active() -> bool {
    backend::is_active()
}

/// oneTBB's own version, such as `2021.8`; none if the tree was not compiled in.
pub fn runtime() -> Option<&'static str> {
    backend::runtime()
}

#[cfg(not(task_tree))]
mod without {
    pub fn threads(_: i32) -> i32 {
        1
    }

    pub fn count() -> u64 {
        0
    }

    pub fn is_active() -> bool {
        false
    }

    pub fn runtime() -> Option<&'static str> {
        None
    }
}

#[cfg(task_tree)]
mod linked {
    use core::ffi::{CStr, c_char, c_int, c_long, c_ulonglong, c_void};

    /// The kernel's name, as C++ mangles it.
    const NAME: &CStr = c"_Z11spqr_kernelIdEvlP9spqr_blobIT_E";

    unsafe extern "C" {
        fn qless_tree_kernel(task: c_long, blob: *mut c_void);
        fn qless_tree_threads(threads: c_int) -> c_int;
        fn qless_tree_count() -> c_ulonglong;
        fn qless_tree_runtime() -> *const c_char;
    }

    /// Stands in for `spqr_kernel<double>(task, blob)`.
    ///
    /// # Safety
    /// For SuiteSparseQR itself: `blob` is the `spqr_blob<double>` of a factorization in progress.
    #[unsafe(export_name = "_Z11spqr_kernelIdEvlP9spqr_blobIT_E")]
    pub unsafe extern "C" fn kernel(task: c_long, blob: *mut c_void) {
        // SAFETY: both come from SuiteSparseQR as they are, and no exception leaves the function.
        unsafe { qless_tree_kernel(task, blob) }
    }

    pub fn threads(threads: c_int) -> c_int {
        // SAFETY: sets numbers of this thread only.
        unsafe { qless_tree_threads(threads) }
    }

    pub fn count() -> u64 {
        // SAFETY: reads an atomic number.
        unsafe { qless_tree_count() }
    }

    pub fn is_active() -> bool {
        // SAFETY: the name is a C string; nothing is loaded or called.
        let found = unsafe { libc::dlsym(libc::RTLD_DEFAULT, NAME.as_ptr()) };
        core::ptr::eq(found, kernel as *const c_void)
    }

    pub fn runtime() -> Option<&'static str> {
        // SAFETY: oneTBB returns a string constant.
        unsafe { CStr::from_ptr(qless_tree_runtime()) }.to_str().ok()
    }
}
