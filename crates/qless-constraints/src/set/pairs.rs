//! The pairs of local DOFs of one item after another, each with the number of the Hessian that it takes.

use crate::constraint::Nonlinear;

/// Those of the last item that was asked; the same for the next where the type says so.
#[derive(Default)]
pub(super) struct Pairs {
    dofs: Option<usize>,
    /// `j`, `k` and the number.
    all: Vec<[u32; 3]>,
}

impl Pairs {
    pub fn of<Q: Nonlinear>(&mut self, item: &Q, dofs: usize) -> &[[u32; 3]] {
        if !Q::SAME_PAIRS || self.dofs != Some(dofs) {
            self.dofs = Some(dofs);
            self.all.clear();
            item.pairs(dofs, &mut |j, k| self.all.push([j as u32, k as u32, Q::number(self.all.len()) as u32]));
        }
        &self.all
    }
}
