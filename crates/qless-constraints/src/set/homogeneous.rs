//! Nonlinear equations of one type, in flat arrays, so that the inner loop knows the type and calls nothing at run time.

use std::any::Any;
use std::ops::Range;
use std::slice;
use std::sync::OnceLock;

use qless::Identity;

use super::block::Block;
use super::effective::Cut;
use super::labels::{Owner, Parts, renumber};
use super::order::Order;
use super::pairs::Pairs;
use super::piece::Piece;
use super::rounding::{Known, bound};
use super::stamp::Stamp;
#[cfg(test)]
use super::tests::double_double::DoubleDouble;
use crate::constraint::Nonlinear;
use crate::scalar::Bounded;

/// Items per block, ...
const MANY: usize = 1024;
/// ... of types that take much arithmetic, of which there are fewer in most models: they reach further.
const FEW: usize = 256;
/// Items whose DOFs are gathered at once: looks into u that do not wait for one another, nor for arithmetic.
const AHEAD: usize = 64;
/// The most DOFs of an item for which so many are.
const NARROW: usize = 64;

/// Items of type Q: parameters, with the DOFs that they share.
pub(super) struct Homogeneous<Q> {
    pub stamp: Stamp,
    pub items: Vec<Q>,
    pub owners: Vec<Owner>,
    /// Where the DOFs of each item start, if that varies; one more than items.
    pub start: Vec<u32>,
    pub dofs: Vec<u32>,
    pub order: Order,
    /// Most DOFs of one item.
    pub widest: usize,
    /// How many numbers the Hessian of each item has, but where they depend on the weight alone: ...
    pub numbers: Vec<u32>,
    /// ... then there are [`Homogeneous::UNITS`] of each item, and these are those for a weight of 1, made when somebody needs them.
    pub units: OnceLock<Box<[f64]>>,
}

impl<Q> Default for Homogeneous<Q> {
    fn default() -> Self {
        Self {
            stamp: Stamp::default(),
            items: Vec::new(),
            owners: Vec::new(),
            start: vec![0],
            dofs: Vec::new(),
            order: Order::default(),
            widest: 0,
            numbers: Vec::new(),
            units: OnceLock::new(),
        }
    }
}

impl<Q: Nonlinear> Homogeneous<Q> {
    /// The most items.
    pub const CAPACITY: usize = if Q::AT_ONCE > 1 { FEW } else { MANY };

    #[inline]
    pub fn dofs(&self, i: usize) -> &[u32] {
        &self.dofs[self.span(i..i + 1)]
    }

    /// Where the DOFs of items are that follow one another.
    #[inline]
    pub fn span(&self, items: Range<usize>) -> Range<usize> {
        if Q::DOFS > 0 {
            return items.start * Q::DOFS..items.end * Q::DOFS;
        }
        self.start[items.start] as usize..self.start[items.end] as usize
    }

    /// Items whose DOFs are gathered at once.
    pub fn ahead(&self) -> usize {
        if self.widest <= NARROW { AHEAD } else { Q::AT_ONCE }
    }

    /// How many DOFs these items have.
    pub fn width(&self, items: Range<usize>) -> usize {
        self.span(items).len()
    }

    /// The DOFs of items that follow one another.
    #[inline]
    pub fn gather<'a>(&self, items: Range<usize>, u: &[f64], room: &'a mut [f64]) -> &'a mut [f64] {
        let dofs = &self.dofs[self.span(items)];
        let local = &mut room[..dofs.len()];
        local.iter_mut().zip(dofs).for_each(|(x, &j)| *x = u[j as usize]);
        local
    }

    /// N is the number of DOFs of every item: loops of known length.
    fn evaluate_fixed<const N: usize>(&self, u: &[f64], c: &mut [f64], g: &mut [f64]) {
        let rows = Q::PARTS.len();
        let items = self.items.iter().zip(self.dofs.as_chunks::<N>().0);
        let outputs = c.chunks_exact_mut(rows).zip(g.chunks_exact_mut(rows * N));
        for ((item, dofs), (c, g)) in items.zip(outputs) {
            let mut local = [0.0; N];
            (0..N).for_each(|k| local[k] = u[dofs[k] as usize]);
            item.value_and_jacobian(&local, c, g);
        }
    }

    fn evaluate_any(&self, u: &[f64], c: &mut [f64], g: &mut [f64]) {
        let rows = Q::PARTS.len();
        let ahead = self.ahead();
        let mut room = vec![0.0; ahead * self.widest];
        let mut rest = g;
        for (k, c) in c.chunks_mut(ahead * rows).enumerate() {
            let from = k * ahead;
            let mut local = &mut *self.gather(from..from + c.len() / rows, u, &mut room);
            for (k, c) in c.chunks_mut(Q::AT_ONCE * rows).enumerate() {
                let from = from + k * Q::AT_ONCE;
                let items = from..from + c.len() / rows;
                let (own, of_items);
                (of_items, local) = local.split_at_mut(self.width(items.clone()));
                (own, rest) = rest.split_at_mut(rows * of_items.len());
                Q::values_and_jacobians(&self.items[items], of_items, c, own);
            }
        }
    }

    /// The bounds of one item, in the order of its DOFs.
    fn rounding_of(&self, i: usize, known: &Known, c: &mut [f64], g: &mut [f64]) {
        let u: Vec<Bounded> = self.dofs(i).iter().map(|&j| known.dof(j)).collect();
        let zero = Bounded::from(0.0);
        let (mut value, mut slopes) = (vec![zero; c.len()], vec![zero; g.len()]);
        self.items[i].jacobian_in(&u, &mut value, &mut slopes);
        c.iter_mut().zip(value).for_each(|(c, of)| *c = bound(of));
        g.iter_mut().zip(slopes).for_each(|(g, of)| *g = bound(of));
    }

    /// Calls `entry(row, column, number)` for each entry of H that some items have, whose numbers are counted from `first`.
    #[inline]
    fn entries(&self, items: &[Range<u32>], first: usize, mut entry: impl FnMut(u32, u32, u32)) {
        let (mut pairs, mut first) = (Pairs::default(), first as u32);
        for i in items.iter().cloned().flatten() {
            let dofs = self.dofs(i as usize);
            for &[j, k, number] in &pairs.of(&self.items[i as usize], dofs.len()).all {
                let (j, k, number) = (dofs[j as usize], dofs[k as usize], first + number);
                entry(j, k, number);
                if j != k {
                    entry(k, j, number);
                }
            }
            first += self.numbers(i as usize) as u32;
        }
    }
}

