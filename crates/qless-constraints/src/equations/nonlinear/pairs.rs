//! Contributions of one type to H: for each pair of DOFs of an item, the row, column and chunk that its Hessian number belongs to.

use std::ops::Range;

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
    pub(super) fn entries(&self, items: &[Range<u32>], first: usize, mut entry: impl FnMut(u32, u32, u32)) {
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
}
