//! A chunk: rows of H that one task writes. It has its pattern, the items that contribute to it, and the sums of their Hessian numbers.

use std::ops::Range;

use qless::common::Identity;

use crate::equations::hessian::key_sorter::KeySorter;
use crate::equations::hessian::sums::EntrySums;
use crate::equations::nonlinear::batch::NonlinearBatch;

/// Consecutive rows of H that one task writes.
pub struct HessianChunk {
    /// Renewed after each change of the pattern.
    pub stamp: Identity,
    pub rows: Range<u32>,
    /// End of each row; empty if there are no entries.
    end: Vec<u32>,
    col: Box<[u32]>,
    /// The items that contribute to these rows, by batch.
    pub shares: Vec<ChunkShare>,
    /// How the entries are summed from the Hessian numbers of all shares.
    sums: EntrySums,
}

/// Items of one batch that contribute to a chunk, and how many Hessian numbers they have in total.
pub struct ChunkShare {
    pub batch: u32,
    /// Items as ranges, ascending.
    pub items: Vec<Range<u32>>,
    numbers: usize,
}

impl ChunkShare {
    pub fn new(batch: u32) -> Self {
        Self { batch, items: Vec::new(), numbers: 0 }
    }

    /// Appends an item that has this many Hessian numbers.
    pub fn push(&mut self, i: u32, numbers: usize) {
        match self.items.last_mut().filter(|run| run.end == i) {
            Some(run) => run.end += 1,
            None => self.items.push(i..i + 1),
        }
        self.numbers += numbers;
    }
}

impl HessianChunk {
    /// No entries. All patterns without entries share one stamp.
    pub fn empty(rows: Range<u32>) -> Self {
        let (end, col) = (Vec::new(), Box::default());
        Self { stamp: Identity::NONE, rows, end, col, shares: Vec::new(), sums: EntrySums::default() }
    }

    pub fn entries(&self) -> usize {
        self.col.len()
    }

    /// The row that halves the entries; never the first row.
    pub fn middle(&self) -> u32 {
        let before = self.end.partition_point(|&end| (end as usize) < self.entries() / 2);
        self.rows.start + before.clamp(1, self.rows.len() - 1) as u32
    }

    /// Inserts the items of a batch that has none here yet.
    pub fn put(&mut self, share: ChunkShare) {
        let place = self.shares.partition_point(|other| other.batch < share.batch);
        self.shares.insert(place, share);
    }

    /// Rebuilds the pattern and the sums: the pairs of all items are collected and sorted, and duplicates are merged.
    ///
    /// `counts`: contributions to each row of H, if they are known.
    pub fn fill(&mut self, batches: &[Box<dyn NonlinearBatch>], counts: Option<&[u32]>, room: &mut ChunkScratch) {
        room.count(&self.shares, batches, &self.rows, counts);
        let numbers = room.gather(&self.shares, batches, &self.rows);
        room.sort(&mut self.end);
        self.col = room.col.as_slice().into();
        self.sums = EntrySums::new(numbers, &room.counts, &room.keys);
        self.stamp = Identity::new();
    }

    /// Writes the columns and the ends of its rows; the first row starts at `first`.
    pub fn write_pattern(&self, first: usize, end: &mut [usize], col: &mut [u32]) {
        let ends = self.end.iter().chain(std::iter::repeat(&0));
        end.iter_mut().zip(ends).for_each(|(to, &end)| *to = first + end as usize);
        col.copy_from_slice(&self.col);
    }

    /// Writes these rows of H; `numbers` is scratch memory.
    pub fn write(&self, weighted: &WeightedBatches, u: &[f64], numbers: &mut Vec<f64>, h: &mut [f64]) {
        let mut first = 0;
        for share in &self.shares {
            let last = first + share.numbers;
            numbers.resize(numbers.len().max(last), 0.0);
            let (batch, weights) = weighted.batches[share.batch as usize];
            batch.curvatures(&share.items, u, weights, &mut numbers[first..last]);
            first = last;
        }
        self.sums.write(numbers, h);
    }
}

/// Scratch memory for [`HessianChunk::fill`].
#[derive(Default)]
pub struct ChunkScratch {
    /// Position of each row's next key; its end when all keys are written.
    next: Vec<u32>,
    /// Keys `(column, number)`, row by row.
    keys: Vec<u64>,
    /// Number of keys of each entry.
    counts: Vec<u32>,
    col: Vec<u32>,
    ranks: KeySorter,
}

impl ChunkScratch {
    /// Computes where the keys of each row start, and the end of the last row.
    fn count(
        &mut self,
        shares: &[ChunkShare],
        batches: &[Box<dyn NonlinearBatch>],
        rows: &Range<u32>,
        known: Option<&[u32]>,
    ) {
        self.next.clear();
        self.next.resize(rows.len() + 1, 0);
        let counts = &mut self.next[1..];
        match known {
            Some(known) => counts.copy_from_slice(&known[rows.start as usize..rows.end as usize]),
            None => {
                shares.iter().for_each(|share| batches[share.batch as usize].count(&share.items, rows.start, counts));
            }
        }
        (0..rows.len()).for_each(|row| self.next[row + 1] += self.next[row]);
    }

    /// Writes the keys of all shares, row by row. Returns how many Hessian numbers these have.
    fn gather(&mut self, shares: &[ChunkShare], batches: &[Box<dyn NonlinearBatch>], rows: &Range<u32>) -> usize {
        // Old keys need no clearing: every counted position is overwritten.
        self.keys.resize(self.keys.len().max(self.next[rows.len()] as usize), 0);
        self.next.pop();
        let mut first = 0;
        for share in shares {
            let batch = &batches[share.batch as usize];
            batch.keys(&share.items, rows.start, first, (&mut self.next, &mut self.keys));
            first += share.numbers;
        }
        first
    }

    /// Sorts the keys of each row, and lists the columns.
    fn sort(&mut self, ends: &mut Vec<u32>) {
        let Self { next, keys, counts, col, ranks } = self;
        counts.clear();
        col.clear();
        ends.clear();
        let mut from = 0;
        for &end in &*next {
            let row = &mut keys[from..end as usize];
            let runs = ranks.sort(row);
            counts.extend_from_slice(runs);
            let mut first = 0;
            for &run in runs {
                col.push((row[first] >> 32) as u32);
                first += run as usize;
            }
            ends.push(col.len() as u32);
            from = end as usize;
        }
    }
}

/// Nonlinear batches with the weights of their equations.
pub struct WeightedBatches<'a> {
    pub batches: Vec<(&'a dyn NonlinearBatch, &'a [f64])>,
}

impl<'a> WeightedBatches<'a> {
    /// `weights` has one number per equation; those of the `linear` equations come first and are not used.
    pub fn new(batches: &'a [Box<dyn NonlinearBatch>], linear: usize, weights: &'a [f64]) -> Self {
        let mut rest = &weights[linear..];
        let mut all = Vec::with_capacity(batches.len());
        for batch in batches {
            let own;
            (own, rest) = rest.split_at(batch.rows());
            all.push((batch.as_ref(), own));
        }
        Self { batches: all }
    }
}
