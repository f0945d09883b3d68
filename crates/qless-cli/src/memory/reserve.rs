//! Memory for operations that must complete although memory has run out: putting files in place, and ending the program.
//!
//! No byte is used twice. The reserve serves for paths and lists of names, only after the system or the limit refused an allocation.

#![allow(unsafe_code, reason = "memory that an allocator hands out")]

use std::alloc::Layout;
use std::cell::UnsafeCell;
use std::ptr::null_mut;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

const SIZE: usize = 512 << 10;
const ALIGN: usize = 16;

/// The bytes of the reserve. Pages that are never touched take no memory.
#[repr(align(16))]
struct Room(UnsafeCell<[u8; SIZE]>);

// SAFETY: each owner gets its own disjoint part, and nothing references the whole.
unsafe impl Sync for Room {}

static ROOM: Room = Room(UnsafeCell::new([0; SIZE]));
static USED: AtomicUsize = AtomicUsize::new(0);

/// Takes zeroed bytes from the reserve; null if too few remain or the alignment is above 16.
pub fn take(layout: Layout) -> *mut u8 {
    let start = |used: usize| used.next_multiple_of(layout.align().max(1));
    let end = |used| start(used).checked_add(layout.size()).filter(|&end| end <= SIZE && layout.align() <= ALIGN);
    match USED.fetch_update(Relaxed, Relaxed, end) {
        Ok(used) => ROOM.0.get().cast::<u8>().wrapping_add(start(used)),
        Err(_) => null_mut(),
    }
}

/// Whether a block belongs to the reserve.
pub fn owns(block: *const u8) -> bool {
    let start = ROOM.0.get() as usize;
    (start..start + SIZE).contains(&(block as usize))
}
