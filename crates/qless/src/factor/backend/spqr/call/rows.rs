//! R by rows, from R by columns.

use std::collections::TryReserveError;
use std::ops::Range;

use rayon::prelude::*;

use super::{collected, reserved};
use crate::Csr;

/// R as C returns it: where each column starts, the row of each entry (in no promised order), its value.
#[derive(Clone, Copy)]
pub(super) struct InColumns<'a> {
    pub start: &'a [i64],
    pub row: &'a [i64],
    pub value: &'a [f64],
}

/// Where the entries of the result go.
#[derive(Clone, Copy)]
struct Places {
    col: *mut u32,
    val: *mut f64,
}

// SAFETY: threads write to places of their own, see `fill`.
unsafe impl Sync for Places {}

impl InColumns<'_> {
    /// Rows 0..rank without exact zeros, on so many threads of the caller's pool.
    ///
    /// By far the largest result, so it is written once, and may find no memory. Each thread takes some columns, and writes the
    /// part of each row that is in them behind the parts before.
    pub fn by_rows(self, rank: usize, threads: usize) -> Result<Csr, TryReserveError> {
        let parts = self.split(threads.max(1));
        let zeros = |_| collected(rank, std::iter::repeat(0));
        let mut places: Vec<Vec<usize>> = parts.iter().map(zeros).collect::<Result<_, _>>()?;
        let counting = |(part, counts): (&Range<usize>, &mut Vec<usize>)| self.count(part.clone(), counts);
        in_parallel(threads, &parts, &mut places, counting);
        let start = starts(rank, &mut places)?;
        let (mut col, mut val) = (reserved::<u32>(start[rank])?, reserved::<f64>(start[rank])?);
        let to = Places { col: col.as_mut_ptr(), val: val.as_mut_ptr() };
        // SAFETY: entry by entry as `count` counted them, so each has a place of its own below start[rank], which is reserved.
        let filling = |(part, next): (&Range<usize>, &mut Vec<usize>)| unsafe { self.fill(part.clone(), next, &to) };
        in_parallel(threads, &parts, &mut places, filling);
        // SAFETY: all places were written.
        unsafe {
            col.set_len(start[rank]);
            val.set_len(start[rank]);
        }
        Ok(Csr { cols: self.start.len() - 1, start, col, val })
    }

    /// Consecutive columns of about as many entries each.
    fn split(self, count: usize) -> Vec<Range<usize>> {
        let columns = self.start.len() - 1;
        let bound = |part: usize| self.start.partition_point(|&at| (at as usize) < self.row.len() / count * part);
        (0..count).map(|part| bound(part)..if part + 1 == count { columns } else { bound(part + 1) }).collect()
    }

    /// Rows and values of these columns.
    fn entries(self, columns: Range<usize>) -> impl Iterator<Item = (usize, f64)> {
        let range = self.start[columns.start] as usize..self.start[columns.end] as usize;
        self.row[range.clone()].iter().map(|&row| row as usize).zip(self.value[range].iter().copied())
    }

    /// Adds up how many entries that count each row has in these columns.
    fn count(self, columns: Range<usize>, counts: &mut [usize]) {
        for (row, value) in self.entries(columns) {
            if value != 0.0 && row < counts.len() {
                counts[row] += 1;
            }
        }
    }

    /// # Safety
    /// From `next[row]` on there are as many places as the row has entries in these columns, and they are nobody else's.
    unsafe fn fill(self, columns: Range<usize>, next: &mut [usize], to: &Places) {
        for j in columns {
            for (row, value) in self.entries(j..j + 1) {
                if value != 0.0 && row < next.len() {
                    let place = next[row];
                    // SAFETY: the caller's promise.
                    unsafe {
                        to.col.add(place).write(j as u32);
                        to.val.add(place).write(value);
                    }
                    next[row] = place + 1;
                }
            }
        }
    }
}

/// Where each row starts; turns counts, by part and row, into the first place of each.
fn starts(rank: usize, counts: &mut [Vec<usize>]) -> Result<Vec<usize>, TryReserveError> {
    let mut start = reserved(rank + 1)?;
    let mut place = 0;
    for row in 0..rank {
        start.push(place);
        for part in &mut *counts {
            place += std::mem::replace(&mut part[row], place);
        }
    }
    start.push(place);
    Ok(start)
}

fn in_parallel<A: Sync, B: Send>(threads: usize, a: &[A], b: &mut [B], work: impl Fn((&A, &mut B)) + Sync + Send) {
    if threads > 1 { a.par_iter().zip(b).for_each(work) } else { a.iter().zip(b).for_each(work) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_the_same_for_every_number_of_threads() {
        let (columns, rank) = (300, 250);
        let (mut start, mut row, mut value) = (vec![0], Vec::new(), Vec::new());
        let mut expected = vec![Vec::new(); rank];
        for j in 0..columns {
            // Not ascending, with exact zeros, and beyond the rank.
            for i in (0..=j).rev().filter(|i| (i * 7 + j * 5) % 11 < 4) {
                let entry = if (i + j) % 13 == 0 { 0.0 } else { (1 + i) as f64 / (1 + j) as f64 };
                row.push(i as i64);
                value.push(entry);
                if i < rank && entry != 0.0 {
                    expected[i].push((j, entry));
                }
            }
            start.push(row.len() as i64);
        }
        let in_columns = InColumns { start: &start, row: &row, value: &value };
        for threads in [1, 2, 3, 7, 1000] {
            let rows = in_columns.by_rows(rank, threads).expect("memory");
            assert_eq!((rows.cols, rows.rows()), (columns, rank));
            (0..rank).for_each(|i| assert_eq!(rows.row(i).collect::<Vec<_>>(), expected[i], "{threads} threads"));
        }
        let nothing = InColumns { start: &[0], row: &[], value: &[] }.by_rows(0, 2).expect("memory");
        assert_eq!((nothing.rows(), nothing.nnz()), (0, 0));
    }
}
