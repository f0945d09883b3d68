//! Allocations that fail on purpose, for tests: with `QLESS_FAIL_AT=k`, allocation k (from 0) fails with a message.

use std::sync::atomic::{AtomicI64, Ordering::Relaxed};

use super::system;

/// Number of allocations before the one that fails; negative if none fails.
static REMAINING: AtomicI64 = AtomicI64::new(-1);

/// Starts to count allocations.
pub fn begin() {
    let wanted = std::env::var("QLESS_FAIL_AT").ok().and_then(|k| k.parse().ok());
    REMAINING.store(wanted.unwrap_or(-1), Relaxed);
}

/// Whether the current allocation must fail.
pub fn fails() -> bool {
    if REMAINING.load(Relaxed) < 0 || REMAINING.fetch_sub(1, Relaxed) != 0 {
        return false;
    }
    system::tell(b"an allocation fails on purpose\n");
    true
}
