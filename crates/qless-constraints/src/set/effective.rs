//! `H = sum_r w_r H_r`: where the Hessian of each constraint goes, and the sum itself.
//!
//! Rows of H are cut into chunks of about equal work. A task owns one chunk and takes all constraints that touch it, in their
//! order, so that no two tasks write the same entry and the sum does not depend on the threads. A constraint that
//! touches two chunks is evaluated twice, which costs less than a lock.

use std::ops::Range;

use qless::Csr;
use rayon::prelude::*;

use super::block::Block;
use super::pattern::{entries, pattern, position};
use super::sums::Sums;
use super::tasks::{Task, Work};

/// Entries of H per task: they stay in the cache of one core.
const ENTRIES: usize = 1 << 14;

/// The pattern of H and the way into it.
pub(super) struct Plan {
    start: Vec<usize>,
    col: Vec<u32>,
    chunks: Vec<Chunk>,
}

/// Rows of H that one task owns.
#[derive(Default)]
pub struct Chunk {
    last_row: u32,
    entries: usize,
    /// One share per block; blocks of no interest have none.
    shares: Vec<Share>,
    /// Entries from the numbers of all shares.
    sums: Sums,
}

/// Constraints of one block that touch a chunk, and how many numbers their Hessians have.
struct Share {
    block: usize,
    /// Constraints, in runs without gaps.
    items: Vec<Range<u32>>,
    numbers: usize,
}

impl Share {
    fn push(&mut self, i: u32, numbers: usize) {
        match self.items.last_mut().filter(|run| run.end == i) {
            Some(run) => run.end += 1,
            None => self.items.push(i..i + 1),
        }
        self.numbers += numbers;
    }
}

impl Plan {
    /// Cuts the rows of H into chunks, and finds the constraints and the places of their numbers for each.
    pub fn new(blocks: &[Box<dyn Block>], dofs: usize) -> Self {
        let (start, col) = pattern(blocks, dofs);
        let (chunk_of, first_rows) = cut(&start);
        let mut chunks: Vec<Chunk> = first_rows
            .windows(2)
            .map(|rows| Chunk {
                last_row: rows[1].saturating_sub(1) as u32,
                entries: start[rows[1]] - start[rows[0]],
                ..Chunk::default()
            })
            .collect();
        for (b, block) in blocks.iter().enumerate() {
            share_out(b, block.as_ref(), &chunk_of, &mut chunks);
        }
        let mut plan = Self { start, col, chunks };
        plan.find_places(blocks, &first_rows);
        plan
    }

    fn find_places(&mut self, blocks: &[Box<dyn Block>], first_rows: &[usize]) {
        let (start, col) = (&self.start, &self.col);
        self.chunks.par_iter_mut().zip(first_rows.par_windows(2)).for_each(|(chunk, rows)| {
            let inside = start[rows[0]]..start[rows[1]];
            let mut parts = Vec::with_capacity(inside.len());
            let mut first = 0;
            for share in &chunk.shares {
                for i in share.items.iter().cloned().flatten() {
                    entries(blocks[share.block].as_ref(), i as usize, &mut |j, k, number| {
                        let row = j as usize;
                        if (rows[0]..rows[1]).contains(&row) {
                            let place = position(&col[start[row]..start[row + 1]], k) + start[row] - inside.start;
                            parts.push((place as u32, (first + number) as u32));
                        }
                    });
                    first += blocks[share.block].numbers(i as usize);
                }
            }
            chunk.sums = Sums::new(inside.len(), first, parts);
        });
    }

    pub fn allocate(&self) -> Csr {
        let (start, col) = (self.start.clone(), self.col.clone());
        let zeros = vec![0.0; col.len()];
        Csr::from_parts(start.len() - 1, start, col, zeros).expect("rows are sorted and within the DOFs")
    }

    /// The tasks that write all entries.
    pub fn tasks<'a>(&'a self, weighted: &'a Weighted, out: &'a mut [f64]) -> Vec<Task<'a>> {
        let mut rest = out;
        let own = |chunk: &'a Chunk| {
            let h = rest.split_off_mut(..chunk.entries).unwrap_or_default();
            Task { dof: chunk.last_row, work: Work::Hessian { chunk, weighted, h } }
        };
        self.chunks.iter().map(own).collect()
    }
}

/// Blocks with the weights of their equations.
pub struct Weighted<'a> {
    blocks: Vec<(&'a dyn Block, &'a [f64])>,
}

impl<'a> Weighted<'a> {
    /// From one weight per equation, of which `linear` come first and have no share in H.
    pub fn new(blocks: &'a [Box<dyn Block>], linear: usize, weights: &'a [f64]) -> Self {
        let mut rest = &weights[linear..];
        let mut all = Vec::with_capacity(blocks.len());
        for block in blocks {
            let own;
            (own, rest) = rest.split_at(block.rows());
            all.push((block.as_ref(), own));
        }
        Self { blocks: all }
    }
}

impl Chunk {
    /// Writes these rows of H; `numbers` is room for the numbers of their constraints.
    pub fn write(&self, weighted: &Weighted, u: &[f64], numbers: &mut Vec<f64>, h: &mut [f64]) {
        let mut first = 0;
        for share in &self.shares {
            let last = first + share.numbers;
            numbers.resize(numbers.len().max(last), 0.0);
            let (block, weights) = weighted.blocks[share.block];
            block.curvatures(&share.items, u, weights, &mut numbers[first..last]);
            first = last;
        }
        self.sums.write(numbers, h);
    }
}

/// The chunk of each row, and the first row of each chunk, with one more at the end.
fn cut(start: &[usize]) -> (Vec<u32>, Vec<usize>) {
    let rows = start.len() - 1;
    let (mut chunk_of, mut first) = (Vec::with_capacity(rows), vec![0]);
    for row in 0..rows {
        if start[row + 1] - start[first[first.len() - 1]] > ENTRIES && row > first[first.len() - 1] {
            first.push(row);
        }
        chunk_of.push(first.len() as u32 - 1);
    }
    first.push(rows);
    (chunk_of, first)
}

/// Gives each constraint of a block to the chunks that it touches.
fn share_out(b: usize, block: &dyn Block, chunk_of: &[u32], chunks: &mut [Chunk]) {
    for i in 0..block.items() {
        let mut touched: Vec<u32> = Vec::new();
        block.pairs(i, &mut |j, k, _| touched.extend([chunk_of[j as usize], chunk_of[k as usize]]));
        touched.sort_unstable();
        touched.dedup();
        for chunk in touched {
            let shares = &mut chunks[chunk as usize].shares;
            if shares.last().is_none_or(|share| share.block != b) {
                shares.push(Share { block: b, items: Vec::new(), numbers: 0 });
            }
            if let Some(share) = shares.last_mut() {
                share.push(i as u32, block.numbers(i));
            }
        }
    }
}