impl<Q: Nonlinear> Block for Homogeneous<Q> {
    fn stamp(&self) -> Identity {
        self.stamp.get()
    }

    fn rows(&self) -> usize {
        self.items.len() * Q::PARTS.len()
    }

    fn items(&self) -> usize {
        self.items.len()
    }

    fn is_full(&self) -> bool {
        self.items.len() >= Self::CAPACITY
    }

    fn owner(&self, row: usize) -> (Owner, &'static str) {
        (self.owners[row / Q::PARTS.len()], Q::PARTS[row % Q::PARTS.len()])
    }

    fn constraint(&self, i: usize) -> u32 {
        self.owners[i].constraint
    }

    fn renumber_parts(&mut self, parts: Option<&[u32]>) {
        renumber(&mut self.owners, parts);
    }

    fn parts(&self) -> usize {
        Q::PARTS.len()
    }

    fn nnz(&self) -> usize {
        self.dofs.len() * Q::PARTS.len()
    }

    fn write_pattern(&self, first: usize, end: &mut [usize], col: &mut [u32]) {
        if Q::PARTS.len() == 1 && self.order.is_empty() {
            col.copy_from_slice(&self.dofs);
            return (0..end.len()).for_each(|i| end[i] = first + self.span(i..i + 1).end);
        }
        let (mut sorted, mut rest, mut last) = (Vec::new(), col, first);
        let mut ends = end.iter_mut();
        for i in 0..self.items.len() {
            let mut dofs = self.dofs(i);
            if !self.order.is_empty() && !dofs.is_sorted() {
                sorted.clear();
                sorted.extend_from_slice(dofs);
                sorted.sort_unstable();
                dofs = &sorted;
            }
            for end in ends.by_ref().take(Q::PARTS.len()) {
                let own;
                (own, rest) = rest.split_at_mut(dofs.len());
                own.copy_from_slice(dofs);
                last += dofs.len();
                *end = last;
            }
        }
    }

    fn last_dof(&self) -> u32 {
        self.items.len().checked_sub(1).and_then(|i| self.dofs(i).first().copied()).unwrap_or(0)
    }

    fn evaluate(&self, u: &[f64], c: &mut [f64], g: &mut [f64]) {
        match Q::DOFS {
            2 => self.evaluate_fixed::<2>(u, c, g),
            3 => self.evaluate_fixed::<3>(u, c, g),
            4 => self.evaluate_fixed::<4>(u, c, g),
            6 => self.evaluate_fixed::<6>(u, c, g),
            _ => self.evaluate_any(u, c, g),
        }
        let rows = Q::PARTS.len();
        self.order.restore(|i| self.span(i..i).start * rows, rows, g);
    }

    fn rounding(&self, known: &Known, c: &mut [f64], g: &mut [f64]) {
        let rows = Q::PARTS.len();
        let mut rest = &mut *g;
        for (i, c) in c.chunks_exact_mut(rows).enumerate() {
            let own;
            (own, rest) = rest.split_at_mut(rows * self.width(i..i + 1));
            self.rounding_of(i, known, c, own);
        }
        self.order.restore(|i| self.span(i..i).start * rows, rows, g);
    }

