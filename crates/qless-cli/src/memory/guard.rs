//! `held + wanted <= limit`, asked at every allocation.
//!
//! Held is the larger of two numbers. The bytes handed out foresee pages that are not yet touched; spare room that stays untouched
//! for long is not counted. The resident pages hold what is not ours to count: C's memory, code, stacks, and what was freed but not
//! given back. Reading them takes microseconds, so they are read again after each 64th of the limit that is handed out.
//!
//! Blocks that begin on a page are counted by their resident pages alone. Nobody asks for that but who manages pages: faer's
//! products take twice the cache for each thread, 64 MiB on a server, and touch as much as they copy of their factors.
//!
//! Threads count for themselves and add to the common count after each 64 KiB, so that no number is everybody's.

#![allow(unsafe_code, reason = "an allocator is an unsafe trait; all its work is the system's")]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::sync::atomic::{AtomicIsize, AtomicUsize, Ordering::Relaxed};

use super::refusal::{By, Refusal};
use super::{reserve, system};

/// The system's allocator within the limit.
pub struct Guard;

/// Bytes that a thread counts for itself.
const BATCH: usize = 64 << 10;

/// From this alignment on a block is counted by what is touched of it.
const PAGE: usize = 4096;

static LIMIT: AtomicUsize = AtomicUsize::new(usize::MAX);
/// Resident when the limit was set.
static BASE: AtomicUsize = AtomicUsize::new(0);
/// Handed out since then and not freed.
static LIVE: AtomicIsize = AtomicIsize::new(0);
/// Handed out since the resident pages were read.
static SINCE: AtomicUsize = AtomicUsize::new(0);
/// Bytes handed out that were not resident, the last times that these were read.
static UNTOUCHED: [AtomicUsize; 8] = [const { AtomicUsize::new(0) }; 8];
/// How often that was.
static LOOKS: AtomicUsize = AtomicUsize::new(0);
/// The least of them.
static IDLE: AtomicUsize = AtomicUsize::new(0);

thread_local! {
    /// Handed out less freed, and handed out, that this thread has not yet added to the counts.
    static OWN: Cell<(isize, usize)> = const { Cell::new((0, 0)) };
}

/// Begins to count, and refuses what would be more than this.
pub fn limit(bytes: usize) {
    BASE.store(system::resident(), Relaxed);
    LIVE.store(0, Relaxed);
    LIMIT.store(bytes, Relaxed);
}

/// Refuses nothing any more.
pub fn lift() {
    LIMIT.store(usize::MAX, Relaxed);
}

/// Bytes that may still be allocated; none without a limit.
pub fn left() -> Option<usize> {
    let limit = LIMIT.load(Relaxed);
    (limit != usize::MAX).then(|| limit.saturating_sub(look()))
}

/// Bytes in use, with those handed out that may soon be touched.
fn held() -> usize {
    handed_out().saturating_sub(IDLE.load(Relaxed))
}

fn handed_out() -> usize {
    BASE.load(Relaxed).saturating_add_signed(LIVE.load(Relaxed))
}

/// Books `bytes`; false if there is no room for them.
fn book(bytes: usize) -> bool {
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
    // Without these bytes, which nobody has touched.
    LIVE.fetch_add(net - bytes as isize, Relaxed);
    if is_time_to_look(handed, limit) || held().saturating_add(bytes) > limit {
        let fits = || look().saturating_add(bytes) <= limit;
        if !fits() {
            system::give_back();
            if !fits() {
                Refusal { wanted: bytes, held: look(), allowed: limit, by: By::Option }.keep();
                return false;
            }
        }
    }
    LIVE.fetch_add(bytes as isize, Relaxed);
    true
}

/// Whether much was handed out since the last look.
fn is_time_to_look(handed: usize, limit: usize) -> bool {
    let is_time = SINCE.fetch_add(handed, Relaxed) + handed >= limit / 64;
    if is_time {
        SINCE.store(0, Relaxed);
        // What was not touched at any of the last looks.
        let place = LOOKS.fetch_add(1, Relaxed) % UNTOUCHED.len();
        UNTOUCHED[place].store(handed_out().saturating_sub(system::resident()), Relaxed);
        IDLE.store(UNTOUCHED.iter().map(|bytes| bytes.load(Relaxed)).min().unwrap_or(0), Relaxed);
    }
    is_time
}

/// Bytes in use by either count.
fn look() -> usize {
    held().max(system::resident())
}

fn give(bytes: usize) {
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

/// How many bytes of a block of this alignment are counted when they are handed out.
fn counted(bytes: usize, layout: Layout) -> usize {
    if layout.align() < PAGE { bytes } else { 0 }
}

/// Null if there is no room for `bytes` or the system has none; the numbers are kept.
fn ask(bytes: usize, layout: Layout, allocate: impl FnOnce() -> *mut u8) -> *mut u8 {
    #[cfg(feature = "faults")]
    if super::faults::fails() {
        Refusal::of_system(bytes).keep();
        return std::ptr::null_mut();
    }
    let counted = counted(bytes, layout);
    if !book(counted) {
        return std::ptr::null_mut();
    }
    let block = allocate();
    if block.is_null() {
        give(counted);
        Refusal::of_system(bytes).keep();
    }
    block
}

/// `block`, or one of the reserve where there is none for what must not be cut off.
fn or_reserve(block: *mut u8, layout: Layout) -> *mut u8 {
    if block.is_null() && qless_io::write::is_at_work() { reserve::take(layout) } else { block }
}

// SAFETY: every block comes from and goes back to the system's allocator as it was asked for, or is of the reserve; counting allocates nothing.
unsafe impl GlobalAlloc for Guard {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: passed on as it came.
        or_reserve(ask(layout.size(), layout, || unsafe { System.alloc(layout) }), layout)
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: passed on as it came.
        or_reserve(ask(layout.size(), layout, || unsafe { System.alloc_zeroed(layout) }), layout)
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        if !reserve::owns(block) {
            // SAFETY: passed on as it came.
            unsafe { System.dealloc(block, layout) };
            give(counted(layout.size(), layout));
        }
    }

    unsafe fn realloc(&self, block: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        let moved = if reserve::owns(block) {
            std::ptr::null_mut()
        } else {
            let more = size.saturating_sub(layout.size());
            // SAFETY: passed on as it came.
            ask(more, layout, || unsafe { System.realloc(block, layout, size) })
        };
        if !moved.is_null() {
            give(counted(layout.size().saturating_sub(size), layout));
            return moved;
        }
        // SAFETY: the size is one that a layout may have, by the caller's promise; old and new block are two, and each is as long as is copied.
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
