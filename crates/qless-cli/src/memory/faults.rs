//! Allocations that fail on purpose, for tests: `QLESS_FAIL_AT=k` has the k-th from the start fail (from 0), and says that it did.

use std::sync::atomic::{AtomicI64, Ordering::Relaxed};

use super::system;

/// Allocations until the one that fails; negative for none.
static LEFT: AtomicI64 = AtomicI64::new(-1);

/// Begins to count.
pub fn begin() {
    let wanted = std::env::var("QLESS_FAIL_AT").ok().and_then(|k| k.parse().ok());
    LEFT.store(wanted.unwrap_or(-1), Relaxed);
}

/// Whether the allocation that is asked for now is to fail.
pub fn fails() -> bool {
    if LEFT.load(Relaxed) < 0 || LEFT.fetch_sub(1, Relaxed) != 0 {
        return false;
    }
    system::tell(b"an allocation fails on purpose\n");
    true
}
