//! Which entry is the pivot.
//!
//! It is at least half the largest entry of its row, so that rows of R fall off from their diagonal and `R1^-1` stays small,
//! and at least a tenth of the largest of its column, so that no multiplier exceeds ten. Of the row's entries that are large
//! enough, the one in the column with the fewest holders is taken. Where the columns of the first few hold much larger
//! numbers, the search goes on in the row of one of these: a row that has become small by cancellation waits, for its
//! rounding errors are relatively large.
//!
//! Measured on mortar ties and a band of 1e5 rows: with a tenth for rows as well, R1 of the band has a smallest singular value
//! of 1e-18 instead of 1e-2; with 0.7, R has half as many entries again; with a hundredth for columns, ranks of ties are wrong.

use super::eliminate::GaussElimination;
use super::row::{GaussEntry, largest};

/// A pivot is at least this part of the largest entry of its row ...
const OF_ROW: f64 = 0.5;
/// ... and this part of the largest of its column.
const OF_COLUMN: f64 = 0.1;
/// How many entries of a row are tried.
const TRIED: usize = 4;

/// Fewest holders first, then the larger entry, then the earlier column.
type Rank = (u32, u64, u32);

impl GaussElimination {
    /// A row and a column for the pivot, from a row with an entry that is not zero; the column has been read.
    ///
    /// Ends, for the largest entry of the row grows with every round.
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
        let bound = OF_ROW * largest(&self.rows[row as usize]);
        let (mut last, mut elsewhere) = (None, None);
        for _ in 0..TRIED {
            let Some((rank, entry)) = self.best_after(last, row, bound) else { break };
            let (most, holder) = self.largest_in(entry.col);
            if entry.value.abs() >= OF_COLUMN * most {
                return Ok(entry.col);
            }
            let other = (self.rows[holder as usize].len(), holder);
            elsewhere = Some(elsewhere.map_or(other, |best: (usize, u32)| best.min(other)));
            last = Some(rank);
        }
        Err(elsewhere.map_or(row, |(_, holder)| holder))
    }

    /// The best large entry of a row but for those already tried.
    fn best_after(&self, last: Option<Rank>, row: u32, bound: f64) -> Option<(Rank, GaussEntry)> {
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
