//! Rows of H that one task owns: their pattern, and where their numbers come from.

use std::ops::Range;

use qless::Identity;

use super::block::{Block, Entry};
use super::effective::Weighted;
use super::sums::Sums;

/// Rows of H that one task owns.
pub(super) struct Chunk {
    /// Another one after each change of its pattern.
    pub stamp: Identity,
    pub rows: Range<u32>,
    /// Where each row ends.
    end: Vec<u32>,
    col: Vec<u32>,
    /// One share per block; blocks of no interest have none.
    pub shares: Vec<Share>,
    /// Entries from the numbers of all shares.
    sums: Sums,
}

/// Items of one block that touch a chunk, and how many numbers their Hessians have.
pub(super) struct Share {
    pub block: u32,
    /// Items, in runs without gaps.
    pub items: Vec<Range<u32>>,
    numbers: usize,
}

impl Share {
    pub fn new(block: u32) -> Self {
        Self { block, items: Vec::new(), numbers: 0 }
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

impl Chunk {
    /// No entries yet.
    pub fn new(rows: Range<u32>) -> Self {
        let end = vec![0; rows.len()];
        Self { stamp: Identity::new(), rows, end, col: Vec::new(), shares: Vec::new(), sums: Sums::default() }
    }

    pub fn entries(&self) -> usize {
        self.col.len()
    }

    /// The row before which about half of the entries are; neither the first nor beyond the last.
    pub fn middle(&self) -> u32 {
        let before = self.end.partition_point(|&end| (end as usize) < self.entries() / 2);
        self.rows.start + before.clamp(1, self.rows.len() - 1) as u32
    }

    /// Puts a share in its place; no other one is of the same block.
    pub fn put(&mut self, share: Share) {
        let place = self.shares.partition_point(|other| other.block < share.block);
        self.shares.insert(place, share);
    }

    /// Makes the pattern and the sums anew from the shares: "all pair lists are combined and sorted, duplicates are eliminated".
    pub fn fill(&mut self, blocks: &[Box<dyn Block>]) {
        let (mut all, mut first) = (Vec::new(), 0);
        for share in &self.shares {
            blocks[share.block as usize].entries(&share.items, &self.rows, first, &mut all);
            first += share.numbers;
        }
        let (mut keys, ends) = by_row(&all, &self.rows);
        drop(all);
        let mut parts = Vec::with_capacity(keys.len());
        self.col.clear();
        self.end.clear();
        let mut from = 0;
        for end in ends {
            let row = &mut keys[from..end as usize];
            row.sort_unstable();
            for same in row.chunk_by(|a, b| a >> 32 == b >> 32) {
                parts.extend(same.iter().map(|&key| (self.col.len() as u32, key as u32)));
                self.col.push((same[0] >> 32) as u32);
            }
            self.end.push(self.col.len() as u32);
            from = end as usize;
        }
        self.col.shrink_to_fit();
        self.sums = Sums::new(self.col.len(), first, &parts);
        self.stamp = Identity::new();
    }

    /// Appends where its rows end, and their columns.
    pub fn write_pattern(&self, end: &mut Vec<usize>, col: &mut Vec<u32>) {
        let before = col.len();
        end.extend(self.end.iter().map(|&end| before + end as usize));
        col.extend_from_slice(&self.col);
    }

    /// Writes these rows of H; `numbers` is room for the numbers of their constraints.
    pub fn write(&self, weighted: &Weighted, u: &[f64], numbers: &mut Vec<f64>, h: &mut [f64]) {
        let mut first = 0;
        for share in &self.shares {
            let last = first + share.numbers;
            numbers.resize(numbers.len().max(last), 0.0);
            let (block, weights) = weighted.blocks[share.block as usize];
            block.curvatures(&share.items, u, weights, &mut numbers[first..last]);
            first = last;
        }
        self.sums.write(numbers, h);
    }
}

/// `(column, number)` in one key, row by row, and where each row ends.
fn by_row(all: &[Entry], rows: &Range<u32>) -> (Vec<u64>, Vec<u32>) {
    let mut next = vec![0_u32; rows.len() + 1];
    all.iter().for_each(|entry| next[(entry.row - rows.start) as usize + 1] += 1);
    (0..rows.len()).for_each(|row| next[row + 1] += next[row]);
    let mut keys = vec![0; all.len()];
    for entry in all {
        let place = &mut next[(entry.row - rows.start) as usize];
        keys[*place as usize] = u64::from(entry.col) << 32 | u64::from(entry.number);
        *place += 1;
    }
    next.pop();
    (keys, next)
}
