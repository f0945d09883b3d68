//! Constraints that follow one another, as equations of their own: one thread makes them, and nothing of the set is touched until they join it.

use std::borrow::Cow;

use super::batch::Terms;
use super::blocks::Blocks;
use super::labels::{Owner, Parts};
use super::linear::Rows;
use super::stated::Segment;
use super::time::Rhs;
use crate::constraint::Nonlinear;

/// Equations, and what they state of coordinates.
#[derive(Default)]
pub(super) struct Portion {
    pub linear: Rows,
    pub blocks: Blocks,
    pub parts: Parts,
    pub stated: Segment,
    /// The constraint that is being added.
    constraint: u32,
    /// How many linear equations it has.
    own: u32,
    pub time: f64,
    /// Room for the terms of one equation.
    terms: Terms,
}

impl Portion {
    /// From this constraint on, at this time.
    pub fn new(constraint: u32, time: f64) -> Self {
        Self { constraint, time, linear: Rows::of_many(), blocks: Blocks::of_many(), ..Self::default() }
    }

    pub fn rows(&self) -> usize {
        self.linear.rows() + self.blocks.rows()
    }

    /// Room for terms, to be given back with the equation.
    pub fn terms(&mut self) -> Terms {
        let mut terms = std::mem::take(&mut self.terms);
        terms.clear();
        terms
    }

    pub fn equation(&mut self, part: Cow<'static, str>, terms: Terms, rhs: Rhs) {
        let owner = Owner { constraint: self.constraint, part: self.parts.place(part) };
        self.linear.append(owner, self.own, (&terms, rhs), self.time);
        self.own += 1;
        self.terms = terms;
    }

    pub fn nonlinear<Q: Nonlinear>(&mut self, part: Cow<'static, str>, dofs: &[u32], parameters: Q) {
        let owner = Owner { constraint: self.constraint, part: self.parts.place(part) };
        self.blocks.insert(owner, dofs, parameters);
    }

    /// The constraint, one of so many, is complete.
    pub fn next(&mut self, expected: usize) {
        self.stated.close(expected);
        self.constraint += 1;
        self.own = 0;
    }
}
