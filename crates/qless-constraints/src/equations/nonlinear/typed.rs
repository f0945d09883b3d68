//! Nonlinear equations of one type, in flat arrays, so that the inner loop knows the type and calls nothing at run time.
//! Items of a batch come, go, and change their parameters: O([`TypedBatch::CAPACITY`]) numbers are moved.
//! Columns ascend in a row of G, the DOFs of a constraint need not: where each goes. Most ascend, and cost nothing here.
//! Nonlinear equations that are not among those of their type.

use std::borrow::Cow;
use std::ops::Range;
use std::sync::OnceLock;

use crate::equations::{ChangeStamp, EquationNames, EquationOwner};
use crate::nonlinear::Nonlinear;

/// Items per batch, ...
const MANY: usize = 1024;
/// ... of types that take much arithmetic, of which there are fewer in most models: they reach further.
const FEW: usize = 256;
/// Items whose DOFs are gathered at once: looks into u that do not wait for one another, nor for arithmetic.
const AHEAD: usize = 64;
/// The most DOFs of an item for which so many are.
const NARROW: usize = 64;

/// Items of type Q: parameters, with the DOFs that they share.
pub struct TypedBatch<Q> {
    pub stamp: ChangeStamp,
    pub items: Vec<Q>,
    pub owners: Vec<EquationOwner>,
    /// Where the DOFs of each item start, if that varies; one more than items.
    pub start: Vec<u32>,
    pub dofs: Vec<u32>,
    pub order: DofOrder,
    /// Most DOFs of one item.
    pub widest: usize,
    /// How many numbers the Hessian of each item has, but where they depend on the weight alone: ...
    pub numbers: Vec<u32>,
    /// ... then there are [`TypedBatch::UNITS`] of each item, and these are those for a weight of 1, made when somebody needs them.
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

    /// From the smallest DOF to behind the largest.
    pub fn hull(&self) -> Range<u32> {
        let (least, most) = self.dofs.iter().fold((u32::MAX, 0), |(least, most), &j| (least.min(j), most.max(j)));
        least.min(most)..if self.dofs.is_empty() { 0 } else { most + 1 }
    }

    /// How many numbers the Hessian of item i has.
    pub fn numbers_of(&self, i: usize) -> usize {
        if Self::UNITS > 0 { Self::UNITS } else { self.numbers[i] as usize }
    }
}

pub struct StagedItem<Q> {
    pub name: Cow<'static, str>,
    /// Places among the DOFs of all pieces.
    pub dofs: Range<usize>,
    pub parameters: Q,
}

impl<Q: Nonlinear> TypedBatch<Q> {
    /// With room for as many items as there may be, as the last batch of a type has that follows others.
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

    /// Puts an item behind those of its constraint and of those that were added before.
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

    /// Takes item i out.
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

    /// The items from i on, in a batch of their own.
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

    /// Whether parameters with these DOFs can take the place of item i: all patterns are the same.
    pub fn alike(&self, i: usize, dofs: &[u32], parameters: &Q) -> bool {
        self.dofs(i) == dofs && pairs(&self.items[i], dofs.len()) == pairs(parameters, dofs.len())
    }

    /// Gives item i other parameters, with which it is [`TypedBatch::alike`].
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

/// How many numbers a Hessian has.
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

/// The items of a batch whose DOFs do not ascend.
#[derive(Default)]
pub struct DofOrder {
    count: usize,
    /// Which items, ascending.
    items: Vec<u32>,
    /// Where the places of each end.
    end: Vec<u32>,
    /// For each DOF its place among those of its item.
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

    /// Sorts the rows of those; the entries of item i start at `start(i)` of `g`.
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
