//! Column singletons: a DOF that occurs in one remaining row becomes that row's slave.
//!
//! Removing the row makes further DOFs singletons, so whole models are peeled from the outside in without changing a coefficient. A
//! peeled row is independent of all others and occurs in no certificate. Cost O(nnz). The slave must have the largest coefficient of its
//! row, so that peeling does not increase growth. [`super::eliminate`] has weaker thresholds for the remaining rows.
//!
//! Singletons with a tiny coefficient are the exception, and come last. They prove that their rows are independent, but a factorization
//! might take their coefficients for zero.
//!
//! Rows whose slave is strictly larger than all other coefficients are peeled first. This set does not depend on the order of the
//! rows. So an MPI rank can peel some of these rows with its own equations alone, and the result for all other rows stays the same.

use std::collections::BTreeSet;
use std::hint::select_unpredictable;

use crate::input::numbering::{Column, LocalSystem};
use crate::input::preferences::SlavePreferences;
use crate::input::scale::{Scaling, ldexp};
use crate::presolve::basis::Basis;

/// The peeled rows, in the order of peeling, and a flag for each row that remains.
pub(crate) struct Peeled {
    pub basis: Basis,
    pub remaining: Vec<bool>,
}

/// Marks the count of a prescribed DOF, which cannot be a slave.
const PRESCRIBED: u32 = 1 << 31;

/// Required size of a slave relative to the other coefficients of its row.
#[derive(Clone, Copy, PartialEq)]
enum SlaveSize {
    /// The slave exceeds every other coefficient of a free DOF.
    Larger,
    /// No coefficient of a free DOF exceeds the slave.
    Largest,
    /// The coefficient of the slave is below [`TINY`] times the largest of the free DOFs in its row. A factorization may take it for zero.
    Tiny,
}

/// Coefficients above this fraction of the largest are four digits above the default tolerance of 1e-10, so every factorization keeps them.
const TINY: f64 = 1e-6;

struct Peeling<'a> {
    system: LocalSystem<'a>,
    scaling: &'a Scaling,
    preferences: &'a SlavePreferences,
    columns: Vec<Column>,
    /// A stack of DOFs that became singletons. Each DOF is pushed at most once, so there is room for all.
    ready: Vec<u32>,
    /// Height of the stack. Each DOF is written above the stack, and the height grows only if it counts: a branch would be unpredictable.
    top: usize,
    /// All rows before this one have been tried already.
    tried: usize,
    /// Required relative size of a slave.
    slave: SlaveSize,
    /// The coefficient of a slave must exceed this number.
    least: f64,
    out: Peeled,
}

/// Peels each row that has a singleton of a size in [`SlaveSize`]. The singleton with the largest coefficient becomes the slave; among
/// equal ones the most preferred, then the first. Its coefficient exceeds `least`, which is an absolute tolerance or 0. A row of `held`
/// is peeled only if the coefficient of its slave is tiny. Rows of `absent` are ignored, although `columns` counts them.
pub(crate) fn peel(
    system: LocalSystem,
    columns: &[Column],
    scaling: &Scaling,
    preferences: &SlavePreferences,
    (held, absent): (&[bool], &BTreeSet<usize>),
    least: f64,
) -> Peeled {
    let m = system.equations();
    let basis = Basis::with_capacity(m);
    let mut columns = columns.to_vec();
    system.prescribed().iter().for_each(|&(j, _)| columns[j].count = PRESCRIBED);
    let mut out = Peeled { basis, remaining: vec![true; m] };
    for &i in absent {
        out.remaining[i] = false;
        let free = system.parts(i).0.iter().filter(|&&j| system.free()[j as usize]);
        free.for_each(|&j| columns[j as usize].leave(i as u32));
    }
    let ready = vec![0; system.dofs() + 1];
    let mut work = Peeling {
        system,
        scaling,
        preferences,
        columns,
        ready,
        top: 0,
        tried: 0,
        slave: SlaveSize::Larger,
        least,
        out,
    };
    for slave in [SlaveSize::Larger, SlaveSize::Largest] {
        work.slave = slave;
        (0..m).filter(|&i| !held[i]).for_each(|i| work.try_with_followers(i));
    }
    work.slave = SlaveSize::Tiny;
    (0..m).for_each(|i| work.try_with_followers(i));
    work.out
}

impl Peeling<'_> {
    #[inline]
    fn leave_column(&mut self, i: usize, j: u32) {
        let column = &mut self.columns[j as usize];
        column.leave(i as u32);
        // The DOF is pushed only if its row was tried already; the other rows are tried later anyway.
        self.ready[self.top] = j;
        self.top += usize::from(column.count == 1 && (column.rows as usize) < self.tried);
    }

    /// Tries row i, then every row in which its removal makes a DOF a singleton.
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

    /// Peels row i, solved for the DOF at `position`.
    fn take(&mut self, i: usize, position: usize) {
        let (dofs, values) = self.system.parts(i);
        dofs.iter().for_each(|&j| self.leave_column(i, j));
        self.out.basis.peel(i as u32, dofs[position], position, self.system.rhs()[i] / values[position]);
        self.out.remaining[i] = false;
    }

    /// Position of the singleton that becomes the slave of row i; None if no singleton has the size that `self.slave` requires.
    fn slave(&self, i: usize) -> Option<usize> {
        if self.scaling.col.is_empty() && !self.preferences.any() {
            return self.best(i, |_, v| v.abs(), |_, _| false);
        }
        let dofs = self.system.parts(i).0;
        let size = |j: u32, v: f64| ldexp(v.abs(), self.scaling.col(j as usize) + self.scaling.row[i]);
        self.best(i, size, |j, k| self.preferences.of(j) > self.preferences.of(dofs[k]))
    }

    /// [`Peeling::slave`] for the given sizes; `rather` decides between DOFs with equal coefficients.
    ///
    /// None also if all sizes are zero: scaling underflows for coefficients that are 1e308 times smaller than others. Sizes are compared by
    /// their bits, which have the same order, because integers can be selected without a branch.
    #[inline]
    fn best(&self, i: usize, size: impl Fn(u32, f64) -> f64, rather: impl Fn(u32, usize) -> bool) -> Option<usize> {
        let (dofs, values) = self.system.parts(i);
        let (mut at, mut most, mut largest, mut equals) = (usize::MAX, 0, 0, 0);
        for (k, (&j, &v)) in dofs.iter().zip(values).enumerate() {
            let (own, count) = (size(j, v).to_bits(), self.columns[j as usize].count);
            let counted = if count < PRESCRIBED / 2 { own } else { 0 };
            equals = u32::from(counted == largest) + select_unpredictable(counted > largest, 0, equals);
            largest = largest.max(counted);
            // A coefficient that underflows to zero is not a candidate.
            let better = (count == 1) & ((own > most) | (own == most && most > 0 && rather(j, at)));
            at = select_unpredictable(better, k, at);
            most = select_unpredictable(better, own, most);
        }
        let is_slave = match self.slave {
            SlaveSize::Larger => most >= largest && equals == 0,
            SlaveSize::Largest => most >= largest,
            SlaveSize::Tiny => f64::from_bits(most) < TINY * f64::from_bits(largest),
        };
        (at != usize::MAX && is_slave && f64::from_bits(most) > self.least).then_some(at)
    }
}
