//! Handles: numbers in the form of pointers. A table maps each number to its object.
//!
//! No number is used twice, so a handle that is null, freed or of another kind is detected. An object that a call uses lives until the call
//! returns, even if another thread frees the handle. If a panic interrupts a change of an object, later calls on its handle fail.

use std::any::Any;
use std::collections::HashMap;
use std::ffi::c_int;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, LockResult, OnceLock, RwLock};

use crate::arrays::set;
use crate::status::{CallFailure, OK, guard};

macro_rules! opaque {
    ($($(#[$doc:meta])* $name:ident)*) => {$(
        $(#[$doc])*
        #[repr(C)]
        #[derive(Debug)]
        pub struct $name {
            never_read: [u8; 0],
        }
    )*};
}

opaque! {
    /// A handle of options.
    qless_options
    /// A handle of an analysis.
    qless_analysis
    /// A handle of an elimination.
    qless_elimination
    /// A handle of the pattern of a condensed matrix.
    qless_pattern
    /// A handle of a deck.
    qless_deck
    /// A handle of the analysis of a job on one of its ranks.
    qless_distributed
}

type HandleTable = RwLock<HashMap<usize, Arc<dyn Any + Send + Sync>>>;

fn table() -> &'static HandleTable {
    static TABLE: OnceLock<HandleTable> = OnceLock::new();
    TABLE.get_or_init(HandleTable::default)
}

/// The value that a lock guards; an error if a panic interrupted a call that held the lock exclusively.
pub fn unharmed<G>(lock: LockResult<G>) -> Result<G, CallFailure> {
    lock.map_err(|_| CallFailure::half_changed())
}

/// Adds an object to the table and writes its handle. Numbers ascend, so none is used twice.
///
/// # Safety
/// `place` is null or may be written.
pub unsafe fn insert<H>(what: &str, place: *mut *mut H, value: impl Any + Send + Sync) -> Result<(), CallFailure> {
    static NEXT: AtomicUsize = AtomicUsize::new(1);
    let number = NEXT.fetch_add(1, Ordering::Relaxed);
    let mut table = unharmed(table().write())?;
    // SAFETY: the caller upholds the contract.
    unsafe { set(what, place, std::ptr::without_provenance_mut(number)) }?;
    table.insert(number, Arc::new(value));
    Ok(())
}

/// The object of a handle.
pub fn get<H, T: Any + Send + Sync>(handle: *const H) -> Result<Arc<T>, CallFailure> {
    let found = unharmed(table().read())?.get(&handle.addr()).cloned();
    found.and_then(|found| found.downcast().ok()).ok_or_else(|| unknown(handle.is_null()))
}

/// Runs the work of a call on the object of a handle.
pub fn on<H, T: Any + Send + Sync>(handle: *const H, work: impl FnOnce(Arc<T>) -> Result<(), CallFailure>) -> c_int {
    guard(|| work(get(handle)?).map(|()| OK))
}

/// Removes a handle from the table; null is no error, as with `free`.
pub fn remove<H, T: Any + Send + Sync>(handle: *mut H) -> Result<c_int, CallFailure> {
    if handle.is_null() {
        return Ok(OK);
    }
    // Keeps the object alive while the table is locked. It is dropped afterwards, since dropping may take long.
    let kept = get::<H, T>(handle)?;
    unharmed(table().write())?.remove(&handle.addr());
    drop(kept);
    Ok(OK)
}

fn unknown(is_null: bool) -> CallFailure {
    let found = if is_null { "is null" } else { "was freed, or was made by another function" };
    CallFailure::input(format!(
        "the handle {found}; give one that a function of this library made and that was not freed"
    ))
}
