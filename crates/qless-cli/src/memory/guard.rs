//! An allocator that refuses an allocation unless `in_use + wanted <= limit`.
//!
//! `in_use` is the larger of two numbers:
//!
//! - The allocated bytes. They include pages that are not touched yet, but not those that remain untouched for long.
//! - The resident pages. They include memory that this allocator does not see: C's allocations, code, stacks, and freed memory that
//!   was not returned to the system. Reading their number takes microseconds, so it is read once for each 64th of the limit that is
//!   allocated.
//!
//! Page-aligned blocks count by their resident pages only. The matrix products of faer allocate such blocks: twice the cache for each
//! thread, 64 MiB on a server, but they touch only the part into which they copy their factors.
//!
//! Each thread counts its own bytes and adds them to the shared count after 64 KiB, so that threads do not contend for it.

#![allow(unsafe_code, reason = "`GlobalAlloc` is an unsafe trait; the system's allocator does the work")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::sync::atomic::{AtomicIsize, AtomicUsize, Ordering::Relaxed};

use super::refusal::{By, Refusal};
use super::{reserve, system};

/// The system's allocator with a limit.
pub struct Guard;

/// Bytes that a thread counts before it adds them to the shared count.
const BATCH: usize = 64 << 10;

/// Blocks of at least this alignment count by their resident pages.
const PAGE: usize = 4096;

static LIMIT: AtomicUsize = AtomicUsize::new(usize::MAX);
/// Resident bytes when the limit was set.
static BASE: AtomicUsize = AtomicUsize::new(0);
/// Bytes allocated since the limit was set and not yet freed.
static LIVE: AtomicIsize = AtomicIsize::new(0);
/// Bytes allocated since the resident pages were last read.
static SINCE: AtomicUsize = AtomicUsize::new(0);
/// Allocated bytes that were not resident, at the last 8 readings.
static UNTOUCHED: [AtomicUsize; 8] = [const { AtomicUsize::new(0) }; 8];
/// Number of readings of the resident pages.
static READINGS: AtomicUsize = AtomicUsize::new(0);
/// The smallest number in `UNTOUCHED`: bytes that have remained untouched for long.
static IDLE: AtomicUsize = AtomicUsize::new(0);

thread_local! {
    /// Two numbers that this thread has not yet added to the shared counts: the bytes that it allocated minus those that it freed, and the
    /// bytes that it allocated.
    static OWN: Cell<(isize, usize)> = const { Cell::new((0, 0)) };
}

/// Starts to count and sets the limit.
pub fn limit(bytes: usize) {
    BASE.store(system::resident(), Relaxed);
    LIVE.store(0, Relaxed);
    LIMIT.store(bytes, Relaxed);
}

/// Removes the limit.
pub fn lift() {
    LIMIT.store(usize::MAX, Relaxed);
}

/// Bytes that may still be allocated; `None` without a limit.
pub fn remaining() -> Option<usize> {
    let limit = LIMIT.load(Relaxed);
    (limit != usize::MAX).then(|| limit.saturating_sub(in_use()))
}

/// Allocated bytes, without those that remain untouched.
fn held() -> usize {
    allocated().saturating_sub(IDLE.load(Relaxed))
}

fn allocated() -> usize {
    BASE.load(Relaxed).saturating_add_signed(LIVE.load(Relaxed))
}

/// Counts `bytes` as allocated; returns false if they exceed the limit.
fn reserve_bytes(bytes: usize) -> bool {
    let limit = LIMIT.load(Relaxed);
    if limit == usize::MAX {
        return true;
    }
    let (net, handed) = OWN.get();
    let (net, handed) = (net + bytes as isize, handed + bytes);
    if handed < BATCH {
        OWN.set((net, handed));
        return true;
    }
    OWN.set((0, 0));
    // Until the checks below have passed, `LIVE` does not include the new `bytes`: the checks add them to the bytes in use.
    LIVE.fetch_add(net - bytes as isize, Relaxed);
    if update_idle(handed, limit) || held().saturating_add(bytes) > limit {
        let fits = || in_use().saturating_add(bytes) <= limit;
        if !fits() {
            system::give_back();
            if !fits() {
                Refusal { wanted: bytes, held: in_use(), allowed: limit, by: By::Option }.keep();
                return false;
            }
        }
    }
    LIVE.fetch_add(bytes as isize, Relaxed);
    true
}

