//! Column singletons: a DOF that occurs in one remaining row becomes that row's slave.
//!
//! Removing the row makes further DOFs singletons, so whole models peel away from their rims without a single
//! change of a coefficient. Such a row is independent of all others and stands in nobody's certificate.
//! Cost O(nnz). The slave's coefficient must be the largest of its row, so that peeling adds nothing to growth; what
//! that leaves, [`super::eliminate`] takes with weaker thresholds.

use crate::basis::Basis;
use crate::local::{Column, Local};
use crate::preferences::Wishes;
use crate::scale::{Scaling, ldexp};

/// Rows that found their slave, in the order found, and the others.
pub(crate) struct Peeled {
    pub basis: Basis,
    pub remaining: Vec<bool>,
}

struct Peeling<'a> {
    system: Local<'a>,
    scaling: &'a Scaling,
    wishes: &'a Wishes,
    columns: Vec<Column>,
    /// DOFs that were left in one row by the removal of others.
    ready: Vec<u32>,
    out: Peeled,
}

/// Rows of `held` stay, with every row that shares a DOF with them. `columns` counts all rows. Of several slaves of the same
/// row the one with the highest wish is taken, then the first.
pub(crate) fn peel(
    system: Local,
    columns: &[Column],
    scaling: &Scaling,
    wishes: &Wishes,
    held: Option<&[bool]>,
) -> Peeled {
    let m = system.equations();
    let basis = Basis::with_capacity(m, system.entries() - m.min(system.entries()));
    let mut columns = columns.to_vec();
    // Prescribed DOFs are no slaves.
    system.prescribed().iter().for_each(|&(j, _)| columns[j].count = u32::MAX / 2);
    let out = Peeled { basis, remaining: vec![true; m] };
    let mut work = Peeling { system, scaling, wishes, columns, ready: Vec::new(), out };
    let is_held = |i: &usize| held.is_some_and(|held| held[*i]);
    (0..m).filter(is_held).for_each(|i| work.leave(i));
    for i in (0..m).filter(|i| !is_held(i)) {
        work.try_row(i);
        while let Some(dof) = work.ready.pop() {
            let column = work.columns[dof as usize];
            if column.count == 1 {
                work.try_row(column.rows as usize);
            }
        }
    }
    work.out
}

impl Peeling<'_> {
    fn leave(&mut self, i: usize) {
        for &j in self.system.parts(i).0 {
            let column = &mut self.columns[j as usize];
            column.leave(i as u32);
            if column.count == 1 {
                self.ready.push(j);
            }
        }
    }

    fn try_row(&mut self, i: usize) {
        if !self.out.remaining[i] {
            return;
        }
        if let Some(position) = self.slave(i) {
            let (dofs, values) = self.system.parts(i);
            let scaled = self.scaling.entry(i, dofs[position] as usize, values[position]);
            self.out.basis.peel(i as u32, (dofs, values), position, self.system.rhs()[i], scaled);
            self.out.remaining[i] = false;
            self.leave(i);
        }
    }

    /// Position of a DOF of no other remaining row with the largest coefficient of the row.
    fn slave(&self, i: usize) -> Option<usize> {
        let (dofs, values) = self.system.parts(i);
        let size = |k: usize| match self.scaling.col.get(dofs[k] as usize) {
            None => values[k].abs(),
            Some(&exponent) => ldexp(values[k].abs(), exponent + self.scaling.row[i]),
        };
        let mut best: Option<(usize, f64)> = None;
        let mut largest = 0.0_f64;
        for (k, &j) in dofs.iter().enumerate() {
            let (own, count) = (size(k), self.columns[j as usize].count);
            // Beyond half of all counts: prescribed.
            if count < u32::MAX / 4 {
                largest = largest.max(own);
            }
            let wanted = |other: usize, most: f64| {
                own > most || (own == most && self.wishes.of(j) > self.wishes.of(dofs[other]))
            };
            if count == 1 && best.is_none_or(|(other, most)| wanted(other, most)) {
                best = Some((k, own));
            }
        }
        best.filter(|&(_, own)| own >= largest).map(|(k, _)| k)
    }
}
