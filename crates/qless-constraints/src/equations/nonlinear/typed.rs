//! A batch of one type: parameters and DOFs in flat arrays, so that loops know the type and need no virtual calls.

use std::any::Any;
use std::borrow::Cow;
use std::ops::Range;

use crate::equations::dof_uses::{UncertainDofs, bound};
use crate::equations::nonlinear::{NonlinearBatch, NonlinearEquations, StagedNonlinear};
use crate::equations::{EquationNames, EquationOwner};
use crate::nonlinear::Nonlinear;
#[cfg(test)]
use crate::nonlinear::jacobian;
use crate::scalar::Bounded;
#[cfg(test)]
use crate::scalar::double_double::DoubleDouble;

/// The batch of all items whose parameters have the type Q.
pub struct TypedBatch<Q> {
    items: Vec<Q>,
    owners: Vec<EquationOwner>,
    /// Start of each item's DOFs, and at the end the number of DOFs.
    start: Vec<usize>,
    dofs: Vec<u32>,
    /// How many numbers [`Nonlinear::hessian`] computes for each item.
    numbers: Vec<u32>,
}

impl<Q> Default for TypedBatch<Q> {
    fn default() -> Self {
        Self { items: Vec::new(), owners: Vec::new(), start: vec![0], dofs: Vec::new(), numbers: Vec::new() }
    }
}

/// An item that is not in a batch, since its constraint is new or inactive.
pub struct StagedItem<Q> {
    pub name: Cow<'static, str>,
    /// Positions of the item's DOFs in the list of DOFs of all items of its constraint.
    pub dofs: Range<usize>,
    pub parameters: Q,
}

impl<Q: Nonlinear> TypedBatch<Q> {
    fn dofs(&self, i: usize) -> &[u32] {
        &self.dofs[self.start[i]..self.start[i + 1]]
    }

    /// Copies the DOF values of an item into `local`.
    fn gather(&self, i: usize, u: &[f64], local: &mut Vec<f64>) {
        local.clear();
        local.extend(self.dofs(i).iter().map(|&j| u[j as usize]));
    }

    /// Inserts an item of the constraint `owner.constraint`. Items are sorted by their constraints; the new one comes last among those of
    /// its constraint.
    pub fn insert(&mut self, owner: EquationOwner, dofs: &[u32], parameters: Q) {
        let i = self.owners.partition_point(|other| other.constraint <= owner.constraint);
        let first = self.start[i];
        self.start[i + 1..].iter_mut().for_each(|start| *start += dofs.len());
        self.start.insert(i + 1, first + dofs.len());
        self.dofs.splice(first..first, dofs.iter().copied());
        self.numbers.insert(i, numbers(&parameters, dofs.len()));
        self.items.insert(i, parameters);
        self.owners.insert(i, owner);
    }

    /// Writes c and the Jacobian of items with N DOFs each. N is a constant, so that loops have a fixed length.
    fn evaluate_fixed<const N: usize>(&self, items: Range<usize>, u: &[f64], c: &mut [f64], g: &mut [f64]) {
        let rows = Q::EQUATION_NAMES.len();
        let dofs = self.dofs[N * items.start..N * items.end].as_chunks::<N>().0;
        let outputs = c.chunks_exact_mut(rows).zip(g.chunks_exact_mut(rows * N));
        for ((item, dofs), (c, g)) in self.items[items].iter().zip(dofs).zip(outputs) {
            let local: [f64; N] = std::array::from_fn(|k| u[dofs[k] as usize]);
            item.value_and_jacobian(&local, c, g);
            in_columns(dofs, g);
        }
    }

    /// Calls `of(item, c, Jacobian)` for some items, and sorts the rows of each Jacobian by column.
    fn for_each(
        &self,
        items: Range<usize>,
        c: &mut [f64],
        g: &mut [f64],
        mut of: impl FnMut(usize, &mut [f64], &mut [f64]),
    ) {
        let (rows, mut rest) = (Q::EQUATION_NAMES.len(), g);
        for (i, c) in items.zip(c.chunks_exact_mut(rows)) {
            let own;
            (own, rest) = rest.split_at_mut(rows * self.dofs(i).len());
            of(i, c, own);
            in_columns(self.dofs(i), own);
        }
    }
}

