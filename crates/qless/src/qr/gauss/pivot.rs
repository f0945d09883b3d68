//! Which entry is the pivot.
//!
//! A pivot is at least a tenth of the largest entry of its row and of its column, so that neither a row of R nor a
//! multiplier grows by more than ten. Of a row's entries that are large enough, the one in the column with the fewest
//! holders is taken. Where the columns of the first few hold much larger numbers, the search goes on in the row of one of
//! these: a row that has become small by cancellation waits, for its rounding errors are relatively large.

use super::eliminate::Elimination;
use super::row::{Entry, largest};

/// A pivot is at least this part of the largest entry of its row and column.
const THRESHOLD: f64 = 0.1;
/// How many entries of a row are tried.
const TRIED: usize = 4;

/// Fewest holders first, then the larger entry, then the earlier column.
type Rank = (u32, u64, u32);

impl Elimination {
    /// A row and a column for the pivot, from a row with an entry that is not zero; the column has been read.
    ///
    /// Ends, for the largest entry of the row looked at grows with every round.
    pub(super) fn choose(&mut self, mut row: u32) -> (u32, u32) {
        loop {
            match self.choose_in(row) {
                Ok(col) => return (row, col),
                Err(other) => row = other,
            }
        }
    }

    /// A column for this row, or a row to look at instead: the shortest with a much larger entry.
    fn choose_in(&mut self, row: u32) -> Result<u32, u32> {
        let bound = THRESHOLD * largest(&self.rows[row as usize]);
        let (mut last, mut elsewhere) = (None, None);
        for _ in 0..TRIED {
            let Some((rank, entry)) = self.best_after(last, row, bound) else { break };
            let (most, holder) = self.largest_in(entry.col);
            if entry.value.abs() >= THRESHOLD * most {
                return Ok(entry.col);
            }
            let other = (self.rows[holder as usize].len(), holder);
            elsewhere = Some(elsewhere.map_or(other, |best: (usize, u32)| best.min(other)));
            last = Some(rank);
        }
        Err(elsewhere.map_or(row, |(_, holder)| holder))
    }

    /// The best large entry of a row but for those already tried.
    fn best_after(&self, last: Option<Rank>, row: u32, bound: f64) -> Option<(Rank, Entry)> {
        let large = self.rows[row as usize].iter().filter(|entry| entry.value.abs() >= bound);
        let ranked = large.map(|&entry| {
            let holders = self.columns.count(entry.col);
            ((holders, !entry.value.abs().to_bits(), entry.col), entry)
        });
        ranked.filter(|(rank, _)| last.is_none_or(|last| *rank > last)).min_by_key(|&(rank, _)| rank)
    }

    /// Reads a column: its largest entry and the row that holds it.
    fn largest_in(&mut self, col: u32) -> (f64, u32) {
        self.columns.read(col, &self.rows, &self.queue, &mut self.column);
        let size = |&(i, place): &(u32, u32)| (self.rows[i as usize][place as usize].value.abs(), i);
        self.column.iter().map(size).fold((0.0, 0), |most, next| if next.0 > most.0 { next } else { most })
    }
}
