//! [`NonlinearBatch`] and [`StagedNonlinear`] for the equations of any type; the loops behind them know the type.

use std::any::Any;
use std::ops::Range;
use std::slice;

use qless::common::Identity;

use crate::equations::dof_uses::UncertainDofs;
use crate::equations::layout::ChunkRows;
use crate::equations::nonlinear::batch::{NonlinearBatch, StagedNonlinear};
use crate::equations::nonlinear::pairs::HessianPairs;
use crate::equations::nonlinear::typed::{StagedItem, TypedBatch};
use crate::equations::nonlinear::{ItemPlace, NonlinearEquations};
use crate::equations::{EquationNames, EquationOwner, renumber};
use crate::nonlinear::Nonlinear;
#[cfg(test)]
use crate::nonlinear::jacobian;
use crate::scalar::Bounded;
#[cfg(test)]
use crate::scalar::double_double::DoubleDouble;

impl<Q: Nonlinear> NonlinearBatch for TypedBatch<Q> {
    fn stamp(&self) -> Identity {
        self.stamp.get()
    }

    fn rows(&self) -> usize {
        self.items.len() * Q::EQUATION_NAMES.len()
    }

    fn items(&self) -> usize {
        self.items.len()
    }

    fn is_full(&self) -> bool {
        self.items.len() >= Self::CAPACITY
    }

    fn owner(&self, row: usize) -> (EquationOwner, &'static str) {
        (self.owners[row / Q::EQUATION_NAMES.len()], Q::EQUATION_NAMES[row % Q::EQUATION_NAMES.len()])
    }

    fn constraint(&self, i: usize) -> u32 {
        self.owners[i].constraint
    }

    fn renumber_names(&mut self, names: Option<&[u32]>) {
        renumber(&mut self.owners, names);
    }

    fn equations_per_item(&self) -> usize {
        Q::EQUATION_NAMES.len()
    }

    fn nnz(&self) -> usize {
        self.dofs.len() * Q::EQUATION_NAMES.len()
    }

    fn write_pattern(&self, first: usize, end: &mut [usize], col: &mut [u32]) {
        if Q::EQUATION_NAMES.len() == 1 && self.order.is_empty() {
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
            for end in ends.by_ref().take(Q::EQUATION_NAMES.len()) {
                let own;
                (own, rest) = rest.split_at_mut(dofs.len());
                own.copy_from_slice(dofs);
                last += dofs.len();
                *end = last;
            }
        }
    }

    fn reach(&self) -> Range<u32> {
        let (least, most) = self.dofs.iter().fold((u32::MAX, 0), |(least, most), &j| (least.min(j), most.max(j)));
        least.min(most)..if self.dofs.is_empty() { 0 } else { most + 1 }
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
        let rows = Q::EQUATION_NAMES.len();
        self.order.restore(|i| self.span(i..i).start * rows, rows, g);
    }

    fn rounding(&self, known: &UncertainDofs, c: &mut [f64], g: &mut [f64]) {
        let rows = Q::EQUATION_NAMES.len();
        let mut rest = &mut *g;
        for (i, c) in c.chunks_exact_mut(rows).enumerate() {
            let own;
            (own, rest) = rest.split_at_mut(rows * self.width(i..i + 1));
            self.rounding_of(i, known, c, own);
        }
        self.order.restore(|i| self.span(i..i).start * rows, rows, g);
    }

    fn count(&self, items: &[Range<u32>], row: u32, counts: &mut [u32]) {
        let mut pairs = HessianPairs::default();
        for i in items.iter().cloned().flatten() {
            let dofs = self.dofs(i as usize);
            for (j, entries) in dofs.iter().zip(&pairs.for_item(&self.items[i as usize], dofs.len()).entries) {
                counts.get_mut(j.wrapping_sub(row) as usize).into_iter().for_each(|count| *count += entries);
            }
        }
    }

    fn touched(&self, i: usize, row: &mut dyn FnMut(u32)) {
        self.entries(slice::from_ref(&(i as u32..i as u32 + 1)), 0, |j, _, _| row(j));
    }