/// Sorts the entries of each row by column. The DOFs of most items ascend already; then nothing moves.
fn in_columns(dofs: &[u32], g: &mut [f64]) {
    if !dofs.is_sorted() {
        let mut order: Vec<usize> = (0..dofs.len()).collect();
        order.sort_unstable_by_key(|&k| dofs[k]);
        for row in g.chunks_exact_mut(dofs.len()) {
            let unsorted = row.to_vec();
            row.iter_mut().zip(&order).for_each(|(v, &k)| *v = unsorted[k]);
        }
    }
}

/// How many numbers [`Nonlinear::hessian`] computes for an item.
fn numbers<Q: Nonlinear>(parameters: &Q, dofs: usize) -> u32 {
    let mut pairs = 0;
    parameters.pairs(dofs, &mut |_, _| pairs += 1);
    (0..pairs).map(|pair| Q::number(pair) as u32 + 1).max().unwrap_or(0)
}

fn pairs<Q: Nonlinear>(parameters: &Q, dofs: usize) -> Vec<(usize, usize)> {
    let mut all = Vec::new();
    parameters.pairs(dofs, &mut |j, k| all.push((j, k)));
    all
}

impl<Q: Nonlinear> NonlinearBatch for TypedBatch<Q> {
    fn items(&self) -> usize {
        self.items.len()
    }

