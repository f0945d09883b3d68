//! Nonlinear equations of one type, in flat arrays, so that the inner loop knows the type and calls nothing at run time.

use std::ops::Range;
use std::sync::OnceLock;

use super::labels::Owner;
use super::order::Order;
use super::stamp::Stamp;
use crate::constraint::Nonlinear;

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
