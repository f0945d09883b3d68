//! R by rows, from R by columns.

use std::collections::TryReserveError;
use std::mem::MaybeUninit;
use std::ops::Range;

use rayon::prelude::*;

use crate::Csr;

/// R as C returns it: where each column starts, the row of each entry (in no promised order), its value.
#[derive(Clone, Copy)]
pub(super) struct InColumns<'a> {
    pub start: &'a [i64],
    pub row: &'a [i64],
    pub value: &'a [f64],
}

/// Rows of the result, and the places of their entries.
struct Part<'a> {
    rows: Range<usize>,
    col: &'a mut [MaybeUninit<u32>],
    val: &'a mut [MaybeUninit<f64>],
}

impl InColumns<'_> {
    /// Rows 0..rank without exact zeros, on so many threads of the caller's pool.
    ///
    /// By far the largest result, so it is written once, and may find no memory.
    pub fn by_rows(self, rank: usize, threads: usize) -> Result<Csr, TryReserveError> {
        let start = self.starts(rank);
        let (mut col, mut val) = (reserved::<u32>(start[rank])?, reserved::<f64>(start[rank])?);
        let parts = split(&start, col.spare_capacity_mut(), val.spare_capacity_mut(), threads);
        let written: usize = if threads > 1 {
            parts.into_par_iter().map(|part| self.fill(part, &start)).sum()
        } else {
            parts.into_iter().map(|part| self.fill(part, &start)).sum()
        };
        assert_eq!(written, start[rank], "every entry has its place");
        // SAFETY: each part wrote row i from start[i] to start[i + 1], as many entries as were counted, so all of them.
        unsafe {
            col.set_len(start[rank]);
            val.set_len(start[rank]);
        }
        Ok(Csr { cols: self.start.len() - 1, start, col, val })
    }

    fn starts(self, rank: usize) -> Vec<usize> {
        let mut start = vec![0; rank + 1];
        for (&row, _) in self.row.iter().zip(self.value).filter(|(row, value)| **value != 0.0 && **row < rank as i64) {
            start[row as usize + 1] += 1;
        }
        (0..rank).for_each(|i| start[i + 1] += start[i]);
        start
    }

    /// How many entries it wrote.
    fn fill(self, part: Part, start: &[usize]) -> usize {
        let Part { rows, col, val } = part;
        let (first, offset) = (rows.start as i64, start[rows.start]);
        let count = rows.len() as u64;
        let mut next: Vec<usize> = start[rows].iter().map(|place| place - offset).collect();
        let mut written = 0;
        for (j, bounds) in self.start.windows(2).enumerate() {
            for k in bounds[0] as usize..bounds[1] as usize {
                // Rows above the part wrap round to large numbers.
                let row = (self.row[k] - first) as u64;
                if row < count && self.value[k] != 0.0 {
                    let place = &mut next[row as usize];
                    col[*place].write(j as u32);
                    val[*place].write(self.value[k]);
                    *place += 1;
                    written += 1;
                }
            }
        }
        written
    }
}

/// Consecutive rows of about as many entries each.
fn split<'a>(
    start: &[usize],
    mut col: &'a mut [MaybeUninit<u32>],
    mut val: &'a mut [MaybeUninit<f64>],
    count: usize,
) -> Vec<Part<'a>> {
    let (rank, entries, count) = (start.len() - 1, start[start.len() - 1], count.max(1));
    let mut parts = Vec::new();
    let mut from = 0;
    for part in 1..=count {
        let to = if part == count {
            rank
        } else {
            start.partition_point(|&place| place < entries / count * part).clamp(from, rank)
        };
        let length = start[to] - start[from];
        let (head, tail) = std::mem::take(&mut col).split_at_mut(length);
        let (head_val, tail_val) = std::mem::take(&mut val).split_at_mut(length);
        parts.push(Part { rows: from..to, col: head, val: head_val });
        (col, val, from) = (tail, tail_val, to);
    }
    parts
}

fn reserved<T>(length: usize) -> Result<Vec<T>, TryReserveError> {
    let mut values = Vec::new();
    values.try_reserve_exact(length)?;
    Ok(values)
}
