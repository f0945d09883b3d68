//! A batch of one type: parameters and DOFs in flat arrays, so that loops know the type and need no virtual calls.
//!
//! Inserting or removing an item moves O([`TypedBatch::CAPACITY`]) numbers.

use std::borrow::Cow;
use std::ops::Range;
use std::sync::OnceLock;

use crate::equations::{ChangeStamp, EquationNames, EquationOwner};
use crate::nonlinear::Nonlinear;

/// Items of type Q: parameters and DOFs.
pub struct TypedBatch<Q> {
    pub stamp: ChangeStamp,
    pub items: Vec<Q>,
    pub owners: Vec<EquationOwner>,
    /// Start of each item's DOFs, and at the end the number of DOFs; used only if that number varies.
    pub start: Vec<u32>,
    pub dofs: Vec<u32>,
    pub order: DofOrder,
    /// Largest number of DOFs of an item.
    pub widest: usize,
    /// Number of Hessian numbers of each item; empty if [`TypedBatch::UNITS`] says it.
    pub numbers: Vec<u32>,
    /// Hessian numbers of all items for a weight of 1, computed on request; used only if [`TypedBatch::UNITS`] is not 0.
    pub units: OnceLock<Box<[f64]>>,
}

impl<Q> Default for TypedBatch<Q> {
    fn default() -> Self {
        Self {
            stamp: ChangeStamp::default(),
            items: Vec::new(),
            owners: Vec::new(),
            start: vec![0],
            dofs: Vec::new(),
            order: DofOrder::default(),
            widest: 0,
            numbers: Vec::new(),
            units: OnceLock::new(),
        }
    }
}

impl<Q: Nonlinear> TypedBatch<Q> {
    /// Largest number of items.
    pub const CAPACITY: usize = 1024;

    #[inline]
    pub fn dofs(&self, i: usize) -> &[u32] {
        &self.dofs[self.span(i..i + 1)]
    }

    /// Where the DOFs of these items are.
    #[inline]
    pub fn span(&self, items: Range<usize>) -> Range<usize> {
        if Q::DOFS > 0 {
            return items.start * Q::DOFS..items.end * Q::DOFS;
        }
        self.start[items.start] as usize..self.start[items.end] as usize
    }

    /// Number of DOFs of these items.
    pub fn width(&self, items: Range<usize>) -> usize {
        self.span(items).len()
    }

    /// Copies the DOF values of these items into `room`.
    #[inline]
    pub fn gather<'a>(&self, items: Range<usize>, u: &[f64], room: &'a mut [f64]) -> &'a mut [f64] {
        let dofs = &self.dofs[self.span(items)];
        let local = &mut room[..dofs.len()];
        local.iter_mut().zip(dofs).for_each(|(x, &j)| *x = u[j as usize]);
        local
    }

    /// Number of Hessian numbers of item i.
    pub fn numbers_of(&self, i: usize) -> usize {
        if Self::UNITS > 0 { Self::UNITS } else { self.numbers[i] as usize }
    }
}

pub struct StagedItem<Q> {
    pub name: Cow<'static, str>,
    /// Positions in the list of DOFs of all nonlinear pieces.
    pub dofs: Range<usize>,
    pub parameters: Q,
}

impl<Q: Nonlinear> TypedBatch<Q> {
    /// Empty, with memory for a full batch: types that fill one batch often fill more.
    pub fn with_room() -> Self {
        let mut batch = Self::default();
        batch.items.reserve_exact(Self::CAPACITY);
        batch.owners.reserve_exact(Self::CAPACITY);
        batch.dofs.reserve_exact(Self::CAPACITY * Q::DOFS);
        if Q::DOFS == 0 {
            batch.start.reserve_exact(Self::CAPACITY);
        }
        if Self::UNITS == 0 {
            batch.numbers.reserve_exact(Self::CAPACITY);
        }
        batch
    }

    /// Inserts an item after those of its constraint and of earlier ones.
    pub fn insert(&mut self, owner: EquationOwner, dofs: &[u32], parameters: Q) {
        let last = self.owners.last().is_none_or(|last| last.constraint <= owner.constraint);
        let after = |other: &EquationOwner| other.constraint <= owner.constraint;
        let i = if last { self.items.len() } else { self.owners.partition_point(after) };
        if Self::UNITS == 0 {
            self.numbers.insert(i, numbers(&parameters, dofs.len()));
        }
        let first = self.span(i..i).start;
        self.dofs.extend_from_slice(dofs);
        if !last {
            self.dofs[first..].rotate_right(dofs.len());
        }
        if Q::DOFS == 0 {
            self.start.insert(i, first as u32);
            self.start[i + 1..].iter_mut().for_each(|start| *start += dofs.len() as u32);
        }
        self.units.take();
        self.items.insert(i, parameters);
        self.owners.insert(i, owner);
        self.widest = self.widest.max(dofs.len());
        self.stamp.renew();
        if last {
            self.order.push(dofs);
        } else {
            self.renew_order();
        }
    }

