//! `f_q = L^T (f - K u_0)`; u_0 is zero but for slaves and prescribed DOFs.

use super::plan::Source;
use super::{Condensed, NONE};
use crate::ArgumentError;
use crate::common::argument::{long, numbers};
use crate::map::Map;

impl Condensed {
    /// `f_q = L^T (f - K u_0)` alone, for other forces or after a [`Map::refresh`].
    ///
    /// # Errors
    /// As [`Condensed::condense_into`].
    pub fn load_into(&self, map: &Map, k: &[f64], f: &[f64], f_q: &mut [f64]) -> Result<(), ArgumentError> {
        self.check(map, self.nnz())?;
        long("the list of values of K", k.len(), self.plan.entries)?;
        numbers("the list of forces", f, map.dofs())?;
        long("the list of forces on unknowns", f_q.len(), self.unknowns())?;
        let stress = self.stress(map, k);
        let left = |dof: usize| f[dof] - stress[dof];
        let slaves = map.slaves();
        for (q, &dof) in self.dofs.iter().enumerate() {
            f_q[q] = left(dof) + self.followers.row(q).map(|(a, v)| v * left(slaves[a])).sum::<f64>();
        }
        match f_q.iter().position(|v| !v.is_finite()) {
            Some(place) => Err(ArgumentError::Overflow { what: "f_q", place }),
            None => Ok(()),
        }
    }

    /// `K u_0` where somebody asks for it: at unknowns and slaves.
    fn stress(&self, map: &Map, k: &[f64]) -> Vec<f64> {
        let mut stress = vec![0.0; map.dofs()];
        let (plan, slaves) = (&self.plan, map.slaves());
        if plan.by_columns {
            let of_given = plan.of_given.iter().map(|(dof, entries)| (*dof as usize, entries.line(0)));
            for (dof, line) in slaves.iter().enumerate().map(|(a, &dof)| (dof, plan.of_slaves.line(a))).chain(of_given)
            {
                let u = self.shift(map, dof);
                line.iter().for_each(|&(e, i)| stress[i as usize] += k[e as usize] * u);
            }
            return stress;
        }
        let sum = |line: &[(u32, u32)]| {
            let moved = line.iter().filter(|&&(_, j)| self.number[j as usize] == NONE);
            moved.map(|&(e, j)| k[e as usize] * self.shift(map, j as usize)).sum()
        };
        slaves.iter().enumerate().for_each(|(a, &dof)| stress[dof] = sum(plan.of_slaves.line(a)));
        for (source, &dof) in plan.source.iter().zip(&self.dofs) {
            if let Source::Mixed(m) = *source {
                stress[dof] = sum(plan.mixed.line(m as usize));
            }
        }
        stress
    }
}
