//! The rows of H, cut into chunks of about equal work.

use std::ops::Range;

/// Entries of constraints in the rows of a new chunk: those of H, of which several fall on one place, stay in the cache of one core.
pub(super) const ENTRIES: usize = 1 << 15;

/// To which chunk each row of H belongs.
#[derive(Default)]
pub(super) struct Cut {
    /// The first row of each chunk, and one more: the number of rows.
    first: Vec<u32>,
    /// The chunk of each row.
    chunk: Vec<u32>,
    /// If only some are of interest.
    only: Option<Range<u32>>,
}

impl Cut {
    /// From the entries of each row.
    pub fn new(counts: &[u32]) -> Self {
        let (mut first, mut entries) = (vec![0], 0);
        for (row, &count) in counts.iter().enumerate() {
            if entries > 0 && entries + count as usize > ENTRIES {
                first.push(row as u32);
                entries = 0;
            }
            entries += count as usize;
        }
        first.push(counts.len() as u32);
        let mut cut = Self { first, chunk: vec![0; counts.len()], only: None };
        cut.number_from(1);
        cut
    }

    /// One chunk of all rows.
    pub fn of_one(rows: usize) -> Self {
        Self { first: vec![0, rows as u32], chunk: vec![0; rows], only: None }
    }

    /// Cuts a chunk before this row; until the next cut, its halves alone are of interest.
    pub fn split(&mut self, chunk: usize, row: u32) {
        self.first.insert(chunk + 1, row);
        self.number_from(chunk + 1);
        self.only = Some(chunk as u32..chunk as u32 + 2);
    }

    /// All chunks are of interest.
    pub fn widen(&mut self) {
        self.only = None;
    }

    /// Numbers the rows of this chunk and of those behind it.
    fn number_from(&mut self, chunk: usize) {
        for (chunk, rows) in (0..).zip(self.first.windows(2)).skip(chunk) {
            self.chunk[rows[0] as usize..rows[1] as usize].fill(chunk);
        }
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.chunk.len()
    }

    /// The chunk of a row, whether it is of interest or not.
    pub fn of(&self, row: u32) -> usize {
        self.chunk[row as usize] as usize
    }

    pub fn chunks(&self) -> impl Iterator<Item = Range<u32>> + '_ {
        self.first.windows(2).map(|rows| rows[0]..rows[1])
    }

    /// The chunk of a row, if it is of interest.
    #[inline]
    pub fn chunk(&self, row: u32) -> Option<u32> {
        let chunk = self.chunk[row as usize];
        self.only.as_ref().is_none_or(|only| only.contains(&chunk)).then_some(chunk)
    }
}