    fn count(&self, items: &[Range<u32>], row: u32, counts: &mut [u32]) {
        let mut pairs = Pairs::default();
        for i in items.iter().cloned().flatten() {
            let dofs = self.dofs(i as usize);
            for (j, entries) in dofs.iter().zip(&pairs.of(&self.items[i as usize], dofs.len()).entries) {
                counts.get_mut(j.wrapping_sub(row) as usize).into_iter().for_each(|count| *count += entries);
            }
        }
    }

    fn touched(&self, i: usize, row: &mut dyn FnMut(u32)) {
        self.entries(slice::from_ref(&(i as u32..i as u32 + 1)), 0, |j, _, _| row(j));
    }

    fn share_out(&self, items: &[Range<u32>], cut: &Cut, out: &mut Vec<(u32, u32)>) {
        for i in items.iter().cloned().flatten() {
            let mut chunks = self.dofs(i as usize).iter().map(|&j| cut.chunk(j));
            let first = chunks.next().flatten();
            if chunks.all(|chunk| chunk == first) {
                out.extend(first.filter(|_| self.numbers(i as usize) > 0).map(|chunk| (chunk, i)));
                continue;
            }
            let known = out.len();
            self.entries(slice::from_ref(&(i..i + 1)), 0, |j, _, _| {
                let new = |chunk: &u32| out[known..].iter().all(|&(known, _)| known != *chunk);
                let chunk = cut.chunk(j).filter(new);
                out.extend(chunk.map(|chunk| (chunk, i)));
            });
        }
    }

    fn keys(&self, items: &[Range<u32>], row: u32, first: usize, (next, keys): (&mut [u32], &mut [u64])) {
        self.entries(items, first, |j, k, number| {
            if let Some(next) = next.get_mut(j.wrapping_sub(row) as usize) {
                keys[*next as usize] = u64::from(k) << 32 | u64::from(number);
                *next += 1;
            }
        });
    }

    fn numbers(&self, i: usize) -> usize {
        if Self::UNITS > 0 { Self::UNITS } else { self.numbers[i] as usize }
    }

    fn curvatures(&self, items: &[Range<u32>], u: &[f64], w: &[f64], out: &mut [f64]) {
        self.write_curvatures(items, u, w, out);
    }

    fn rotation_vectors(&self, found: &mut dyn FnMut(&[u32], &[usize])) {
        let mut places = Vec::new();
        for (i, item) in self.items.iter().enumerate() {
            places.clear();
            item.rotation_vectors(&mut |place| places.push(place));
            found(self.dofs(i), &places);
        }
    }

    fn set_time(&mut self, time: f64) -> Result<(), (usize, f64)> {
        if Q::DRIVEN {
            for (i, item) in self.items.iter_mut().enumerate() {
                item.at_time(time).map_err(|value| (i * Q::PARTS.len(), value))?;
            }
            self.units.take();
        }
        Ok(())
    }

    fn angles(&self, found: &mut dyn FnMut(usize, f64)) {
        if Q::DRIVEN {
            let angles = self.items.iter().enumerate().filter_map(|(i, item)| item.angle().map(|angle| (i, angle)));
            angles.for_each(|(i, angle)| found(i * Q::PARTS.len(), angle));
        }
    }

    fn split_off(&mut self, i: usize) -> Box<dyn Block> {
        Box::new(self.split(i))
    }

    fn take(&mut self, i: usize, parts: &Parts, dofs: &mut Vec<u32>) -> Box<dyn Piece> {
        Box::new(self.remove(i, parts, dofs))
    }

    fn as_any(&self) -> &dyn Any {
        self
    }

    fn as_any_mut(&mut self) -> &mut dyn Any {
        self
    }

    #[cfg(test)]
    fn reference(&self, u: &[DoubleDouble]) -> [Vec<DoubleDouble>; 2] {
        let (mut all_c, mut all_g) = (Vec::new(), Vec::new());
        for (i, item) in self.items.iter().enumerate() {
            let dofs = self.dofs(i);
            let zero = DoubleDouble::from(0.0);
            let local: Vec<_> = dofs.iter().map(|&j| u[j as usize]).collect();
            let (mut c, mut g) = (vec![zero; Q::PARTS.len()], vec![zero; Q::PARTS.len() * dofs.len()]);
            crate::derive::jacobian(item, &local, &mut c, &mut g);
            all_c.extend(c);
            let mut columns: Vec<usize> = (0..dofs.len()).collect();
            columns.sort_unstable_by_key(|&k| dofs[k]);
            g.chunks_exact(dofs.len()).for_each(|row| all_g.extend(columns.iter().map(|&k| row[k])));
        }
        [all_c, all_g]
    }

    #[cfg(test)]
    fn compare_with_duals(&self, u: &[f64]) {
        let mut room = vec![0.0; self.widest];
        for (i, item) in self.items.iter().enumerate() {
            super::tests::compare::compare(item, self.gather(i..i + 1, u, &mut room));
        }
    }
}
