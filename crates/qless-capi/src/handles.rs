//! Handles: numbers in the form of pointers. A table maps each number to its object.
//!
//! No number is used twice, so a handle that is null, freed or of another kind is detected. An object that a call uses lives until the call
//! returns, even if another thread frees the handle.

use std::any::Any;
use std::collections::HashMap;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, OnceLock, PoisonError, RwLock};

use crate::status::CallFailure;

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
}

type HandleTable = RwLock<HashMap<usize, Arc<dyn Any + Send + Sync>>>;

fn table() -> &'static HandleTable {
    static TABLE: OnceLock<HandleTable> = OnceLock::new();
    TABLE.get_or_init(HandleTable::default)
}

/// Adds an object to the table and returns its handle. Numbers ascend, so none is used twice.
pub fn insert<H>(value: impl Any + Send + Sync) -> *mut H {
    static NEXT: AtomicUsize = AtomicUsize::new(1);
    let number = NEXT.fetch_add(1, Ordering::Relaxed);
    table().write().unwrap_or_else(PoisonError::into_inner).insert(number, Arc::new(value));
    std::ptr::without_provenance_mut(number)
}

/// The object of a handle.
pub fn get<H, T: Any + Send + Sync>(handle: *const H) -> Result<Arc<T>, CallFailure> {
    let found = table().read().unwrap_or_else(PoisonError::into_inner).get(&handle.addr()).cloned();
    found.and_then(|found| found.downcast().ok()).ok_or_else(|| unknown(handle.is_null()))
}

/// Removes a handle from the table; null is no error, as with `free`.
pub fn remove<H, T: Any + Send + Sync>(handle: *mut H) -> Result<(), CallFailure> {
    if handle.is_null() {
        return Ok(());
    }
    let kept = get::<H, T>(handle)?;
    table().write().unwrap_or_else(PoisonError::into_inner).remove(&handle.addr());
    drop(kept);
    Ok(())
}

fn unknown(is_null: bool) -> CallFailure {
    let found = if is_null { "is null" } else { "was freed, or was made by another function" };
    CallFailure::input(format!(
        "the handle {found}; give one that a function of this library made and that was not freed"
    ))
}
