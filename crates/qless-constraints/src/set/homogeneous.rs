//! Nonlinear equations of one type, in flat arrays, so that the inner loop knows the type and calls nothing at run time.

use std::any::Any;
use std::ops::Range;

use qless::{Csr, SystemError};

use super::block::Block;
use super::labels::Owner;
use super::order::Order;
use super::rounding::{Known, bound};
#[cfg(test)]
use super::tests::double_double::DoubleDouble;
use crate::constraint::Nonlinear;
use crate::derive;
use crate::scalar::Bounded;

/// Constraints per task, ...
const MANY: usize = 1024;
/// ... of types that take much arithmetic, of which there are fewer in most models: they reach further.
const FEW: usize = 256;
/// Constraints whose DOFs are gathered at once: looks into u that do not wait for one another, nor for arithmetic.
const AHEAD: usize = 64;
/// The most DOFs of a constraint for which so many are.
const NARROW: usize = 64;

/// Constraints of type Q.
pub(super) struct Homogeneous<Q> {
    pub items: Vec<Q>,
    owners: Vec<Owner>,
    /// Where the DOFs of each constraint start; one more than constraints.
    start: Vec<u32>,
    dofs: Vec<u32>,
    order: Order,
    /// Most DOFs of one constraint.
    pub widest: usize,
    /// How many numbers the Hessian of each constraint has, ...
    pub numbers: Vec<u32>,
    /// ... and, where they depend on the weight alone, those for a weight of 1: [`Homogeneous::UNITS`] of each constraint.
    pub units: Vec<f64>,
}

impl<Q> Default for Homogeneous<Q> {
    fn default() -> Self {
        let (dofs, numbers, units) = (Vec::new(), Vec::new(), Vec::new());
        Self {
            items: Vec::new(),
            owners: Vec::new(),
            start: vec![0],
            dofs,
            order: Order::default(),
            widest: 0,
            numbers,
            units,
        }
    }
}

impl<Q: Nonlinear> Homogeneous<Q> {
    pub fn push(&mut self, owner: Owner, dofs: &[u32], parameters: Q) {
        let (mut pairs, mut numbers) = (0, 0);
        parameters.pairs(dofs.len(), &mut |_, _| {
            numbers = numbers.max(Q::number(pairs) + 1);
            pairs += 1;
        });
        if Self::UNITS > 0 {
            numbers = Self::UNITS;
            let first = self.units.len();
            self.units.resize(first + Self::UNITS, 0.0);
            parameters.hessian(&[], &[1.0], &mut self.units[first..]);
        }
        self.numbers.push(numbers as u32);
        self.order.push(dofs);
        self.widest = self.widest.max(dofs.len());
        self.items.push(parameters);
        self.owners.push(owner);
        self.dofs.extend_from_slice(dofs);
        self.start.push(self.dofs.len() as u32);
    }

    #[inline]
    fn dofs(&self, i: usize) -> &[u32] {
        if Q::DOFS > 0 {
            return &self.dofs[i * Q::DOFS..][..Q::DOFS];
        }
        &self.dofs[self.start[i] as usize..self.start[i + 1] as usize]
    }

    /// Constraints whose DOFs are gathered at once.
    pub fn ahead(&self) -> usize {
        if self.widest <= NARROW { AHEAD } else { Q::AT_ONCE }
    }

    /// How many DOFs these constraints have.
    pub fn width(&self, items: Range<usize>) -> usize {
        (self.start[items.end] - self.start[items.start]) as usize
    }

