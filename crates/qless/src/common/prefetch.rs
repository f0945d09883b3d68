//! Memory asked for ahead of its use.
//!
//! Where DOFs are numbered in any order, each look into an array over them waits for memory as soon as the array is larger than
//! the caches. Looks that do not wait for one another take the time of few: a loop that reads the places of a whole batch,
//! and does nothing else, before the first of them is used.

/// Places asked for at once.
pub(crate) const BATCH: usize = 128;

/// Arrays up to this length stay in the caches, and asking for them would only cost time.
pub(crate) const IN_CACHE: usize = 1 << 17;