    fn equation_names(&self) -> &'static [&'static str] {
        Q::EQUATION_NAMES
    }

    fn owner(&self, i: usize) -> EquationOwner {
        self.owners[i]
    }

    fn dofs_of(&self, i: usize) -> &[u32] {
        self.dofs(i)
    }

    fn width(&self, items: Range<usize>) -> usize {
        self.start[items.end] - self.start[items.start]
    }

    fn write_pattern(&self, start: &mut Vec<usize>, col: &mut Vec<u32>) {
        for i in 0..self.items.len() {
            for _ in Q::EQUATION_NAMES {
                let first = col.len();
                col.extend_from_slice(self.dofs(i));
                if !self.dofs(i).is_sorted() {
                    col[first..].sort_unstable();
                }
                start.push(col.len());
            }
        }
    }

    fn evaluate(&self, items: Range<usize>, u: &[f64], c: &mut [f64], g: &mut [f64]) {
        match Q::DOFS {
            2 => self.evaluate_fixed::<2>(items, u, c, g),
            3 => self.evaluate_fixed::<3>(items, u, c, g),
            4 => self.evaluate_fixed::<4>(items, u, c, g),
            6 => self.evaluate_fixed::<6>(items, u, c, g),
            _ => {
                let mut local = Vec::new();
                self.for_each(items, c, g, |i, c, g| {
                    self.gather(i, u, &mut local);
                    self.items[i].value_and_jacobian(&local, c, g);
                });
            }
        }
    }

    fn rounding(&self, items: Range<usize>, known: &UncertainDofs, c: &mut [f64], g: &mut [f64]) {
        self.for_each(items, c, g, |i, c, g| {
            let u: Vec<Bounded> = self.dofs(i).iter().map(|&j| known.dof(j)).collect();
            let [mut value, mut slopes] = [c.len(), g.len()].map(|length| vec![Bounded::from(0.0); length]);
            self.items[i].jacobian_in(&u, &mut value, &mut slopes);
            c.iter_mut().zip(value).chain(g.iter_mut().zip(slopes)).for_each(|(to, of)| *to = bound(of));
        });
    }

    fn numbers(&self, items: Range<usize>) -> usize {
        self.numbers[items].iter().map(|&n| n as usize).sum()
    }

    fn entries(&self, mut first: usize, entry: &mut dyn FnMut(u32, u32, u32)) {
        for (i, item) in self.items.iter().enumerate() {
            let (dofs, mut pair) = (self.dofs(i), 0);
            item.pairs(dofs.len(), &mut |j, k| {
                let number = (first + Q::number(pair)) as u32;
                entry(dofs[j], dofs[k], number);
                if j != k {
                    entry(dofs[k], dofs[j], number);
                }
                pair += 1;
            });
            first += self.numbers[i] as usize;
        }
    }

    fn curvatures(&self, items: Range<usize>, u: &[f64], w: &[f64], out: &mut [f64]) {
        let (mut local, mut rest) = (Vec::new(), out);
        for (i, w) in items.zip(w.chunks_exact(Q::EQUATION_NAMES.len())) {
            let own;
            (own, rest) = rest.split_at_mut(self.numbers[i] as usize);
            self.gather(i, u, &mut local);
            self.items[i].hessian(&local, w, own);
        }
    }

    fn set_time(&mut self, time: f64) -> Result<(), (usize, f64)> {
        let mut driven = self.items.iter_mut().enumerate().filter(|_| Q::DRIVEN);
        driven.try_for_each(|(i, item)| item.at_time(time).map_err(|value| (i * Q::EQUATION_NAMES.len(), value)))
    }

    fn angles(&self, found: &mut dyn FnMut(usize, f64)) {
        let driven = self.items.iter().enumerate().filter(|_| Q::DRIVEN);
        driven
            .for_each(|(i, item)| item.angle().into_iter().for_each(|angle| found(i * Q::EQUATION_NAMES.len(), angle)));
    }

    fn take(&mut self, i: usize, names: &EquationNames, dofs: &mut Vec<u32>) -> Box<dyn StagedNonlinear> {
        let (own, first) = (self.start[i]..self.start[i + 1], dofs.len());
        self.start.remove(i + 1);
        self.start[i + 1..].iter_mut().for_each(|start| *start -= own.len());
        dofs.extend(self.dofs.drain(own));
        self.numbers.remove(i);
        let (name, parameters) = (names.name(self.owners.remove(i).name), self.items.remove(i));
        Box::new(StagedItem { name, dofs: first..dofs.len(), parameters })
    }

    fn as_any_mut(&mut self) -> &mut dyn Any {
        self
    }

    #[cfg(test)]
    fn reference(&self, u: &[DoubleDouble]) -> [Vec<DoubleDouble>; 2] {
        let (mut all_c, mut all_g) = (Vec::new(), Vec::new());
        for (i, item) in self.items.iter().enumerate() {
            let (dofs, rows, zero) = (self.dofs(i), Q::EQUATION_NAMES.len(), DoubleDouble::from(0.0));
            let local: Vec<_> = dofs.iter().map(|&j| u[j as usize]).collect();
            let (mut c, mut g) = (vec![zero; rows], vec![zero; rows * dofs.len()]);
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
        let mut local = Vec::new();
        for (i, item) in self.items.iter().enumerate() {
            self.gather(i, u, &mut local);
            super::compare::compare(item, &local);
        }
    }
}

impl<Q: Nonlinear> StagedNonlinear for StagedItem<Q> {
    fn rows(&self) -> usize {
        Q::EQUATION_NAMES.len()
    }

    fn kind(&self, nonlinear: &NonlinearEquations) -> Option<usize> {
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

    fn fits(&self, dofs: &[u32], (batch, i): (usize, usize), nonlinear: &mut NonlinearEquations) -> bool {
        let dofs = &dofs[self.dofs.clone()];
        let alike = |batch: &mut TypedBatch<Q>| {
            batch.dofs(i) == dofs && pairs(&batch.items[i], dofs.len()) == pairs(&self.parameters, dofs.len())
        };
        nonlinear.typed_mut::<Q>(batch).is_some_and(alike)
    }

    fn overwrite(
        self: Box<Self>,
        constraint: u32,
        names: &mut EquationNames,
        (batch, i): (usize, usize),
        nonlinear: &mut NonlinearEquations,
    ) {
        let owner = EquationOwner { constraint, name: names.place(self.name) };
        if let Some(batch) = nonlinear.typed_mut::<Q>(batch) {
            (batch.items[i], batch.owners[i]) = (self.parameters, owner);
        }
    }
}