    /// The DOFs of constraints that follow one another.
    #[inline]
    pub fn gather<'a>(&self, items: Range<usize>, u: &[f64], room: &'a mut [f64]) -> &'a mut [f64] {
        let dofs = &self.dofs[self.start[items.start] as usize..self.start[items.end] as usize];
        let local = &mut room[..dofs.len()];
        local.iter_mut().zip(dofs).for_each(|(x, &j)| *x = u[j as usize]);
        local
    }

    /// N is the number of DOFs of every constraint: loops of known length.
    fn evaluate_fixed<const N: usize>(&self, first: usize, u: &[f64], c: &mut [f64], g: &mut [f64]) {
        let rows = Q::PARTS.len();
        let items = self.items[first..].iter().zip(self.dofs[first * N..].as_chunks::<N>().0);
        let outputs = c.chunks_exact_mut(rows).zip(g.chunks_exact_mut(rows * N));
        for ((item, dofs), (c, g)) in items.zip(outputs) {
            let mut local = [0.0; N];
            (0..N).for_each(|k| local[k] = u[dofs[k] as usize]);
            item.value_and_jacobian(&local, c, g);
        }
    }

    fn evaluate_any(&self, first: usize, u: &[f64], c: &mut [f64], g: &mut [f64]) {
        let rows = Q::PARTS.len();
        let ahead = self.ahead();
        let mut room = vec![0.0; ahead * self.widest];
        let mut rest = g;
        for (k, c) in c.chunks_mut(ahead * rows).enumerate() {
            let from = first + k * ahead;
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

    /// The bounds of one constraint, in the order of its DOFs.
    fn rounding_of(&self, i: usize, known: &Known, c: &mut [f64], g: &mut [f64]) {
        let u: Vec<Bounded> = self.dofs(i).iter().map(|&j| known.dof(j)).collect();
        let zero = Bounded::from(0.0);
        let (mut value, mut slopes) = (vec![zero; c.len()], vec![zero; g.len()]);
        derive::jacobian(&self.items[i], &u, &mut value, &mut slopes);
        c.iter_mut().zip(value).for_each(|(c, of)| *c = bound(of));
        g.iter_mut().zip(slopes).for_each(|(g, of)| *g = bound(of));
    }
}

impl<Q: Nonlinear> Block for Homogeneous<Q> {
    fn rows(&self) -> usize {
        self.items.len() * Q::PARTS.len()
    }

    fn items(&self) -> usize {
        self.items.len()
    }

    fn owner(&self, row: usize) -> (&Owner, &'static str) {
        (&self.owners[row / Q::PARTS.len()], Q::PARTS[row % Q::PARTS.len()])
    }

    fn write_pattern(&mut self, g: &mut Csr) -> Result<(), SystemError> {
        for i in 0..self.items.len() {
            let mut sorted = self.dofs(i).to_vec();
            sorted.sort_unstable();
            for _ in Q::PARTS {
                g.push_row(sorted.iter().map(|&j| (j as usize, 0.0)))?;
            }
        }
        Ok(())
    }

    fn chunk(&self) -> usize {
        if Q::AT_ONCE > 1 { FEW } else { MANY }
    }

    fn task(&self, first: usize) -> (usize, usize) {
        let last = self.items.len().min(first + self.chunk());
        let dofs = (self.start[last] - self.start[first]) as usize;
        ((last - first) * Q::PARTS.len(), dofs * Q::PARTS.len())
    }

    fn first_dof(&self, i: usize) -> u32 {
        self.dofs(i).first().copied().unwrap_or(0)
    }

    fn evaluate(&self, first: usize, u: &[f64], c: &mut [f64], g: &mut [f64]) {
        match Q::DOFS {
            2 => self.evaluate_fixed::<2>(first, u, c, g),
            3 => self.evaluate_fixed::<3>(first, u, c, g),
            4 => self.evaluate_fixed::<4>(first, u, c, g),
            6 => self.evaluate_fixed::<6>(first, u, c, g),
            _ => self.evaluate_any(first, u, c, g),
        }
        let (rows, base) = (Q::PARTS.len(), self.start[first] as usize);
        let items = first..first + c.len() / rows;
        self.order.restore(items, |i| (self.start[i] as usize - base) * rows, rows, g);
    }

    fn rounding(&self, first: usize, known: &Known, c: &mut [f64], g: &mut [f64]) {
        let (rows, base) = (Q::PARTS.len(), self.start[first] as usize);
        let items = first..first + c.len() / rows;
        let mut rest = &mut *g;
        for (i, c) in items.clone().zip(c.chunks_exact_mut(rows)) {
            let own;
            (own, rest) = rest.split_at_mut(rows * self.width(i..i + 1));
            self.rounding_of(i, known, c, own);
        }
        self.order.restore(items, |i| (self.start[i] as usize - base) * rows, rows, g);
    }

    fn pairs(&self, i: usize, pair: &mut dyn FnMut(u32, u32, usize)) {
        let dofs = self.dofs(i);
        let mut count = 0;
        self.items[i].pairs(dofs.len(), &mut |j, k| {
            pair(dofs[j], dofs[k], Q::number(count));
            count += 1;
        });
    }

    fn numbers(&self, i: usize) -> usize {
        self.numbers[i] as usize
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

    fn set_time(&mut self, time: f64) {
        if !Q::DRIVEN {
            return;
        }
        self.items.iter_mut().for_each(|item| item.at_time(time));
        if Self::UNITS > 0 {
            let units = self.units.chunks_exact_mut(Self::UNITS);
            self.items.iter().zip(units).for_each(|(item, units)| item.hessian(&[], &[1.0], units));
        }
    }

    fn as_any(&mut self) -> &mut dyn Any {
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
            derive::jacobian(item, &local, &mut c, &mut g);
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
