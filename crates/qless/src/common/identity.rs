//! Identifies the analysis or set that made a result, so that another analysis or set can refuse this result.

use std::sync::atomic::{AtomicU64, Ordering};

/// The identity of an analysis or set, unique in a process; copies are equal.
///
/// ```
/// let (one, other) = (qless::common::Identity::new(), qless::common::Identity::new());
/// assert!(one == one.clone() && one != other && one != qless::common::Identity::NONE);
/// ```
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Identity(u64);

impl Identity {
    /// No analysis or set.
    pub const NONE: Self = Self(0);

    /// A new identity.
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
    /// Does not print the number, which depends on earlier calls.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Identity")
    }
}
