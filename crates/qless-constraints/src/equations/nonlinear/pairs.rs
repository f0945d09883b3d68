//! Contributions of one type to H: for each pair of DOFs of an item, the row, column and chunk that its Hessian number belongs to.

use std::ops::Range;
use std::slice;

use crate::equations::layout::ChunkRows;
use crate::equations::nonlinear::typed::TypedBatch;
use crate::nonlinear::Nonlinear;

/// The pairs of the last item that was asked. They are reused for the next one if [`Nonlinear::SAME_PAIRS`] holds.
#[derive(Default)]
pub struct HessianPairs {
    dofs: Option<usize>,
    /// `[j, k, number]`: local DOFs, and index among the item's Hessian numbers.
    pub all: Vec<[u32; 3]>,
    /// Number of contributions to the row of each local DOF.
    pub entries: Vec<u32>,
}

impl HessianPairs {
    pub fn for_item<Q: Nonlinear>(&mut self, item: &Q, dofs: usize) -> &Self {
        if !Q::SAME_PAIRS || self.dofs != Some(dofs) {
            self.ask(item, dofs);
        }
        debug_assert!(self.are_those_of(item, dofs), "SAME_PAIRS is stated of a type whose pairs are not the same");
        self
    }

    fn ask<Q: Nonlinear>(&mut self, item: &Q, dofs: usize) {
        self.dofs = Some(dofs);
        self.all.clear();
        self.entries.clear();
        self.entries.resize(dofs, 0);
        item.pairs(dofs, &mut |j, k| {
            self.all.push([j as u32, k as u32, Q::number(self.all.len()) as u32]);
            self.entries[j] += 1;
            self.entries[k] += u32::from(j != k);
        });
    }

    fn are_those_of<Q: Nonlinear>(&self, item: &Q, dofs: usize) -> bool {
        let (mut rest, mut same) = (self.all.iter(), true);
        item.pairs(dofs, &mut |j, k| same &= rest.next().is_some_and(|pair| pair[..2] == [j as u32, k as u32]));
        same && rest.next().is_none()
    }
}

impl<Q: Nonlinear> TypedBatch<Q> {
    /// Calls `entry(row, column, number)` for each contribution of these items to H; numbers are counted from `first`.
    #[inline]
    fn entries(&self, items: &[Range<u32>], first: usize, mut entry: impl FnMut(u32, u32, u32)) {
        let (mut pairs, mut first) = (HessianPairs::default(), first as u32);
        for i in items.iter().cloned().flatten() {
            let dofs = self.dofs(i as usize);
            for &[j, k, number] in &pairs.for_item(&self.items[i as usize], dofs.len()).all {
                let (j, k, number) = (dofs[j as usize], dofs[k as usize], first + number);
                entry(j, k, number);
                if j != k {
                    entry(k, j, number);
                }
            }
            first += self.numbers_of(i as usize) as u32;
        }
    }

    /// Adds the contributions of these items to each row from `row` on.
    pub fn count_entries(&self, items: &[Range<u32>], row: u32, counts: &mut [u32]) {
        let mut pairs = HessianPairs::default();
        for i in items.iter().cloned().flatten() {
            let dofs = self.dofs(i as usize);
            for (j, entries) in dofs.iter().zip(&pairs.for_item(&self.items[i as usize], dofs.len()).entries) {
                counts.get_mut(j.wrapping_sub(row) as usize).into_iter().for_each(|count| *count += entries);
            }
        }
    }

    /// Calls `row` with each row to which item i contributes.
    pub fn each_row(&self, i: usize, mut row: impl FnMut(u32)) {
        self.entries(slice::from_ref(&(i as u32..i as u32 + 1)), 0, |j, _, _| row(j));
    }

    /// Appends `(chunk, item)` for each of these items and each reported chunk to which it contributes.
    pub fn list_chunks(&self, items: &[Range<u32>], cut: &ChunkRows, out: &mut Vec<(u32, u32)>) {
        let mut pairs = HessianPairs::default();
        for i in items.iter().cloned().flatten() {
            let dofs = self.dofs(i as usize);
            let mut chunks = dofs.iter().map(|&j| cut.chunk(j));
            let first = chunks.next().flatten();
            if chunks.all(|chunk| chunk == first) {
                out.extend(first.filter(|_| self.numbers_of(i as usize) > 0).map(|chunk| (chunk, i)));
                continue;
            }
            let known = out.len();
            let entries = &pairs.for_item(&self.items[i as usize], dofs.len()).entries;
            for (&j, _) in dofs.iter().zip(entries).filter(|&(_, &entries)| entries > 0) {
                let new = |chunk: &u32| out[known..].iter().all(|&(known, _)| known != *chunk);
                let chunk = cut.chunk(j).filter(new);
                out.extend(chunk.map(|chunk| (chunk, i)));
            }
        }
    }

    /// Writes the keys `(column, number)` of the contributions that were counted, at the positions `next` of each row.
    pub fn write_keys(&self, items: &[Range<u32>], row: u32, first: usize, (next, keys): (&mut [u32], &mut [u64])) {
        self.entries(items, first, |j, k, number| {
            if let Some(next) = next.get_mut(j.wrapping_sub(row) as usize) {
                keys[*next as usize] = u64::from(k) << 32 | u64::from(number);
                *next += 1;
            }
        });
    }
}
