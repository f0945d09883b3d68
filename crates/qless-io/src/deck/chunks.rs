//! A list that grows without moving its items. Moving them would take time, and memory for both copies.

use std::ops::{Index, IndexMut};

/// Items in a chunk.
const CHUNK: usize = 1 << 14;

/// Items in chunks; all chunks but the last are full.
#[derive(Clone, Debug)]
pub(super) struct Chunks<T> {
    chunks: Vec<Vec<T>>,
}

impl<T> Default for Chunks<T> {
    fn default() -> Self {
        Self { chunks: Vec::new() }
    }
}

impl<T> Chunks<T> {
    pub fn len(&self) -> usize {
        self.chunks.last().map_or(0, |last| (self.chunks.len() - 1) * CHUNK + last.len())
    }

    pub fn push(&mut self, item: T) {
        if let Some(last) = self.chunks.last_mut().filter(|last| last.len() < CHUNK) {
            last.push(item);
            return;
        }
        // A short list allocates no full chunk.
        let room = if self.chunks.is_empty() { 0 } else { CHUNK };
        let mut chunk = Vec::with_capacity(room);
        chunk.push(item);
        self.chunks.push(chunk);
    }

    pub fn pop(&mut self) -> Option<T> {
        let last = self.chunks.last_mut()?;
        let item = last.pop();
        if last.is_empty() {
            self.chunks.pop();
        }
        item
    }

    pub fn last(&self) -> Option<&T> {
        self.chunks.last()?.last()
    }

    pub fn last_mut(&mut self) -> Option<&mut T> {
        self.chunks.last_mut()?.last_mut()
    }

    pub fn iter(&self) -> impl Iterator<Item = &T> + Clone {
        self.chunks.iter().flatten()
    }

    /// Items from `start` on.
    pub fn iter_from(&self, start: usize) -> impl Iterator<Item = &T> + Clone {
        let chunks = self.chunks.get(start / CHUNK..).unwrap_or_default();
        chunks.iter().flatten().skip(start % CHUNK)
    }

    /// Number of leading items that fulfil `is_such`; no later item may fulfil it.
    pub fn partition_point(&self, is_such: impl Fn(&T) -> bool) -> usize {
        let full = self.chunks.partition_point(|chunk| chunk.last().is_some_and(&is_such));
        match self.chunks.get(full) {
            Some(chunk) => full * CHUNK + chunk.partition_point(is_such),
            None => self.len(),
        }
    }

    /// All items, in order.
    pub fn into_items(self) -> impl Iterator<Item = T> {
        self.chunks.into_iter().flatten()
    }
}

impl<T> FromIterator<T> for Chunks<T> {
    fn from_iter<I: IntoIterator<Item = T>>(items: I) -> Self {
        let mut chunks = Self::default();
        items.into_iter().for_each(|item| chunks.push(item));
        chunks
    }
}

impl<T> Index<usize> for Chunks<T> {
    type Output = T;

    fn index(&self, i: usize) -> &T {
        &self.chunks[i / CHUNK][i % CHUNK]
    }
}

impl<T> IndexMut<usize> for Chunks<T> {
    fn index_mut(&mut self, i: usize) -> &mut T {
        &mut self.chunks[i / CHUNK][i % CHUNK]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chunks_are_a_list() {
        for count in [0, 1, CHUNK - 1, CHUNK, CHUNK + 1, 3 * CHUNK] {
            let mut list: Vec<usize> = (0..count).map(|k| 2 * k).collect();
            let mut chunks: Chunks<usize> = list.iter().copied().collect();
            assert_eq!((chunks.len(), chunks.last()), (list.len(), list.last()));
            for at in [0, 1, CHUNK / 2, CHUNK, CHUNK + 5, count] {
                assert!(chunks.iter_from(at).eq(list.iter().skip(at)));
                assert_eq!(chunks.partition_point(|&k| k < 2 * at), list.partition_point(|&k| k < 2 * at));
                if at < count {
                    (chunks[at], list[at]) = (chunks[at] + 1, list[at] + 1);
                    assert_eq!(chunks[at], list[at]);
                }
            }
            assert!(chunks.iter().eq(&list));
            assert_eq!((chunks.pop(), chunks.len()), (list.pop(), list.len()));
            assert!(chunks.into_items().eq(list));
        }
    }
}
