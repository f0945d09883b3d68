//! Writes rows to places in another order, on all threads of the pool.
//!
//! Each thread owns a range of the places, reads all rows in their order and writes those that belong to its range. Sequential reads are
//! cheap, and no two threads write to the same memory.

use crate::Csr;
use crate::common::pool::WORTH_A_THREAD;
use crate::common::prefetch::{BATCH, IN_CACHE};

/// The place of each row.
pub(super) struct SlaveOrder<'a> {
    slave: &'a [u32],
    place: &'a [u32],
    /// Number of places of one thread: those of thread k start at k times this.
    pub together: usize,
}

impl<'a> SlaveOrder<'a> {
    /// Row i has the place `place[slave[i]]`.
    pub fn new(slave: &'a [u32], place: &'a [u32]) -> Self {
        let threads = rayon::current_num_threads().min(slave.len() / WORTH_A_THREAD).max(1);
        Self { slave, place, together: slave.len().div_ceil(threads).max(1) }
    }

    pub fn rows(&self) -> usize {
        self.slave.len()
    }

    /// Visits the rows of thread k in batches, in ascending order. A batch lists (row, place relative to the first place of the thread).
    #[inline]
    pub fn visit(&self, k: usize, mut visit: impl FnMut(&[(u32, u32)])) {
        let (first, length) = ((k * self.together) as u32, self.together as u32);
        let mut batch = [(0, 0); BATCH];
        let mut count = 0;
        for (&slave, i) in self.slave.iter().zip(0..) {
            let place = self.place[slave as usize].wrapping_sub(first);
            // Each row is written to the batch, but is kept only if its place belongs to the thread: a branch would be unpredictable.
            batch[count] = (i, place);
            count += usize::from(place < length);
            if count == BATCH {
                visit(&batch);
                count = 0;
            }
        }
        visit(&batch[..count]);
    }
}

/// Consecutive rows of a matrix that one thread writes.
pub(super) struct RowRange<'a> {
    start: &'a [usize],
    col: &'a mut [u32],
    val: &'a mut [f64],
}

/// Splits a matrix into ranges of `together` rows.
pub(super) fn row_ranges(matrix: &mut Csr, together: usize) -> Vec<RowRange<'_>> {
    let Csr { start, col, val, .. } = matrix;
    let (mut col, mut val) = (col.as_mut_slice(), val.as_mut_slice());
    let rows = start.len() - 1;
    let mut ranges = Vec::new();
    for first in (0..rows).step_by(together) {
        let start = &start[first..=(first + together).min(rows)];
        let length = start[start.len() - 1] - start[0];
        let (of_col, others) = col.split_at_mut(length);
        let (of_val, other_values) = val.split_at_mut(length);
        (col, val) = (others, other_values);
        ranges.push(RowRange { start, col: of_col, val: of_val });
    }
    ranges
}

impl RowRange<'_> {
    /// Prefetches the memory of these rows, none of which is written yet.
    #[inline]
    pub fn prefetch(&mut self, batch: &[(u32, u32)]) {
        if self.start.len() > IN_CACHE {
            batch.iter().for_each(|&(_, row)| self.touch(row as usize));
        }
    }

    /// Prefetches by writing a zero, which the row already contains. A read would map a shared zero page that the next write has to
    /// replace.
    #[inline]
    fn touch(&mut self, row: usize) {
        let [start, end] = [row, row + 1].map(|row| self.start[row] - self.start[0]);
        if start < end {
            (self.col[start], self.val[start]) = (0, 0.0);
        }
    }

    /// Writes a row of this length, in ascending order of the columns.
    ///
    /// The caller passes the length: a loop that reads its end from `start` would wait for memory before every row.
    #[inline]
    pub fn fill(&mut self, row: usize, length: usize, sorted: bool, entries: impl Iterator<Item = (u32, f64)>) {
        let start = self.start[row] - self.start[0];
        let range = start..start + length;
        let places = self.col[range.clone()].iter_mut().zip(&mut self.val[range]);
        if sorted {
            places.zip(entries).for_each(|((column, value), entry)| (*column, *value) = entry);
        } else {
            let mut entries: Vec<_> = entries.collect();
            entries.sort_unstable_by_key(|&(j, _)| j);
            places.zip(entries).for_each(|((column, value), entry)| (*column, *value) = entry);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_row_is_visited_once_by_the_thread_of_its_place() {
        // 37 and 1,000 have no divisor in common, so `place` is a permutation.
        let slave: Vec<u32> = (0..1000).rev().collect();
        let place: Vec<u32> = (0..1000).map(|j| j * 37 % 1000).collect();
        for together in [1, 7, 128, 333, 1000, 5000] {
            let order = SlaveOrder { slave: &slave, place: &place, together };
            let mut row_at = vec![u32::MAX; 1000];
            for k in 0..1000_usize.div_ceil(together) {
                let mut before = None;
                order.visit(k, |batch| {
                    for &(i, row) in batch {
                        assert!(before.replace(i).is_none_or(|before| before < i), "in order");
                        assert_eq!(std::mem::replace(&mut row_at[k * together + row as usize], i), u32::MAX);
                    }
                });
            }
            assert!(row_at.iter().enumerate().all(|(at, &i)| place[slave[i as usize] as usize] as usize == at));
        }
    }

    #[test]
    fn row_ranges_cover_the_matrix() {
        let lengths = [3, 0, 1, 4, 0, 2, 5];
        let start: Vec<usize> = std::iter::once(0)
            .chain(lengths.iter().scan(0, |sum, &n| {
                *sum += n;
                Some(*sum)
            }))
            .collect();
        for together in 1..10 {
            let mut matrix = Csr { cols: 9, start: start.clone(), col: vec![0; 15], val: vec![0.0; 15] };
            for (k, mut range) in row_ranges(&mut matrix, together).into_iter().enumerate() {
                // In descending order: if `touch` wrote to an empty row, it would overwrite the row after it, which is already filled, and
                // the test would fail.
                for (row, &length) in lengths.iter().skip(k * together).take(together).enumerate().rev() {
                    range.touch(row);
                    let entries =
                        (0..length as u32).map(|j| (j, (10 * (k * together + row) + 1) as f64 + f64::from(j)));
                    range.fill(row, length, false, entries.rev());
                }
            }
            for (i, &length) in lengths.iter().enumerate() {
                let row: Vec<_> = matrix.row(i).collect();
                assert_eq!(row, (0..length).map(|j| (j, (10 * i + j + 1) as f64)).collect::<Vec<_>>());
            }
        }
    }
}
