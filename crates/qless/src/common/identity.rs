//! Which analysis or set something was made by, so that it is refused by all others.

use std::sync::atomic::{AtomicU64, Ordering};

/// Which analysis or set something was made by: one for each of a process; copies stay the same.
///
/// ```
/// let (one, other) = (qless::common::Identity::new(), qless::common::Identity::new());
/// assert!(one == one.clone() && one != other && one != qless::common::Identity::NONE);
/// ```
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Identity(u64);

impl Identity {
    /// Of none.
    pub const NONE: Self = Self(0);

    /// One that nothing else has.
    pub fn new() -> Self {
        static NEXT: AtomicU64 = AtomicU64::new(1);
        Self(NEXT.fetch_add(1, Ordering::Relaxed))
    }
}

impl Default for Identity {
    fn default() -> Self {
        Self::NONE
    }
}

impl std::fmt::Debug for Identity {
    /// Without its number, which depends on what was done before.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Identity")
    }
}
