//! Rows of G in batches and rows of H in chunks: where each starts, what to replace after changes, and how the pattern is written.
//!
//! G and H are each a sequence of row groups: batches for G, chunks for H.

use std::collections::HashMap;
use std::ops::Range;

use qless::common::Identity;
use qless::{Csr, SystemError};
use rayon::prelude::*;

/// The stamp and the number of rows of each row group, in order.
pub type RowLayout = Vec<(Identity, usize)>;

/// Pairs of a row range of the old layout and the groups of the new layout that replace it.
///
/// Groups that are in both layouts must have the same order in both.
pub fn differences(old: &[(Identity, usize)], new: &[(Identity, usize)]) -> Vec<(Range<usize>, Range<usize>)> {
    let places: HashMap<Identity, usize> = new.iter().enumerate().map(|(place, group)| (group.0, place)).collect();
    let (mut all, mut row, mut gone, mut next) = (Vec::new(), 0, 0, 0);
    for &(stamp, rows) in old {
        if let Some(&place) = places.get(&stamp) {
            if gone < row || next < place {
                all.push((gone..row, next..place));
            }
            (gone, next) = (row + rows, place + 1);
        }
        row += rows;
    }
    if gone < row || next < new.len() {
        all.push((gone..row, next..new.len()));
    }
    all
}

/// The arrays of one row group in a compressed sparse row matrix.
pub struct RowSlice<'a> {
    /// Number of entries in the rows before this group.
    pub first: usize,
    /// End of each row.
    pub end: &'a mut [usize],
    pub col: &'a mut [u32],
    /// Values, zero at first.
    pub val: &'a mut [f64],
}

/// Builds a matrix from row groups in parallel: `size` gives the rows and entries of a group, `write` fills its arrays.
pub fn write_csr<S: Sync>(
    cols: usize,
    groups: &[S],
    size: impl Fn(&S) -> (usize, usize),
    write: impl Fn(&S, RowSlice) + Sync,
) -> Result<Csr, SystemError> {
    let sum = |(rows, entries), group| (rows + size(group).0, entries + size(group).1);
    let (rows, entries) = groups.iter().fold((0, 0), sum);
    let (mut start, mut col, mut val) = (vec![0; rows + 1], vec![0; entries], vec![0.0; entries]);
    let mut rest = (&mut start[1..], col.as_mut_slice(), val.as_mut_slice());
    let mut first = 0;
    let mut parts = Vec::with_capacity(groups.len());
    for group in groups {
        let (rows, entries) = size(group);
        let (end, own_col, own_val);
        (end, rest.0) = rest.0.split_at_mut(rows);
        (own_col, rest.1) = rest.1.split_at_mut(entries);
        (own_val, rest.2) = rest.2.split_at_mut(entries);
        parts.push((group, RowSlice { first, end, col: own_col, val: own_val }));
        first += entries;
    }
    parts.into_par_iter().for_each(|(group, part)| write(group, part));
    Csr::from_parts(cols, start, col, val)
}

/// Largest number of contributions to a new chunk, so that its entries, which are fewer, fit into the cache of one core.
pub const ENTRIES: usize = 1 << 15;

/// Assigns the rows of H to chunks of about equal work.
#[derive(Default)]
pub struct ChunkRows {
    /// The first row of each chunk, and at the end the number of rows.
    first: Vec<u32>,
    /// The chunk of each row.
    chunk: Vec<u32>,
    /// The chunks that [`ChunkRows::chunk`] reports; all if `None`.
    only: Option<Range<u32>>,
}

impl ChunkRows {
    /// Forms chunks from the number of contributions to each row.
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

    /// One chunk that holds all rows.
    pub fn single(rows: usize) -> Self {
        Self { first: vec![0, rows as u32], chunk: vec![0; rows], only: None }
    }

    /// Splits a chunk before `row`. Until [`ChunkRows::widen`], [`ChunkRows::chunk`] reports the two halves only.
    pub fn split(&mut self, chunk: usize, row: u32) {
        self.first.insert(chunk + 1, row);
        self.number_from(chunk + 1);
        self.only = Some(chunk as u32..chunk as u32 + 2);
    }

    /// Lets [`ChunkRows::chunk`] report all chunks again.
    pub fn widen(&mut self) {
        self.only = None;
    }

    /// Updates the chunk numbers of all rows from this chunk on.
    fn number_from(&mut self, chunk: usize) {
        for (chunk, rows) in (0..).zip(self.first.windows(2)).skip(chunk) {
            self.chunk[rows[0] as usize..rows[1] as usize].fill(chunk);
        }
    }

    pub fn rows(&self) -> usize {
        self.chunk.len()
    }

    /// The chunk of a row.
    pub fn chunk_of(&self, row: u32) -> usize {
        self.chunk[row as usize] as usize
    }

    pub fn chunks(&self) -> impl Iterator<Item = Range<u32>> + '_ {
        self.first.windows(2).map(|rows| rows[0]..rows[1])
    }

    /// The chunk of a row, if it is among the reported ones.
    #[inline]
    pub fn chunk(&self, row: u32) -> Option<u32> {
        let chunk = self.chunk[row as usize];
        self.only.as_ref().is_none_or(|only| only.contains(&chunk)).then_some(chunk)
    }
}
