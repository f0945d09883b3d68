//! `H = sum_r w_r H_r`: the plan that maps the Hessian of each constraint into H, and the sum itself.
//!
//! Rows of H are divided into chunks of about equal work. One task writes one chunk from all items that contribute to it, in their order.
//! No two tasks write the same entry, and the sum does not depend on the number of threads. An item that contributes to two chunks is
//! evaluated twice, which costs less than a lock.

pub mod chunk;
mod key_sorter;
pub mod sums;

use std::ops::Range;
use std::slice;
use std::sync::{Mutex, OnceLock, PoisonError};

use qless::common::Identity;
use qless::{Csr, SystemError};
use rayon::prelude::*;

use crate::equations::hessian::chunk::{ChunkScratch, ChunkShare, HessianChunk};
use crate::equations::layout::{ChunkRows, ENTRIES, write_csr};
use crate::equations::nonlinear::batch::NonlinearBatch;

/// The pattern of H, and the contributions to each chunk.
pub struct HessianPlan {
    cut: ChunkRows,
    pub chunks: Vec<HessianChunk>,
    /// Stamps of the batches that the plan was made for.
    stamps: Vec<Identity>,
}

impl HessianPlan {
    /// Divides the rows of H into chunks, and finds the items that contribute to each. O(1) if there are no nonlinear equations.
    pub fn new(batches: &[Box<dyn NonlinearBatch>], dofs: usize) -> Self {
        if batches.is_empty() {
            return Self {
                cut: ChunkRows::single(dofs),
                chunks: vec![HessianChunk::empty(0..dofs as u32)],
                stamps: Vec::new(),
            };
        }
        let counts = entries_per_row(batches, dofs);
        let cut = ChunkRows::new(&counts);
        let chunks = cut.chunks().map(HessianChunk::empty).collect();
        let mut plan = Self { cut, chunks, stamps: stamps(batches) };
        let all: Vec<u32> = (0..batches.len() as u32).collect();
        plan.assign_to_chunks(batches, &all);
        plan.chunks.par_iter_mut().for_each_init(ChunkScratch::default, |room, chunk| {
            chunk.fill(batches, Some(&counts), room);
        });
        plan
    }

    /// Updates the plan after changes of some batches; `touched` are the rows of H whose entries may have changed.
    pub fn updated(mut self, batches: &[Box<dyn NonlinearBatch>], touched: &[u32]) -> Self {
        let changed = self.renumber(batches);
        self.assign_to_chunks(batches, &changed);
        let mut stale = vec![false; self.chunks.len()];
        touched.iter().for_each(|&row| stale[self.cut.chunk_of(row)] = true);
        let chunks = self.chunks.par_iter_mut().zip(stale).filter(|(_, stale)| *stale);
        chunks.for_each_init(ChunkScratch::default, |room, (chunk, _)| chunk.fill(batches, None, room));
        let large = |chunk: &HessianChunk| chunk.entries() > 2 * ENTRIES && chunk.rows.len() > 1;
        while let Some(place) = self.chunks.iter().position(large) {
            self.split(place, batches);
        }
        self
    }

    /// Splits a chunk into two of about equal work.
    fn split(&mut self, place: usize, batches: &[Box<dyn NonlinearBatch>]) {
        let old = self.chunks.remove(place);
        let row = old.middle();
        self.chunks.insert(place, HessianChunk::empty(row..old.rows.end));
        self.chunks.insert(place, HessianChunk::empty(old.rows.start..row));
        self.cut.split(place, row);
        for share in &old.shares {
            for (chunk, share) in shares(batches, (share.batch, &share.items), &self.cut) {
                self.chunks[chunk as usize].put(share);
            }
        }
        self.cut.widen();
        self.chunks[place..place + 2]
            .iter_mut()
            .for_each(|chunk| chunk.fill(batches, None, &mut ChunkScratch::default()));
    }

    /// Renumbers the shares of unchanged batches, and drops those of all others. Returns the new batches.
    fn renumber(&mut self, batches: &[Box<dyn NonlinearBatch>]) -> Vec<u32> {
        let stamps = stamps(batches);
        let places = std::iter::zip(&stamps, 0..).collect::<std::collections::HashMap<_, u32>>();
        let place: Vec<Option<u32>> = self.stamps.iter().map(|stamp| places.get(stamp).copied()).collect();
        let mut new = vec![true; batches.len()];
        place.iter().flatten().for_each(|&place| new[place as usize] = false);
        for chunk in &mut self.chunks {
            chunk.shares.retain_mut(|share| match place[share.batch as usize] {
                Some(place) => {
                    share.batch = place;
                    true
                }
                None => false,
            });
        }
        self.stamps = stamps;
        (0..batches.len() as u32).filter(|&batch| new[batch as usize]).collect()
    }

    /// Assigns the items of these batches to the chunks that they contribute to.
    fn assign_to_chunks(&mut self, batches: &[Box<dyn NonlinearBatch>], which: &[u32]) {
        let items = |b: u32| 0..batches[b as usize].items() as u32;
        let all = |&b: &u32| shares(batches, (b, slice::from_ref(&items(b))), &self.cut);
        let shares: Vec<Vec<(u32, ChunkShare)>> = which.par_iter().map(all).collect();
        for (chunk, share) in shares.into_iter().flatten() {
            self.chunks[chunk as usize].put(share);
        }
    }

