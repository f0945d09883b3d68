//! Items of a block come, go, and change their parameters: O([`Homogeneous::CAPACITY`]) numbers are moved.

use qless::Identity;

use super::homogeneous::Homogeneous;
use super::labels::{Owner, Parts};
use super::order::Order;
use super::store::Staged;
use crate::constraint::Nonlinear;

impl<Q: Nonlinear> Homogeneous<Q> {
    /// With room for as many items as there may be, as the last block of a type has that follows others.
    pub fn with_room() -> Self {
        let mut block = Self::default();
        block.items.reserve_exact(Self::CAPACITY);
        block.owners.reserve_exact(Self::CAPACITY);
        block.start.reserve_exact(Self::CAPACITY);
        block.numbers.reserve_exact(Self::CAPACITY);
        block.dofs.reserve_exact(Self::CAPACITY * Q::DOFS);
        block.units.reserve_exact(Self::CAPACITY * Self::UNITS);
        block
    }

    /// Puts an item behind those of its constraint and of those that were added before.
    pub fn insert(&mut self, owner: Owner, dofs: &[u32], parameters: Q) {
        let last = self.owners.last().is_none_or(|last| last.constraint <= owner.constraint);
        let after = |other: &Owner| other.constraint <= owner.constraint;
        let i = if last { self.items.len() } else { self.owners.partition_point(after) };
        self.numbers.insert(i, numbers(&parameters, dofs.len()));
        if Self::UNITS > 0 {
            let end = self.units.len();
            self.units.resize(end + Self::UNITS, 0.0);
            parameters.hessian(&[], &[1.0], &mut self.units[end..]);
            self.units[i * Self::UNITS..].rotate_right(Self::UNITS);
        }
        let first = self.start[i];
        self.dofs.extend_from_slice(dofs);
        self.dofs[first as usize..].rotate_right(dofs.len());
        self.start.insert(i, first);
        self.start[i + 1..].iter_mut().for_each(|start| *start += dofs.len() as u32);
        self.items.insert(i, parameters);
        self.owners.insert(i, owner);
        self.widest = self.widest.max(dofs.len());
        self.stamp = Identity::new();
        if last {
            self.order.push(dofs);
        } else {
            self.renew_order();
        }
    }

    /// Takes item i out.
    pub fn remove(&mut self, i: usize, parts: &Parts) -> Staged<Q> {
        let (first, last) = (self.start[i], self.start[i + 1]);
        let dofs = self.dofs.drain(first as usize..last as usize).collect();
        self.start.remove(i);
        self.start[i..].iter_mut().for_each(|start| *start -= last - first);
        self.numbers.remove(i);
        self.units.drain(i * Self::UNITS..(i + 1) * Self::UNITS);
        let (owner, parameters) = (self.owners.remove(i), self.items.remove(i));
        self.stamp = Identity::new();
        self.renew_order();
        Staged { part: parts.name(owner.part), dofs, parameters }
    }

    /// The items from i on, in a block of their own.
    pub fn split(&mut self, i: usize) -> Self {
        let first = self.start[i];
        let mut second = Self {
            items: self.items.split_off(i),
            owners: self.owners.split_off(i),
            start: self.start[i..].iter().map(|start| start - first).collect(),
            dofs: self.dofs.split_off(first as usize),
            numbers: self.numbers.split_off(i),
            units: self.units.split_off(i * Self::UNITS),
            widest: self.widest,
            ..Self::default()
        };
        self.start.truncate(i + 1);
        self.stamp = Identity::new();
        self.renew_order();
        second.renew_order();
        second
    }

    /// Whether parameters with these DOFs can take the place of item i: all patterns are the same.
    pub fn alike(&self, i: usize, dofs: &[u32], parameters: &Q) -> bool {
        self.dofs(i) == dofs && pairs(&self.items[i], dofs.len()) == pairs(parameters, dofs.len())
    }

    /// Gives item i other parameters, with which it is [`Homogeneous::alike`].
    pub fn overwrite(&mut self, i: usize, owner: Owner, parameters: Q) {
        if Self::UNITS > 0 {
            parameters.hessian(&[], &[1.0], &mut self.units[i * Self::UNITS..(i + 1) * Self::UNITS]);
        }
        (self.items[i], self.owners[i]) = (parameters, owner);
    }

    /// After other parameters of all items.
    pub fn renew_units(&mut self) {
        if Self::UNITS > 0 {
            let units = self.units.chunks_exact_mut(Self::UNITS);
            self.items.iter().zip(units).for_each(|(item, units)| item.hessian(&[], &[1.0], units));
        }
    }

    fn renew_order(&mut self) {
        let mut order = Order::default();
        (0..self.items.len()).for_each(|i| order.push(self.dofs(i)));
        self.order = order;
    }
}

/// How many numbers a Hessian has.
fn numbers<Q: Nonlinear>(parameters: &Q, dofs: usize) -> u32 {
    if Homogeneous::<Q>::UNITS > 0 {
        return Homogeneous::<Q>::UNITS as u32;
    }
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
