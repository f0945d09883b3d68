//! Counts allocated bytes against a limit.

use crate::Csr;
use crate::factor::backend::{BackendError, check_limit};

/// Bytes that the elimination of one m x n block has allocated, and the limit.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ledger {
    rows: usize,
    cols: usize,
    used: usize,
    limit: usize,
}

impl Ledger {
    pub fn new(columns: &Csr, limit: usize) -> Self {
        Self { rows: columns.cols, cols: columns.rows(), used: 0, limit }
    }

    /// Counts `count` values of type T before they are allocated.
    pub fn take<T>(&mut self, count: usize) -> Result<(), BackendError> {
        let needed = self.used.saturating_add(count.saturating_mul(size_of::<T>()));
        check_limit("gauss", (self.rows, self.cols), needed, self.limit)?;
        self.used = needed;
        Ok(())
    }

    /// Subtracts `count` values of type T that were freed.
    fn give<T>(&mut self, count: usize) {
        self.used -= count * size_of::<T>();
    }

    /// Reserves room for `more` values, so that pushing them cannot allocate. A list without enough room becomes longer by half at least.
    pub fn reserve<T>(&mut self, list: &mut Vec<T>, more: usize) -> Result<(), BackendError> {
        let before = list.capacity();
        if list.len() + more <= before {
            return Ok(());
        }
        let wanted = (list.len() + more).max(before + before / 2);
        // While the values move to the larger list, both lists exist and count.
        self.take::<T>(wanted)?;
        let Self { rows, cols, .. } = *self;
        let refused = |_| BackendError::OutOfMemory { backend: "gauss", rows, cols, advice: "" };
        list.try_reserve_exact(wanted - list.len()).map_err(refused)?;
        self.take::<T>(list.capacity() - wanted)?;
        self.give::<T>(before);
        Ok(())
    }

    /// An empty list with room for `length` values.
    pub fn empty<T>(&mut self, length: usize) -> Result<Vec<T>, BackendError> {
        let mut list = Vec::new();
        self.reserve(&mut list, length)?;
        Ok(list)
    }

    /// A list of `length` copies of `value`.
    pub fn filled<T: Clone>(&mut self, value: T, length: usize) -> Result<Vec<T>, BackendError> {
        let mut list = self.empty(length)?;
        list.resize(length, value);
        Ok(list)
    }

    /// Frees a list.
    pub fn free<T>(&mut self, list: Vec<T>) {
        self.give::<T>(list.capacity());
        drop(list);
    }

    /// Frees the unused capacity of a list.
    pub fn shrink<T>(&mut self, list: &mut Vec<T>) {
        let before = list.capacity();
        list.shrink_to_fit();
        self.give::<T>(before - list.capacity());
    }
}