    fn assign_to_chunks(&self, items: &[Range<u32>], cut: &ChunkRows, out: &mut Vec<(u32, u32)>) {
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

    fn keys(&self, items: &[Range<u32>], row: u32, first: usize, (next, keys): (&mut [u32], &mut [u64])) {
        self.entries(items, first, |j, k, number| {
            if let Some(next) = next.get_mut(j.wrapping_sub(row) as usize) {
                keys[*next as usize] = u64::from(k) << 32 | u64::from(number);
                *next += 1;
            }
        });
    }

    fn numbers(&self, i: usize) -> usize {
        self.numbers_of(i)
    }

    fn curvatures(&self, items: &[Range<u32>], u: &[f64], w: &[f64], out: &mut [f64]) {
        let mut room = vec![0.0; self.widest];
        let mut rest = out;
        for run in items {
            let run = run.start as usize..run.end as usize;
            if Self::UNITS > 0 {
                let own;
                (own, rest) = rest.split_at_mut(run.len() * Self::UNITS);
                self.multiples(run, w, own);
                continue;
            }
            let numbers = self.numbers[run.clone()].iter().map(|&n| n as usize);
            let own;
            (own, rest) = rest.split_at_mut(numbers.sum());
            self.curvatures_of(run, u, w, own, &mut room);
        }
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
                item.at_time(time).map_err(|value| (i * Q::EQUATION_NAMES.len(), value))?;
            }
            self.units.take();
        }
        Ok(())
    }

    fn angles(&self, found: &mut dyn FnMut(usize, f64)) {
        if Q::DRIVEN {
            let angles = self.items.iter().enumerate().filter_map(|(i, item)| item.angle().map(|angle| (i, angle)));
            angles.for_each(|(i, angle)| found(i * Q::EQUATION_NAMES.len(), angle));
        }
    }

    fn split_off(&mut self, i: usize) -> Box<dyn NonlinearBatch> {
        Box::new(self.split(i))
    }

    fn take(&mut self, i: usize, names: &EquationNames, dofs: &mut Vec<u32>) -> Box<dyn StagedNonlinear> {
        Box::new(self.remove(i, names, dofs))
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
            let (mut c, mut g) =
                (vec![zero; Q::EQUATION_NAMES.len()], vec![zero; Q::EQUATION_NAMES.len() * dofs.len()]);
            jacobian(item, &local, &mut c, &mut g);
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
            crate::set::tests::compare::compare(item, self.gather(i..i + 1, u, &mut room));
        }
    }
}

impl<Q: Nonlinear> StagedNonlinear for StagedItem<Q> {
    fn rows(&self) -> usize {
        Q::EQUATION_NAMES.len()
    }

    fn kind(&self, nonlinear: &NonlinearEquations) -> Option<u32> {
        nonlinear.kind::<Q>()
    }

    fn at_time(&mut self, time: f64) -> Result<(), f64> {
        if Q::DRIVEN { self.parameters.at_time(time) } else { Ok(()) }
    }

    fn values(&self, dofs: &[u32], u: &[f64]) -> Vec<Bounded> {
        let local: Vec<Bounded> = dofs[self.dofs.clone()].iter().map(|&j| Bounded::from(u[j as usize])).collect();
        let mut c = vec![Bounded::from(0.0); Q::EQUATION_NAMES.len()];
        self.parameters.value(&local, &mut c);
        c
    }

    fn commit(
        self: Box<Self>,
        constraint: u32,
        dofs: &[u32],
        names: &mut EquationNames,
        nonlinear: &mut NonlinearEquations,
    ) {
        let Self { name, dofs: own, parameters } = *self;
        nonlinear.insert(EquationOwner { constraint, name: names.place(name) }, &dofs[own], parameters);
    }

    fn fits(&self, dofs: &[u32], (batch, item): ItemPlace, nonlinear: &NonlinearEquations) -> bool {
        let dofs = &dofs[self.dofs.clone()];
        nonlinear.typed::<Q>(batch).is_some_and(|batch| batch.alike(item, dofs, &self.parameters))
    }

    fn overwrite(
        self: Box<Self>,
        constraint: u32,
        names: &mut EquationNames,
        (batch, item): ItemPlace,
        nonlinear: &mut NonlinearEquations,
    ) {
        let owner = EquationOwner { constraint, name: names.place(self.name) };
        if let Some(batch) = nonlinear.typed_mut::<Q>(batch) {
            batch.overwrite(item, owner, self.parameters);
        }
    }
}
