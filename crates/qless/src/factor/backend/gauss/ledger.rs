//! Bytes allocated so far, and how many may be.

use crate::Csr;
use crate::factor::backend::BackendError;

/// What the elimination of one m x n block may still allocate.
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

    /// Counts `count` values of type T, before they are allocated.
    pub fn take<T>(&mut self, count: usize) -> Result<(), BackendError> {
        let (rows, cols, limit) = (self.rows, self.cols, self.limit);
        let needed = self.used.saturating_add(count.saturating_mul(size_of::<T>()));
        if needed > limit {
            return Err(BackendError::OverLimit { backend: "gauss", rows, cols, needed, limit });
        }
        self.used = needed;
        Ok(())
    }

    /// Counts `count` values of type T that were freed.
    pub fn give<T>(&mut self, count: usize) {
        self.used -= count * size_of::<T>();
    }

    /// Makes room for `more` values, half as much again where it has to grow, so that pushing them cannot allocate.
    pub fn reserve<T>(&mut self, list: &mut Vec<T>, more: usize) -> Result<(), BackendError> {
        let before = list.capacity();
        if list.len() + more <= before {
            return Ok(());
        }
        let wanted = (list.len() + more).max(before + before / 2);
        // While it moves, the old list is there too.
        self.take::<T>(wanted)?;
        list.try_reserve_exact(wanted - list.len()).map_err(|_| self.out_of_memory())?;
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

    /// Frees what a list does not fill.
    pub fn shrink<T>(&mut self, list: &mut Vec<T>) {
        let before = list.capacity();
        list.shrink_to_fit();
        self.give::<T>(before - list.capacity());
    }

    fn out_of_memory(&self) -> BackendError {
        BackendError::OutOfMemory { backend: "gauss", rows: self.rows, cols: self.cols, advice: "" }
    }
}
