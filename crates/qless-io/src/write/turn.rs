//! The right to create files and to put them in place, which one thread has at a time.

use std::cell::Cell;
use std::sync::{Mutex, MutexGuard, PoisonError};

static TURN: Mutex<()> = Mutex::new(());

thread_local! {
    static AT_WORK: Cell<bool> = const { Cell::new(false) };
}

/// The right, until it is dropped.
pub(super) struct Turn(#[expect(dead_code, reason = "it is held")] MutexGuard<'static, ()>);

impl Turn {
    /// Waits for it; forever, once the program is ending.
    pub fn take() -> Self {
        let turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
        AT_WORK.set(true);
        Self(turn)
    }
}

impl Drop for Turn {
    fn drop(&mut self) {
        AT_WORK.set(false);
    }
}

/// Whether this thread is creating files, putting them in place or removing them for the last time.
///
/// A program whose allocator has a reserve may hand it out then: what is cut off at that moment stays behind. Allocates nothing.
///
/// ```
/// assert!(!qless_io::write::is_at_work());
/// ```
pub fn is_at_work() -> bool {
    AT_WORK.get()
}