    /// Removes item i, and appends its DOFs to `dofs`.
    pub fn remove(&mut self, i: usize, names: &EquationNames, dofs: &mut Vec<u32>) -> StagedItem<Q> {
        let (span, first) = (self.span(i..i + 1), dofs.len());
        dofs.extend(self.dofs.drain(span.clone()));
        if Q::DOFS == 0 {
            self.start.remove(i);
            self.start[i..].iter_mut().for_each(|start| *start -= span.len() as u32);
        }
        if Self::UNITS == 0 {
            self.numbers.remove(i);
        }
        self.units.take();
        let (owner, parameters) = (self.owners.remove(i), self.items.remove(i));
        self.stamp.renew();
        self.renew_order();
        StagedItem { name: names.name(owner.name), dofs: first..dofs.len(), parameters }
    }

    /// Moves the items from i on to a new batch.
    pub fn split(&mut self, i: usize) -> Self {
        let first = self.span(i..i).start;
        let mut second = Self {
            items: self.items.split_off(i),
            owners: self.owners.split_off(i),
            dofs: self.dofs.split_off(first),
            widest: self.widest,
            ..Self::default()
        };
        if Q::DOFS == 0 {
            second.start = self.start[i..].iter().map(|start| start - first as u32).collect();
            self.start.truncate(i + 1);
        }
        if Self::UNITS == 0 {
            second.numbers = self.numbers.split_off(i);
        }
        self.units.take();
        self.stamp.renew();
        self.renew_order();
        second.renew_order();
        second
    }

    /// Whether parameters with these DOFs can replace item i without a change of patterns.
    pub fn alike(&self, i: usize, dofs: &[u32], parameters: &Q) -> bool {
        self.dofs(i) == dofs && pairs(&self.items[i], dofs.len()) == pairs(parameters, dofs.len())
    }

    /// Replaces the parameters of item i by others for which [`TypedBatch::alike`] holds.
    pub fn overwrite(&mut self, i: usize, owner: EquationOwner, parameters: Q) {
        self.units.take();
        (self.items[i], self.owners[i]) = (parameters, owner);
    }

    fn renew_order(&mut self) {
        let mut order = DofOrder::default();
        (0..self.items.len()).for_each(|i| order.push(self.dofs(i)));
        self.order = order;
    }
}

/// Number of Hessian numbers of an item.
fn numbers<Q: Nonlinear>(parameters: &Q, dofs: usize) -> u32 {
    let (mut pairs, mut numbers) = (0, 0);
    parameters.pairs(dofs, &mut |_, _| {
        numbers = numbers.max(Q::number(pairs) + 1);
        pairs += 1;
    });
    numbers as u32
}

fn pairs<Q: Nonlinear>(parameters: &Q, dofs: usize) -> Vec<(usize, usize)> {
    let mut all = Vec::new();
    parameters.pairs(dofs, &mut |j, k| all.push((j, k)));
    all
}

/// Column order of items whose DOFs do not ascend, since the columns of a row of G must. Items in order cost no memory here.
#[derive(Default)]
pub struct DofOrder {
    count: usize,
    /// Items out of order, ascending.
    items: Vec<u32>,
    /// End of each item's entries in `place`.
    end: Vec<u32>,
    /// For each DOF of an item, its rank among the item's DOFs.
    place: Vec<u32>,
}

impl DofOrder {
    /// Whether the DOFs of all items ascend.
    pub fn is_empty(&self) -> bool {
        self.items.is_empty()
    }

    /// Appends the next item of the batch.
    pub fn push(&mut self, dofs: &[u32]) {
        if !dofs.is_sorted() {
            let place = |dof| dofs.iter().filter(|&other| other < dof).count() as u32;
            self.place.extend(dofs.iter().map(place));
            self.items.push(self.count as u32);
            self.end.push(self.place.len() as u32);
        }
        self.count += 1;
    }

    /// Sorts the rows of items out of order; the entries of item i start at `start(i)` of `g`.
    pub fn restore(&self, start: impl Fn(usize) -> usize, rows: usize, g: &mut [f64]) {
        let mut unsorted = Vec::new();
        for (k, &i) in self.items.iter().enumerate() {
            let from = if k == 0 { 0 } else { self.end[k - 1] as usize };
            let place = &self.place[from..self.end[k] as usize];
            for row in g[start(i as usize)..][..rows * place.len()].chunks_exact_mut(place.len()) {
                unsorted.clear();
                unsorted.extend_from_slice(row);
                unsorted.iter().zip(place).for_each(|(&v, &p)| row[p as usize] = v);
            }
        }
    }
}
