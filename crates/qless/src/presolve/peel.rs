//! Column singletons: a DOF that occurs in one remaining row becomes that row's slave.
//!
//! Removing the row makes further DOFs singletons, so whole models peel away from their rims without a single
//! change of a coefficient. Such a row is independent of all others and stands in nobody's certificate.
//! Cost O(nnz). The slave's coefficient must be the largest of its row, so that peeling adds nothing to growth; what
//! that leaves, [`super::eliminate`] takes with weaker thresholds.
//!
//! Rows whose slave is larger than all others come first: which these are does not depend on any order, so that a part of
//! them can be taken out elsewhere, on ranks that see nothing else, and the rest is as it would have been.

use std::hint::select_unpredictable;

use crate::input::numbering::{Column, LocalSystem};
use crate::input::preferences::Wishes;
use crate::input::scale::{Scaling, ldexp};
use crate::presolve::basis::Basis;

/// Rows that found their slave, in the order found, and the others.
pub(crate) struct Peeled {
    pub basis: Basis,
    pub remaining: Vec<bool>,
}

/// Stands for the count of a prescribed DOF, which is no slave.
const PRESCRIBED: u32 = 1 << 31;

struct Peeling<'a> {
    system: LocalSystem<'a>,
    scaling: &'a Scaling,
    wishes: &'a Wishes,
    columns: Vec<Column>,
    /// A stack of the DOFs that were left in one row by the removal of others: each comes in once, so that all have room, and ...
    ready: Vec<u32>,
    /// ... how many there are. DOFs are written without a branch, which nobody could predict.
    top: usize,
    /// All rows before this one have been tried.
    tried: usize,
    /// Whether a slave must be larger than all others of its row, and not only as large.
    strictly: bool,
    out: Peeled,
}

/// Rows of `held` stay, with every row that shares a DOF with them. `columns` counts all rows. Of several slaves of the same
/// row the one with the highest wish is taken, then the first.
pub(crate) fn peel(
    system: LocalSystem,
    columns: &[Column],
    scaling: &Scaling,
    wishes: &Wishes,
    held: Option<&[bool]>,
) -> Peeled {
    let m = system.equations();
    let basis = Basis::with_capacity(m);
    let mut columns = columns.to_vec();
    system.prescribed().iter().for_each(|&(j, _)| columns[j].count = PRESCRIBED);
    let out = Peeled { basis, remaining: vec![true; m] };
    let ready = vec![0; system.dofs() + 1];
    let mut work = Peeling { system, scaling, wishes, columns, ready, top: 0, tried: 0, strictly: true, out };
    let is_held = |i: &usize| held.is_some_and(|held| held[*i]);
    (0..m).filter(is_held).for_each(|i| work.leave(i));
    for strictly in [true, false] {
        work.strictly = strictly;
        (0..m).filter(|i| !is_held(i)).for_each(|i| work.try_with_followers(i));
    }
    work.out
}

impl Peeling<'_> {
    fn leave(&mut self, i: usize) {
        self.system.parts(i).0.iter().for_each(|&j| self.leave_column(i, j));
    }

    #[inline]
    fn leave_column(&mut self, i: usize, j: u32) {
        let column = &mut self.columns[j as usize];
        column.leave(i as u32);
        // Rows that were not tried yet need no reminder.
        self.ready[self.top] = j;
        self.top += usize::from(column.count == 1 && (column.rows as usize) < self.tried);
    }

    /// Row i, and every row that its removal leaves a DOF of its own.
    #[inline]
    fn try_with_followers(&mut self, i: usize) {
        self.tried = i;
        self.try_row(i);
        while self.top > 0 {
            self.top -= 1;
            let dof = self.ready[self.top];
            let column = self.columns[dof as usize];
            if column.count == 1 {
                self.try_row(column.rows as usize);
            }
        }
    }

    #[inline]
    fn try_row(&mut self, i: usize) {
        if !self.out.remaining[i] {
            return;
        }
        if let Some(position) = self.slave(i) {
            self.take(i, position);
        }
    }

    /// Row i leaves, solved for the DOF at `position`.
    fn take(&mut self, i: usize, position: usize) {
        let (dofs, values) = self.system.parts(i);
        dofs.iter().for_each(|&j| self.leave_column(i, j));
        self.out.basis.peel(i as u32, dofs[position], position, self.system.rhs()[i] / values[position]);
        self.out.remaining[i] = false;
    }

    /// Position of a DOF of no other remaining row with the largest coefficient of the row.
    fn slave(&self, i: usize) -> Option<usize> {
        if self.scaling.col.is_empty() && !self.wishes.any() {
            return self.best(i, |_, v| v.abs(), |_, _| false);
        }
        let dofs = self.system.parts(i).0;
        let size = |j: u32, v: f64| ldexp(v.abs(), self.scaling.col(j as usize) + self.scaling.row[i]);
        self.best(i, size, |j, k| self.wishes.of(j) > self.wishes.of(dofs[k]))
    }

    /// The same for the given sizes; `rather` decides between the DOFs of equal coefficients.
    ///
    /// None where all sizes are zero, which scaling makes of what is 1e308 times smaller than others. Sizes are compared by their bits, whose order is the same: integers are selected without a branch.
    #[inline]
    fn best(&self, i: usize, size: impl Fn(u32, f64) -> f64, rather: impl Fn(u32, usize) -> bool) -> Option<usize> {
        let (dofs, values) = self.system.parts(i);
        let (mut at, mut most, mut largest, mut equals) = (usize::MAX, 0, 0, 0);
        for (k, (&j, &v)) in dofs.iter().zip(values).enumerate() {
            let (own, count) = (size(j, v).to_bits(), self.columns[j as usize].count);
            let counted = if count < PRESCRIBED / 2 { own } else { 0 };
            equals = u32::from(counted == largest) + select_unpredictable(counted > largest, 0, equals);
            largest = largest.max(counted);
            // Scaled, a coefficient may vanish; such a DOF is no slave, and none to compare with.
            let better = (count == 1) & ((own > most) | (own == most && most > 0 && rather(j, at)));
            at = select_unpredictable(better, k, at);
            most = select_unpredictable(better, own, most);
        }
        let is_largest = most >= largest && (equals == 0 || !self.strictly);
        (at != usize::MAX && is_largest).then_some(at)
    }
}