/// Reads the resident pages again if a 64th of the limit was allocated since the last reading; returns whether it did.
fn update_idle(handed: usize, limit: usize) -> bool {
    let is_due = SINCE.fetch_add(handed, Relaxed) + handed >= limit / 64;
    if is_due {
        SINCE.store(0, Relaxed);
        let place = READINGS.fetch_add(1, Relaxed) % UNTOUCHED.len();
        UNTOUCHED[place].store(allocated().saturating_sub(system::resident()), Relaxed);
        IDLE.store(UNTOUCHED.iter().map(|bytes| bytes.load(Relaxed)).min().unwrap_or(0), Relaxed);
    }
    is_due
}

/// Bytes in use: the larger of the allocated and the resident bytes.
fn in_use() -> usize {
    held().max(system::resident())
}

fn release_bytes(bytes: usize) {
    if LIMIT.load(Relaxed) == usize::MAX {
        return;
    }
    let (net, handed) = OWN.get();
    let net = net - bytes as isize;
    if net.unsigned_abs() < BATCH {
        OWN.set((net, handed));
    } else {
        OWN.set((0, handed));
        LIVE.fetch_add(net, Relaxed);
    }
}

/// Bytes of a block that count when it is allocated; 0 if it is page-aligned.
fn counted(bytes: usize, layout: Layout) -> usize {
    if layout.align() < PAGE { bytes } else { 0 }
}

/// Calls `allocate`. Returns null, and records the refusal, if the limit or the system refuses `bytes`.
fn allocate_within_limit(bytes: usize, layout: Layout, allocate: impl FnOnce() -> *mut u8) -> *mut u8 {
    #[cfg(feature = "faults")]
    if super::faults::fails() {
        Refusal::of_system(bytes).keep();
        return std::ptr::null_mut();
    }
    let counted = counted(bytes, layout);
    if !reserve_bytes(counted) {
        return std::ptr::null_mut();
    }
    let block = allocate();
    if block.is_null() {
        release_bytes(counted);
        Refusal::of_system(bytes).keep();
    }
    block
}

/// Returns `block`, or a block of the reserve if `block` is null and this thread creates, places or removes files.
fn or_reserve(block: *mut u8, layout: Layout) -> *mut u8 {
    if block.is_null() && qless_io::write::is_at_work() { reserve::take(layout) } else { block }
}

// SAFETY: every block comes from the system's allocator and returns to it with the same layout, or belongs to the reserve. Counting
// does not allocate.
unsafe impl GlobalAlloc for Guard {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: `System` requires the same as this function, and the caller of this function satisfies it.
        or_reserve(allocate_within_limit(layout.size(), layout, || unsafe { System.alloc(layout) }), layout)
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: `System` requires the same as this function, and the caller of this function satisfies it.
        or_reserve(allocate_within_limit(layout.size(), layout, || unsafe { System.alloc_zeroed(layout) }), layout)
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        if !reserve::owns(block) {
            // SAFETY: the block comes from `System`, which requires the same as this function.
            unsafe { System.dealloc(block, layout) };
            release_bytes(counted(layout.size(), layout));
        }
    }

    unsafe fn realloc(&self, block: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        let moved = if reserve::owns(block) {
            std::ptr::null_mut()
        } else {
            let more = size.saturating_sub(layout.size());
            // SAFETY: the block comes from `System`, which requires the same as this function.
            allocate_within_limit(more, layout, || unsafe { System.realloc(block, layout, size) })
        };
        if !moved.is_null() {
            release_bytes(counted(layout.size().saturating_sub(size), layout));
            return moved;
        }
        // SAFETY: by the contract of `realloc`, a layout may have this size. The two blocks do not overlap, and both are long enough.
        unsafe {
            let wanted = Layout::from_size_align_unchecked(size, layout.align());
            let moved = if reserve::owns(block) { self.alloc(wanted) } else { or_reserve(moved, wanted) };
            if !moved.is_null() {
                moved.copy_from_nonoverlapping(block, size.min(layout.size()));
                self.dealloc(block, layout);
            }
            moved
        }
    }
}
