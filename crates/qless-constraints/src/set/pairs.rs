//! The pairs of local DOFs of one item after another, each with the number of the Hessian that it takes.

use crate::constraint::Nonlinear;

/// Those of the last item that was asked; the same for the next where the type says so.
#[derive(Default)]
pub(super) struct Pairs {
    dofs: Option<usize>,
    /// `j`, `k` and the number.
    pub all: Vec<[u32; 3]>,
    /// How many entries the row of each DOF has.
    pub entries: Vec<u32>,
}

impl Pairs {
    pub fn of<Q: Nonlinear>(&mut self, item: &Q, dofs: usize) -> &Self {
        if !Q::SAME_PAIRS || self.dofs != Some(dofs) {
            self.ask(item, dofs);
        }
        debug_assert!(self.are_those_of(item, dofs), "SAME_PAIRS is stated of a type whose pairs are not the same");
        self
    }

    fn ask<Q: Nonlinear>(&mut self, item: &Q, dofs: usize) {
        self.dofs = Some(dofs);
        self.all.clear();
        self.entries.clear();
        self.entries.resize(dofs, 0);
        item.pairs(dofs, &mut |j, k| {
            self.all.push([j as u32, k as u32, Q::number(self.all.len()) as u32]);
            self.entries[j] += 1;
            self.entries[k] += u32::from(j != k);
        });
    }

    fn are_those_of<Q: Nonlinear>(&self, item: &Q, dofs: usize) -> bool {
        let (mut rest, mut same) = (self.all.iter(), true);
        item.pairs(dofs, &mut |j, k| same &= rest.next().is_some_and(|pair| pair[..2] == [j as u32, k as u32]));
        same && rest.next().is_none()
    }
}
