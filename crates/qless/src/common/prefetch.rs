//! Constants for prefetching.
//!
//! If DOFs are numbered in random order, each access to an array over DOFs waits for memory once the array exceeds the caches.
//! Independent accesses overlap, so a loop first reads the array entries of a whole batch and then uses them.

/// Number of array entries in a batch.
pub(crate) const BATCH: usize = 128;

/// Arrays up to this length stay in the caches; prefetching them would only cost time.
pub(crate) const IN_CACHE: usize = 1 << 17;
