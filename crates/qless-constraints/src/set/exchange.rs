//! Items of a block come, go, and change their parameters: O([`Homogeneous::CAPACITY`]) numbers are moved.

use super::homogeneous::Homogeneous;
use super::labels::{Owner, Parts};
use super::order::Order;
use super::piece::Staged;
use crate::constraint::Nonlinear;

impl<Q: Nonlinear> Homogeneous<Q> {
    /// With room for as many items as there may be, as the last block of a type has that follows others.
    pub fn with_room() -> Self {
        let mut block = Self::default();
        block.items.reserve_exact(Self::CAPACITY);
        block.owners.reserve_exact(Self::CAPACITY);
        block.dofs.reserve_exact(Self::CAPACITY * Q::DOFS);
        if Q::DOFS == 0 {
            block.start.reserve_exact(Self::CAPACITY);
        }
        if Self::UNITS == 0 {
            block.numbers.reserve_exact(Self::CAPACITY);
        }
        block
    }

    /// Puts an item behind those of its constraint and of those that were added before.
    pub fn insert(&mut self, owner: Owner, dofs: &[u32], parameters: Q) {
        let last = self.owners.last().is_none_or(|last| last.constraint <= owner.constraint);
        let after = |other: &Owner| other.constraint <= owner.constraint;
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
    pub fn remove(&mut self, i: usize, parts: &Parts, dofs: &mut Vec<u32>) -> Staged<Q> {
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
        Staged { part: parts.name(owner.part), dofs: first..dofs.len(), parameters }
    }

    /// The items from i on, in a block of their own.
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

    /// Gives item i other parameters, with which it is [`Homogeneous::alike`].
    pub fn overwrite(&mut self, i: usize, owner: Owner, parameters: Q) {
        self.units.take();
        (self.items[i], self.owners[i]) = (parameters, owner);
    }

    fn renew_order(&mut self) {
        let mut order = Order::default();
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
