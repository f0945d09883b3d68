//! Patterns of K_q and of `W = K_S L`, compressed by rows or columns like K, and work arrays. K_S holds the lines (rows or columns) of the
//! slaves in K, and L holds T and the identity.

use std::sync::{Mutex, PoisonError};

/// A compressed pattern: line i (a row or a column) holds `index[k]` for `k` in `starts[i]..starts[i + 1]`.
#[derive(Clone, Debug)]
pub(super) struct Lines {
    pub starts: Vec<u32>,
    pub index: Vec<u32>,
}

impl Default for Lines {
    fn default() -> Self {
        Self { starts: vec![0], index: Vec::new() }
    }
}

impl Lines {
    /// Ends the current line (row or column); returns false if 32 bits cannot count the entries.
    #[must_use]
    pub fn close(&mut self) -> bool {
        self.starts.push(self.index.len() as u32);
        u32::try_from(self.index.len()).is_ok()
    }

    #[inline]
    pub fn range(&self, i: usize) -> std::ops::Range<usize> {
        self.starts[i] as usize..self.starts[i + 1] as usize
    }

    #[inline]
    pub fn line(&self, i: usize) -> &[u32] {
        &self.index[self.range(i)]
    }
}

/// Collects the indices of one line (row or column) of a pattern, each index once.
pub(super) struct Union {
    /// For each index, the last line (row or column) that contained it.
    seen: Vec<u32>,
    line: u32,
    found: Vec<u32>,
}

impl Union {
    pub fn new(count: usize) -> Self {
        Self { seen: vec![u32::MAX; count], line: 0, found: Vec::new() }
    }

    pub fn add(&mut self, index: u32) {
        if self.seen[index as usize] != self.line {
            self.seen[index as usize] = self.line;
            self.found.push(index);
        }
    }

    /// Appends the indices added since the last call, ascending.
    pub fn take(&mut self, into: &mut Vec<u32>) {
        self.found.sort_unstable();
        into.append(&mut self.found);
        self.line += 1;
    }
}

/// Work arrays that are used again and again. There are as many as were ever in use at the same time.
#[derive(Debug, Default)]
pub(super) struct WorkArrays(Mutex<Vec<Vec<f64>>>);

/// A clone starts without arrays.
impl Clone for WorkArrays {
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl WorkArrays {
    /// Calls `work` with an array of this length, whose numbers are undefined.
    pub fn with<R>(&self, length: usize, work: impl FnOnce(&mut [f64]) -> R) -> R {
        let taken = self.0.lock().unwrap_or_else(PoisonError::into_inner).pop();
        let mut list = taken.unwrap_or_default();
        list.resize(length.max(list.len()), 0.0);
        let result = work(&mut list[..length]);
        self.0.lock().unwrap_or_else(PoisonError::into_inner).push(list);
        result
    }
}
