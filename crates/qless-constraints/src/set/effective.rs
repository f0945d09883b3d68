//! `H = sum_r w_r H_r`: where the Hessian of each constraint goes, and the sum itself.
//!
//! Rows of H are cut into chunks of about equal work. A task owns one chunk and takes all constraints that touch it, in their
//! order, so that no two tasks write the same entry and the sum does not depend on the threads. A constraint that
//! touches two chunks is evaluated twice, which costs less than a lock.

use std::ops::Range;
use std::slice;

use qless::common::Identity;
use qless::{Csr, SystemError};
use rayon::prelude::*;

use super::block::Block;
use super::chunk::{Chunk, Room, Share};
use super::cut::{Cut, ENTRIES};
use super::entries;
use super::tasks::{Task, Work};

/// The pattern of H and the way into it.
pub(super) struct Plan {
    cut: Cut,
    chunks: Vec<Chunk>,
    /// Stamps of the blocks that it was made for.
    stamps: Vec<Identity>,
}

impl Plan {
    /// Cuts the rows of H into chunks, and finds the constraints and the places of their numbers for each.
    ///
    /// Where nothing is curved there is nothing to find.
    pub fn new(blocks: &[Box<dyn Block>], dofs: usize) -> Self {
        if blocks.is_empty() {
            return Self { cut: Cut::of_one(dofs), chunks: vec![Chunk::empty(0..dofs as u32)], stamps: Vec::new() };
        }
        let counts = entries::of_rows(blocks, dofs);
        let cut = Cut::new(&counts);
        let chunks = cut.chunks().map(Chunk::empty).collect();
        let mut plan = Self { cut, chunks, stamps: stamps(blocks) };
        let all: Vec<u32> = (0..blocks.len() as u32).collect();
        plan.share_out(blocks, &all);
        plan.chunks.par_iter_mut().for_each_init(Room::default, |room, chunk| {
            chunk.fill(blocks, Some(&counts), room);
        });
        plan
    }

    /// After changes of some blocks and of the entries in `touched` rows.
    pub fn updated(mut self, blocks: &[Box<dyn Block>], touched: &[u32]) -> Self {
        let changed = self.renumber(blocks);
        self.share_out(blocks, &changed);
        let mut stale = vec![false; self.chunks.len()];
        touched.iter().for_each(|&row| stale[self.cut.of(row)] = true);
        let chunks = self.chunks.par_iter_mut().zip(stale).filter(|(_, stale)| *stale);
        chunks.for_each_init(Room::default, |room, (chunk, _)| chunk.fill(blocks, None, room));
        let large = |chunk: &Chunk| chunk.entries() > 2 * ENTRIES && chunk.rows.len() > 1;
        while let Some(place) = self.chunks.iter().position(large) {
            self.split(place, blocks);
        }
        self
    }

    /// Cuts a chunk in two of about equal work.
    fn split(&mut self, place: usize, blocks: &[Box<dyn Block>]) {
        let old = self.chunks.remove(place);
        let row = old.middle();
        self.chunks.insert(place, Chunk::empty(row..old.rows.end));
        self.chunks.insert(place, Chunk::empty(old.rows.start..row));
        self.cut.split(place, row);
        for share in &old.shares {
            for (chunk, share) in shares(blocks, (share.block, &share.items), &self.cut) {
                self.chunks[chunk as usize].put(share);
            }
        }
        self.cut.widen();
        self.chunks[place..place + 2].iter_mut().for_each(|chunk| chunk.fill(blocks, None, &mut Room::default()));
    }

    /// Gives the shares of blocks that did not change their new places, and takes those of others away; the blocks that are new.
    fn renumber(&mut self, blocks: &[Box<dyn Block>]) -> Vec<u32> {
        let stamps = stamps(blocks);
        let places = std::iter::zip(&stamps, 0..).collect::<std::collections::HashMap<_, u32>>();
        let place: Vec<Option<u32>> = self.stamps.iter().map(|stamp| places.get(stamp).copied()).collect();
        let mut new = vec![true; blocks.len()];
        place.iter().flatten().for_each(|&place| new[place as usize] = false);
        for chunk in &mut self.chunks {
            chunk.shares.retain_mut(|share| match place[share.block as usize] {
                Some(place) => {
                    share.block = place;
                    true
                }
                None => false,
            });
        }
        self.stamps = stamps;
        (0..blocks.len() as u32).filter(|&block| new[block as usize]).collect()
    }

    /// Gives the constraints of some blocks to the chunks that they touch.
    fn share_out(&mut self, blocks: &[Box<dyn Block>], which: &[u32]) {
        let items = |b: u32| 0..blocks[b as usize].items() as u32;
        let all = |&b: &u32| shares(blocks, (b, slice::from_ref(&items(b))), &self.cut);
        let shares: Vec<Vec<(u32, Share)>> = which.par_iter().map(all).collect();
        for (chunk, share) in shares.into_iter().flatten() {
            self.chunks[chunk as usize].put(share);
        }
    }

    /// The stamp and the number of rows of each chunk.
    pub fn layout(&self) -> Vec<(Identity, usize)> {
        self.chunks.iter().map(|chunk| (chunk.stamp, chunk.rows.len())).collect()
    }

    /// The rows of H of some chunks, with zeros in them.
    pub fn pattern(&self, chunks: Range<usize>) -> Result<Csr, SystemError> {
        let chunks = &self.chunks[chunks];
        let size = |chunk: &Chunk| (chunk.rows.len(), chunk.entries());
        super::pattern::write(self.cut.rows(), chunks, size, |chunk, part| {
            chunk.write_pattern(part.first, part.end, part.col);
        })
    }

    /// The tasks that write all entries.
    pub fn tasks<'a>(&'a self, weighted: &'a Weighted, out: &'a mut [f64]) -> Vec<Task<'a>> {
        let mut rest = out;
        let own = |chunk: &'a Chunk| {
            let h = rest.split_off_mut(..chunk.entries()).unwrap_or_default();
            Task { dof: chunk.rows.end.saturating_sub(1), work: Work::Hessian { chunk, weighted, h } }
        };
        self.chunks.iter().map(own).collect()
    }
}

fn stamps(blocks: &[Box<dyn Block>]) -> Vec<Identity> {
    blocks.iter().map(|block| block.stamp()).collect()
}

/// The shares of some items of a block, by chunk.
fn shares(blocks: &[Box<dyn Block>], (b, items): (u32, &[Range<u32>]), cut: &Cut) -> Vec<(u32, Share)> {
    let (block, mut touched) = (&blocks[b as usize], Vec::new());
    block.share_out(items, cut, &mut touched);
    touched.sort_unstable();
    let of_chunk = |same: &[(u32, u32)]| {
        let mut share = Share::new(b);
        same.iter().for_each(|&(_, i)| share.push(i, block.numbers(i as usize)));
        (same[0].0, share)
    };
    touched.chunk_by(|a, b| a.0 == b.0).map(of_chunk).collect()
}

/// Blocks with the weights of their equations.
pub(super) struct Weighted<'a> {
    pub blocks: Vec<(&'a dyn Block, &'a [f64])>,
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