    /// The stamp and the number of rows of each chunk.
    pub fn layout(&self) -> Vec<(Identity, usize)> {
        self.chunks.iter().map(|chunk| (chunk.stamp, chunk.rows.len())).collect()
    }

    /// The rows of H of some chunks, with zeros as values.
    pub fn pattern(&self, chunks: Range<usize>) -> Result<Csr, SystemError> {
        let chunks = &self.chunks[chunks];
        let size = |chunk: &HessianChunk| (chunk.rows.len(), chunk.entries());
        write_csr(self.cut.rows(), chunks, size, |chunk, part| {
            chunk.write_pattern(part.first, part.end, part.col);
        })
    }
}

fn stamps(batches: &[Box<dyn NonlinearBatch>]) -> Vec<Identity> {
    batches.iter().map(|batch| batch.stamp()).collect()
}

/// The shares of some items of a batch, by chunk.
fn shares(
    batches: &[Box<dyn NonlinearBatch>],
    (b, items): (u32, &[Range<u32>]),
    cut: &ChunkRows,
) -> Vec<(u32, ChunkShare)> {
    let (batch, mut touched) = (&batches[b as usize], Vec::new());
    batch.assign_to_chunks(items, cut, &mut touched);
    touched.sort_unstable();
    let of_chunk = |same: &[(u32, u32)]| {
        let mut share = ChunkShare::new(b);
        same.iter().for_each(|&(_, i)| share.push(i, batch.numbers(i as usize)));
        (same[0].0, share)
    };
    touched.chunk_by(|a, b| a.0 == b.0).map(of_chunk).collect()
}

/// Largest number of threads that count contributions; each needs an array as long as the range of DOFs of its batches.
const MOST: usize = 8;

/// Number of contributions to each row of H, counted in parallel. Sums of integers do not depend on their order.
pub fn entries_per_row(batches: &[Box<dyn NonlinearBatch>], dofs: usize) -> Vec<u32> {
    let threads = rayon::current_num_threads().min(MOST);
    let parts = batches.par_chunks(batches.len().div_ceil(threads).max(1)).map(entries_of_batches).collect::<Vec<_>>();
    let mut all = vec![0; dofs];
    for (first, counts) in parts {
        all[first as usize..].iter_mut().zip(counts).for_each(|(sum, count)| *sum += count);
    }
    all
}

/// The first row that these batches contribute to, and the counts from there on.
fn entries_of_batches(batches: &[Box<dyn NonlinearBatch>]) -> (u32, Vec<u32>) {
    let hull = |a: Range<u32>, b: Range<u32>| a.start.min(b.start)..a.end.max(b.end);
    let rows = batches.iter().map(|batch| batch.reach()).reduce(hull).unwrap_or_default();
    let mut counts = vec![0; rows.len()];
    batches.iter().for_each(|batch| {
        batch.count(slice::from_ref(&(0..batch.items() as u32)), rows.start, &mut counts);
    });
    (rows.start, counts)
}

/// A plan that is made on request, by an update of the last one if there is one.
#[derive(Default)]
pub struct LazyPlan {
    current: OnceLock<HessianPlan>,
    /// The last plan, which is out of date, and the rows of H whose entries changed since.
    last: Mutex<Option<HessianPlan>>,
    touched: Vec<u32>,
}

impl LazyPlan {
    /// The plan for the current batches.
    pub fn plan(&self, batches: &[Box<dyn NonlinearBatch>], dofs: usize) -> &HessianPlan {
        if let Some(plan) = self.current.get() {
            return plan;
        }
        let last = self.last.lock().unwrap_or_else(PoisonError::into_inner).take();
        // After many changes a new plan is cheaper than an update.
        let known = last.filter(|_| self.touched.len() < dofs);
        let plan = known.map_or_else(|| HessianPlan::new(batches, dofs), |last| last.updated(batches, &self.touched));
        // The lock is not held here: threads that wait for others may take up a task that also asks for the plan. The first plan is kept.
        self.current.get_or_init(|| plan)
    }

    /// To be called before batches change: the current plan becomes the last one.
    pub fn outdate(&mut self) {
        let last = self.last.get_mut().unwrap_or_else(PoisonError::into_inner);
        if let Some(plan) = self.current.take() {
            *last = Some(plan);
            self.touched.clear();
        }
    }

    /// Whether there is a last plan that changes must be recorded for.
    pub fn is_wanted(&mut self) -> bool {
        self.last.get_mut().unwrap_or_else(PoisonError::into_inner).is_some()
    }

    /// Records the rows of H that all items of a new batch contribute to.
    pub fn touch_all(&mut self, batch: &dyn NonlinearBatch) {
        (0..batch.items()).for_each(|item| self.touch(batch, item));
    }

    /// Records the rows of H that an inserted or removed item contributes to.
    pub fn touch(&mut self, batch: &dyn NonlinearBatch, item: usize) {
        if self.is_wanted() {
            batch.touched(item, &mut |row| self.touched.push(row));
        }
    }
}
