//! [`NonlinearBatch`] and [`StagedNonlinear`] for the equations of any type: virtual calls lead to the typed loops.

use std::any::Any;
use std::ops::Range;

use qless::common::Identity;

use crate::equations::coordinates::UncertainDofs;
use crate::equations::layout::ChunkRows;
use crate::equations::nonlinear::batch::{NonlinearBatch, StagedNonlinear};
use crate::equations::nonlinear::typed::{StagedItem, TypedBatch};
use crate::equations::nonlinear::{ItemPlace, NonlinearEquations};
use crate::equations::{EquationNames, EquationOwner, renumber};
use crate::nonlinear::Nonlinear;
#[cfg(test)]
use crate::nonlinear::jacobian;
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
        self.write_columns(first, end, col);
    }

    fn reach(&self) -> Range<u32> {
        self.hull()
    }

    fn last_dof(&self) -> u32 {
        self.items.len().checked_sub(1).and_then(|i| self.dofs(i).first().copied()).unwrap_or(0)
    }

    fn evaluate(&self, u: &[f64], c: &mut [f64], g: &mut [f64]) {
        self.write_values(u, c, g);
    }

    fn rounding(&self, known: &UncertainDofs, c: &mut [f64], g: &mut [f64]) {
        self.write_rounding(known, c, g);
    }

    fn count(&self, items: &[Range<u32>], row: u32, counts: &mut [u32]) {
        self.count_entries(items, row, counts);
    }

    fn touched(&self, i: usize, row: &mut dyn FnMut(u32)) {
        self.each_row(i, row);
    }

    fn assign_to_chunks(&self, items: &[Range<u32>], cut: &ChunkRows, out: &mut Vec<(u32, u32)>) {
        self.list_chunks(items, cut, out);
    }

    fn keys(&self, items: &[Range<u32>], row: u32, first: usize, next_and_keys: (&mut [u32], &mut [u64])) {
        self.write_keys(items, row, first, next_and_keys);
    }

    fn numbers(&self, i: usize) -> usize {
        self.numbers_of(i)
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
