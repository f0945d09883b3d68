//! Rows of H that one task owns: their pattern, and where their numbers come from.

use std::ops::Range;

use qless::common::Identity;

use crate::equations::hessian::key_sorter::KeySorter;
use crate::equations::hessian::sums::EntrySums;
use crate::equations::nonlinear::batch::NonlinearBatch;

/// Rows of H that one task owns.
pub struct HessianChunk {
    /// Another one after each change of its pattern.
    pub stamp: Identity,
    pub rows: Range<u32>,
    /// Where each row ends; nothing if there are no entries yet.
    end: Vec<u32>,
    col: Box<[u32]>,
    /// One share per batch; batches of no interest have none.
    pub shares: Vec<ChunkItems>,
    /// Entries from the numbers of all shares.
    sums: EntrySums,
}

/// Items of one batch that touch a chunk, and how many numbers their Hessians have.
pub struct ChunkItems {
    pub batch: u32,
    /// Items, in runs without gaps.
    pub items: Vec<Range<u32>>,
    numbers: usize,
}

impl ChunkItems {
    pub fn new(batch: u32) -> Self {
        Self { batch, items: Vec::new(), numbers: 0 }
    }

    /// Appends an item with so many numbers.
    pub fn push(&mut self, i: u32, numbers: usize) {
        match self.items.last_mut().filter(|run| run.end == i) {
            Some(run) => run.end += 1,
            None => self.items.push(i..i + 1),
        }
        self.numbers += numbers;
    }
}

impl HessianChunk {
    /// No entries yet; all patterns without entries are alike.
    pub fn empty(rows: Range<u32>) -> Self {
        let (end, col) = (Vec::new(), Box::default());
        Self { stamp: Identity::NONE, rows, end, col, shares: Vec::new(), sums: EntrySums::default() }
    }

    pub fn entries(&self) -> usize {
        self.col.len()
    }

    /// The row before which about half of the entries are; neither the first nor beyond the last.
    pub fn middle(&self) -> u32 {
        let before = self.end.partition_point(|&end| (end as usize) < self.entries() / 2);
        self.rows.start + before.clamp(1, self.rows.len() - 1) as u32
    }

    /// Puts a share in its place; no other one is of the same batch.
    pub fn put(&mut self, share: ChunkItems) {
        let place = self.shares.partition_point(|other| other.batch < share.batch);
        self.shares.insert(place, share);
    }

    /// Makes the pattern and the sums anew from the shares: "all pair lists are combined and sorted, duplicates are eliminated".
    ///
    /// `counts`: how many entries of constraints are in each row, if that is known.
    pub fn fill(&mut self, batches: &[Box<dyn NonlinearBatch>], counts: Option<&[u32]>, room: &mut ChunkScratch) {
        room.count(&self.shares, batches, &self.rows, counts);
        let numbers = room.gather(&self.shares, batches, &self.rows);
        room.sort(&mut self.end);
        self.col = room.col.as_slice().into();
        self.sums = EntrySums::new(numbers, &room.counts, &room.keys);
        self.stamp = Identity::new();
    }

    /// Writes where its rows end, of which the first starts at `first`, and their columns.
    pub fn write_pattern(&self, first: usize, end: &mut [usize], col: &mut [u32]) {
        let ends = self.end.iter().chain(std::iter::repeat(&0));
        end.iter_mut().zip(ends).for_each(|(to, &end)| *to = first + end as usize);
        col.copy_from_slice(&self.col);
    }

    /// Writes these rows of H; `numbers` is room for the numbers of their constraints.
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

/// Room for what chunks are made from, one after the other.
#[derive(Default)]
pub struct ChunkScratch {
    /// Where each row ends, when the keys are there.
    next: Vec<u32>,
    /// `(column, number)` in one key, row by row.
    keys: Vec<u64>,
    /// How many keys have the column of each entry.
    counts: Vec<u32>,
    col: Vec<u32>,
    ranks: KeySorter,
}

impl ChunkScratch {
    /// Where the keys of each row start, and one more.
    fn count(
        &mut self,
        shares: &[ChunkItems],
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

    /// The keys of all shares, row by row; how many numbers these have.
    fn gather(&mut self, shares: &[ChunkItems], batches: &[Box<dyn NonlinearBatch>], rows: &Range<u32>) -> usize {
        // All of those that count are written.
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

    /// Sorts the keys of each row, and finds its columns.
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

/// Blocks with the weights of their equations.
pub struct WeightedBatches<'a> {
    pub batches: Vec<(&'a dyn NonlinearBatch, &'a [f64])>,
}

impl<'a> WeightedBatches<'a> {
    /// From one weight per equation, of which `linear` come first and have no share in H.
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
