//! `held <= limit`: bytes that fronts hold, counted before they are allocated.

use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

use crate::Error;

/// Counts bytes for all threads of one factorization.
pub(super) struct Ledger {
    held: AtomicUsize,
    most: AtomicUsize,
    limit: usize,
}

impl Ledger {
    pub fn new(limit: usize) -> Self {
        Self { held: AtomicUsize::new(0), most: AtomicUsize::new(0), limit }
    }

    pub fn limit(&self) -> usize {
        self.limit
    }

    /// Books bytes, or says that they are too many.
    pub fn take(&self, bytes: usize) -> Result<(), Error> {
        let needed = self.held.fetch_add(bytes, Relaxed).saturating_add(bytes);
        self.most.fetch_max(needed, Relaxed);
        if needed > self.limit { Err(Error::OutOfMemory { needed, limit: self.limit }) } else { Ok(()) }
    }

    /// The most that was ever held.
    pub fn most(&self) -> usize {
        self.most.load(Relaxed)
    }

    pub fn give(&self, bytes: usize) {
        self.held.fetch_sub(bytes, Relaxed);
    }

    /// An empty array with room for so many, if the machine has it.
    pub fn reserve<T>(&self, length: usize) -> Result<Vec<T>, Error> {
        let mut values = Vec::new();
        let failed = |_| Error::OutOfMemory { needed: length.saturating_mul(size_of::<T>()), limit: self.limit };
        values.try_reserve_exact(length).map_err(failed)?;
        Ok(values)
    }
}
