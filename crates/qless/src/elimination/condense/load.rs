//! `f_q = L^T (f - K u_0)`; u_0 is zero but for slaves and prescribed DOFs.

use rayon::prelude::*;

use super::plan::Source;
use super::{CondensedPattern, NONE};
use crate::ArgumentError;
use crate::common::argument::{long, numbers};
use crate::elimination::Elimination;
use crate::elimination::apply::fill;

/// Fewer slaves than this are not worth a thread of their own.
const WORTH_A_THREAD: usize = 1 << 9;

impl CondensedPattern {
    /// `f_q = L^T (f - K u_0)` alone, for other forces or after a [`crate::Elimination::update`].
    ///
    /// # Errors
    /// As [`CondensedPattern::condense_into`].
    pub fn load_into(
        &self,
        elimination: &Elimination,
        k: &[f64],
        f: &[f64],
        f_q: &mut [f64],
    ) -> Result<(), ArgumentError> {
        self.check(elimination, self.nnz())?;
        long("the list of values of K", k.len(), self.plan.entries)?;
        numbers("the list of forces", f, elimination.dofs())?;
        long("the list of forces on unknowns", f_q.len(), self.unknowns())?;
        let (plan, slaves) = (&self.plan, elimination.slaves());
        let columns = if plan.by_columns { elimination.dofs() } else { 0 };
        self.spare.with(columns, |by_columns| {
            self.stress_by_columns(elimination, k, by_columns);
            self.spare.with(slaves.len(), |of_slaves| self.load_of(elimination, (k, f), by_columns, of_slaves, f_q))
        })
    }

    fn load_of(
        &self,
        elimination: &Elimination,
        (k, f): (&[f64], &[f64]),
        by_columns: &[f64],
        of_slaves: &mut [f64],
        f_q: &mut [f64],
    ) -> Result<(), ArgumentError> {
        let (plan, slaves) = (&self.plan, elimination.slaves());
        // `(K u_0)_dof` for a line of K, which may be left out where it has no DOFs that move by themselves.
        let stress = |dof: usize, line: &[(u32, u32)]| {
            if plan.by_columns {
                return by_columns[dof];
            }
            let moved = line.iter().filter(|&&(_, j)| self.number[j as usize] == NONE);
            moved.map(|&(e, j)| k[e as usize] * self.shift(elimination, j as usize)).sum()
        };
        let of_slave = |(a, out): (usize, &mut f64)| *out = f[slaves[a]] - stress(slaves[a], plan.of_slaves.line(a));
        if slaves.len() < 2 * WORTH_A_THREAD || rayon::current_num_threads() == 1 {
            of_slaves.iter_mut().enumerate().for_each(of_slave);
        } else {
            of_slaves.par_iter_mut().with_min_len(WORTH_A_THREAD).enumerate().for_each(of_slave);
        }
        let of_slaves = &*of_slaves;
        fill(f_q, "f_q", |q| {
            let line = if let Source::Mixed(m) = plan.source[q] { plan.mixed.line(m as usize) } else { &[] };
            let own = f[self.dofs[q]] - stress(self.dofs[q], line);
            own + self.followers.row(q).map(|(a, v)| v * of_slaves[a]).sum::<f64>()
        })
    }

    /// `K u_0` at all DOFs, if lines of K are columns.
    fn stress_by_columns(&self, elimination: &Elimination, k: &[f64], stress: &mut [f64]) {
        if !self.plan.by_columns {
            return;
        }
        stress.fill(0.0);
        let of_slaves = elimination.slaves().iter().enumerate().map(|(a, &dof)| (dof, self.plan.of_slaves.line(a)));
        let of_given = self.plan.of_given.iter().map(|(dof, entries)| (*dof as usize, entries.line(0)));
        for (dof, line) in of_slaves.chain(of_given) {
            let u = self.shift(elimination, dof);
            line.iter().for_each(|&(e, i)| stress[i as usize] += k[e as usize] * u);
        }
    }
}
