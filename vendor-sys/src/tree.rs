//! SuiteSparseQR's task tree on oneTBB (`cpp/tree.cpp`). It needs the feature `tbb` and SuiteSparseQR 2.1. Without them there are no task
//! trees, and [`with_threads`] only runs its work.
//!
//! This module exports functions with the names of the library's kernel and of its copy of R (`cpp/result.cpp`). The library calls them
//! through the dynamic linker, so ours replace them in the whole process. For callers that did not request threads, they call the
//! library's own functions.

#[cfg(task_tree)]
use linked as backend;
#[cfg(not(task_tree))]
use without as backend;

/// Runs `work`. Factorizations that it starts on this thread run their task trees on at most `threads` threads.
///
/// A factorization has a task tree only if `SPQR_grain` is above 1 in its `cholmod_common`.
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

/// Number of threads that a task tree uses if `threads` are requested: at most one per core, and 1 without task trees.
pub fn runners(threads: usize) -> usize {
    if is_active() { backend::runners(i32::try_from(threads).unwrap_or(i32::MAX)).max(1) as usize } else { 1 }
}

/// Number of task trees that have run in this process.
pub fn count() -> u64 {
    backend::count()
}

/// Whether SuiteSparseQR calls our kernel. It does not if it was loaded before this code, for example by a `dlopen`ed library.
pub fn is_active() -> bool {
    backend::is_active()
}

/// Version of oneTBB, such as `2021.8`; `None` if the task tree was not compiled in.
pub fn runtime() -> Option<&'static str> {
    backend::runtime()
}

#[cfg(not(task_tree))]
mod without {
    pub fn threads(_: i32) -> i32 {
        1
    }

    pub fn runners(_: i32) -> i32 {
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

    /// The mangled name of the kernel.
    const NAME: &CStr = c"_Z11spqr_kernelIdEvlP9spqr_blobIT_E";

    unsafe extern "C" {
        fn qless_tree_threads(threads: c_int) -> c_int;
        fn qless_tree_runners(threads: c_int) -> c_int;
        fn qless_tree_count() -> c_ulonglong;
        fn qless_tree_runtime() -> *const c_char;
    }

    /// Exports a function under a mangled name of the library; it forwards its arguments to our C++ function.
    macro_rules! stand_in {
        ($name:ident = $mangled:literal, $ours:ident($($argument:ident: $kind:ty),*)) => {
            unsafe extern "C" {
                fn $ours($($argument: $kind),*);
            }

            /// # Safety
            /// Only SuiteSparseQR may call it, with the arguments of a running factorization.
            #[unsafe(export_name = $mangled)]
            #[allow(clippy::too_many_arguments, reason = "the library's")]
            pub unsafe extern "C" fn $name($($argument: $kind),*) {
                // SAFETY: the arguments come from SuiteSparseQR unchanged, and no exception leaves the function.
                unsafe { $ours($($argument),*) }
            }
        };
    }

    type Data = *mut c_void;
    type Index = *mut c_long;
    type Values = *mut f64;

    // spqr_kernel<double>(task, blob) runs a task.
    stand_in!(kernel = "_Z11spqr_kernelIdEvlP9spqr_blobIT_E", qless_tree_kernel(task: c_long, blob: Data));

    // spqr_rcount<double> counts the entries in each column of R.
    stand_in!(count_r = "_Z11spqr_rcountIdEvP13spqr_symbolicP12spqr_numericIT_EllliPlS6_S6_S6_", qless_result_count(
        symbolic: Data, numeric: Data, first: c_long, econ: c_long, n2: c_long, transpose: c_int,
        a: Index, b: Index, h: Index, vectors: Index
    ));

    // spqr_rconvert<double> copies the entries of R.
    stand_in!(copy_r = "_Z13spqr_rconvertIdEvP13spqr_symbolicP12spqr_numericIT_EllliPlS6_PS3_S6_S6_S7_S6_S6_S7_S7_", qless_result_convert(
        symbolic: Data, numeric: Data, first: c_long, econ: c_long, n2: c_long, transpose: c_int,
        a_start: Index, a_row: Index, a_value: Values, b_start: Index, b_row: Index, b_value: Values,
        h_start: Index, h_row: Index, h_value: Values, tau: Values
    ));

    #[cfg(test)]
    #[test]
    fn the_library_counts_and_copies_r_here() {
        let ours: [(&CStr, *const c_void); 2] = [
            (c"_Z11spqr_rcountIdEvP13spqr_symbolicP12spqr_numericIT_EllliPlS6_S6_S6_", count_r as *const c_void),
            (
                c"_Z13spqr_rconvertIdEvP13spqr_symbolicP12spqr_numericIT_EllliPlS6_PS3_S6_S6_S7_S6_S6_S7_S7_",
                copy_r as *const c_void,
            ),
        ];
        for (name, function) in ours {
            // SAFETY: the name is a C string, and the lookup calls nothing.
            assert!(core::ptr::eq(unsafe { libc::dlsym(libc::RTLD_DEFAULT, name.as_ptr()) }, function), "{name:?}");
        }
    }

    pub fn threads(threads: c_int) -> c_int {
        // SAFETY: it only sets thread-local numbers.
        unsafe { qless_tree_threads(threads) }
    }

    pub fn runners(threads: c_int) -> c_int {
        // SAFETY: it only returns the smaller of two numbers.
        unsafe { qless_tree_runners(threads) }
    }

    pub fn count() -> u64 {
        // SAFETY: it only reads an atomic number.
        unsafe { qless_tree_count() }
    }

    pub fn is_active() -> bool {
        // SAFETY: the name is a C string, and the lookup calls nothing.
        let found = unsafe { libc::dlsym(libc::RTLD_DEFAULT, NAME.as_ptr()) };
        core::ptr::eq(found, kernel as *const c_void)
    }

    pub fn runtime() -> Option<&'static str> {
        // SAFETY: oneTBB returns a string constant.
        unsafe { CStr::from_ptr(qless_tree_runtime()) }.to_str().ok()
    }
}
