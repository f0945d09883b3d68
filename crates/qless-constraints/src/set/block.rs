//! Nonlinear equations of one type, in flat arrays, so that the inner loop knows the type and calls nothing at run time.

use std::any::{Any, TypeId};
use std::collections::HashMap;

use qless::Csr;
use rayon::prelude::*;

use super::effective::Share;
use super::labels::Owner;
use crate::constraint::Nonlinear;

/// Constraints per task.
const CHUNK: usize = 1024;

/// Equations of one type.
pub(super) trait Block: Send + Sync {
    fn rows(&self) -> usize;
    fn nnz(&self) -> usize;
    fn items(&self) -> usize;
    fn owner(&self, row: usize) -> (&Owner, &'static str);
    /// Appends the rows of G, with zeros in them.
    fn write_pattern(&mut self, g: &mut Csr);
    fn evaluate(&self, u: &[f64], c: &mut [f64], g: &mut [f64]);
    /// Calls `pair` with the global DOFs of each pair of constraint `i`.
    fn pairs(&self, i: usize, pair: &mut dyn FnMut(u32, u32));
    /// Adds the share of these constraints to the rows of H that `out` holds.
    fn add_hessian(&self, u: &[f64], w: &[f64], share: &Share, out: &mut [f64]);
    fn as_any(&mut self) -> &mut dyn Any;
    /// Compares every formula with dual numbers.
    #[cfg(test)]
    fn compare_with_duals(&self, u: &[f64]);
}

/// All blocks, in the order of first use.
#[derive(Default)]
pub(super) struct Blocks {
    pub all: Vec<Box<dyn Block>>,
    of_type: HashMap<TypeId, usize>,
}

impl Blocks {
    pub fn rows(&self) -> usize {
        self.all.iter().map(|block| block.rows()).sum()
    }

    pub fn push<Q: Nonlinear>(&mut self, owner: Owner, dofs: &[u32], parameters: Q) {
        let next = self.all.len();
        let place = *self.of_type.entry(TypeId::of::<Q>()).or_insert(next);
        if place == next {
            self.all.push(Box::new(Homogeneous::<Q>::default()));
        }
        if let Some(block) = self.all[place].as_any().downcast_mut::<Homogeneous<Q>>() {
            block.push(owner, dofs, parameters);
        }
    }
}

/// In place of the first place of a list that ascends.
const IN_ORDER: u32 = u32::MAX;

/// Constraints of type Q.
struct Homogeneous<Q> {
    items: Vec<Q>,
    owners: Vec<Owner>,
    /// Where the DOFs of each constraint start; one more than constraints.
    start: Vec<u32>,
    dofs: Vec<u32>,
    /// Where each DOF stands in its rows of G, or [`IN_ORDER`]; empty if all lists ascend.
    place: Vec<u32>,
    /// Most DOFs of one constraint.
    widest: usize,
    /// Most pairs of one constraint.
    pairs: usize,
}

impl<Q> Default for Homogeneous<Q> {
    fn default() -> Self {
        let empty = Vec::new;
        Self {
            items: Vec::new(),
            owners: Vec::new(),
            start: vec![0],
            dofs: empty(),
            place: empty(),
            widest: 0,
            pairs: 0,
        }
    }
}

impl<Q: Nonlinear> Homogeneous<Q> {
    fn push(&mut self, owner: Owner, dofs: &[u32], parameters: Q) {
        let mut pairs = 0;
        parameters.pairs(dofs.len(), &mut |_, _| pairs += 1);
        self.pairs = self.pairs.max(pairs);
        self.widest = self.widest.max(dofs.len());
        self.items.push(parameters);
        self.owners.push(owner);
        self.dofs.extend_from_slice(dofs);
        self.start.push(self.dofs.len() as u32);
    }

    #[inline]
    fn range(&self, i: usize) -> std::ops::Range<usize> {
        if Q::DOFS > 0 {
            return i * Q::DOFS..i * Q::DOFS + Q::DOFS;
        }
        self.start[i] as usize..self.start[i + 1] as usize
    }

