//! OpenBLAS held at one thread while SuiteSparseQR runs.
//!
//! Threads inside BLAS calls change the order of sums, and with it the last bits and, near the tolerance, the rank; inside a task
//! tree they also cost far more than they gain. The setting is the process's: other callers of OpenBLAS have one thread
//! for that time too. Found at run time: with another BLAS nothing happens.

use core::ffi::{CStr, c_int, c_void};
use core::mem::transmute;
use std::sync::{Mutex, PoisonError};

/// One thread until this is dropped; the number before is restored with the last of several.
#[derive(Debug)]
pub struct Held(());

/// How many hold it, and the number of threads before the first.
static HOLDERS: Mutex<(usize, c_int)> = Mutex::new((0, 1));

/// Holds OpenBLAS, if that is the BLAS, at one thread.
#[must_use]
pub fn hold() -> Held {
    let mut holders = HOLDERS.lock().unwrap_or_else(PoisonError::into_inner);
    if holders.0 == 0 {
        holders.1 = threads().unwrap_or(1);
        set(holders.1, 1);
    }
    holders.0 += 1;
    Held(())
}

impl Drop for Held {
    fn drop(&mut self) {
        let mut holders = HOLDERS.lock().unwrap_or_else(PoisonError::into_inner);
        holders.0 -= 1;
        if holders.0 == 0 {
            set(1, holders.1);
        }
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
        let (first, second) = (hold(), hold());
        assert_eq!(threads(), Some(1));
        drop(first);
        assert_eq!(threads(), Some(1));
        drop(second);
        assert_eq!(threads(), Some(3));
        set(3, before);
    }
}