    #[inline]
    fn gather<'a>(&self, i: usize, u: &[f64], local: &'a mut [f64]) -> &'a mut [f64] {
        let dofs = &self.dofs[self.range(i)];
        let n = if Q::DOFS > 0 { Q::DOFS } else { dofs.len() };
        let local = &mut local[..n];
        local.iter_mut().zip(dofs).for_each(|(x, &j)| *x = u[j as usize]);
        local
    }

    /// Where each DOF comes among those of its constraint.
    fn places(&self) -> Vec<u32> {
        let mut place = vec![0; self.dofs.len()];
        for i in 0..self.items.len() {
            let range = self.range(i);
            let dofs = &self.dofs[range.clone()];
            let mut order: Vec<u32> = (0..dofs.len() as u32).collect();
            order.sort_unstable_by_key(|&k| dofs[k as usize]);
            order.iter().enumerate().for_each(|(p, &k)| place[range.start + k as usize] = p as u32);
            if dofs.is_sorted() && !dofs.is_empty() {
                place[range.start] = IN_ORDER;
            }
        }
        place
    }

    /// One task: constraints `first..` for as many as `c` has room.
    fn evaluate_chunk(&self, first: usize, u: &[f64], c: &mut [f64], g: &mut [f64]) {
        let rows = Q::PARTS.len();
        let mut local = vec![0.0; self.widest];
        let mut scratch = vec![0.0; self.widest * rows];
        let mut rest = g;
        for (i, c) in (first..).zip(c.chunks_exact_mut(rows)) {
            let local = self.gather(i, u, &mut local);
            let own;
            let n = if Q::DOFS > 0 { Q::DOFS } else { local.len() };
            (own, rest) = rest.split_at_mut(rows * n);
            let ascends = self.place.get(self.range(i).start).is_none_or(|&place| place == IN_ORDER);
            if ascends {
                self.items[i].value_and_jacobian(local, c, own);
            } else {
                let scratch = &mut scratch[..own.len()];
                self.items[i].value_and_jacobian(local, c, scratch);
                scatter(scratch, &self.place[self.range(i)], own);
            }
        }
    }
}

/// Adds each value at its place; those in rows of other tasks have a place beyond the end.
#[inline]
fn add(places: &[u32], values: impl Iterator<Item = f64>, out: &mut [f64]) {
    for (&place, value) in places.iter().zip(values) {
        if let Some(entry) = out.get_mut(place as usize) {
            *entry += value;
        }
    }
}

/// Columns of each row to their places.
fn scatter(from: &[f64], place: &[u32], to: &mut [f64]) {
    let n = place.len().max(1);
    for (from, to) in from.chunks_exact(n).zip(to.chunks_exact_mut(n)) {
        from.iter().zip(place).for_each(|(&v, &p)| to[p as usize] = v);
    }
}

impl<Q: Nonlinear> Block for Homogeneous<Q> {
    fn rows(&self) -> usize {
        self.items.len() * Q::PARTS.len()
    }

    fn nnz(&self) -> usize {
        self.dofs.len() * Q::PARTS.len()
    }

    fn items(&self) -> usize {
        self.items.len()
    }

    fn owner(&self, row: usize) -> (&Owner, &'static str) {
        (&self.owners[row / Q::PARTS.len()], Q::PARTS[row % Q::PARTS.len()])
    }

    fn write_pattern(&mut self, g: &mut Csr) {
        for i in 0..self.items.len() {
            let mut sorted = self.dofs[self.range(i)].to_vec();
            sorted.sort_unstable();
            for _ in Q::PARTS {
                g.push_row(sorted.iter().map(|&j| (j as usize, 0.0)));
            }
        }
        let ascending = |i| self.dofs[self.range(i)].is_sorted();
        if !(0..self.items.len()).all(ascending) {
            self.place = self.places();
        }
    }

    fn evaluate(&self, u: &[f64], c: &mut [f64], g: &mut [f64]) {
        let mut tasks = Vec::with_capacity(self.items.len() / CHUNK + 1);
        let mut rest = g;
        for (chunk, c) in c.chunks_mut(CHUNK * Q::PARTS.len()).enumerate() {
            let first = chunk * CHUNK;
            let last = first + c.len() / Q::PARTS.len();
            let own;
            (own, rest) = rest.split_at_mut((self.start[last] - self.start[first]) as usize * Q::PARTS.len());
            tasks.push((first, c, own));
        }
        tasks.into_par_iter().for_each(|(first, c, g)| self.evaluate_chunk(first, u, c, g));
    }

    fn pairs(&self, i: usize, pair: &mut dyn FnMut(u32, u32)) {
        let dofs = &self.dofs[self.range(i)];
        self.items[i].pairs(dofs.len(), &mut |j, k| pair(dofs[j], dofs[k]));
    }

    fn add_hessian(&self, u: &[f64], w: &[f64], share: &Share, out: &mut [f64]) {
        let rows = Q::PARTS.len();
        let mut local = vec![0.0; self.widest];
        let mut h = vec![0.0; self.pairs];
        let mut places = share.places.as_slice();
        for &i in &share.items {
            let i = i as usize;
            let from = share.mirror.of(i);
            let h = &mut h[..from.pairs];
            let local = if Q::QUADRATIC { &[][..] } else { self.gather(i, u, &mut local) };
            self.items[i].hessian(local, &w[i * rows..(i + 1) * rows], h);
            let (own, mirrored);
            (own, places) = places.split_at(from.pairs);
            (mirrored, places) = places.split_at(from.mirrored.len());
            add(own, h.iter().copied(), out);
            add(mirrored, from.mirrored.iter().map(|&k| h[k as usize]), out);
        }
    }

    fn as_any(&mut self) -> &mut dyn Any {
        self
    }

    #[cfg(test)]
    fn compare_with_duals(&self, u: &[f64]) {
        let mut local = vec![0.0; self.widest];
        for (i, item) in self.items.iter().enumerate() {
            super::tests::compare::compare(item, self.gather(i, u, &mut local));
        }
    }
}
