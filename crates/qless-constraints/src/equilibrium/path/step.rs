//! One load step: first from the last equilibrium, then once more from the nearest configuration that satisfies the constraints (at a dead
//! centre first order knows no way).

use super::super::branch::Turn;
use super::super::correct::Corrector;
use super::super::failure::Failure;
use super::super::rows::Rows;
use super::super::stability::stability;
use super::super::state::Unknowns;
use super::super::{LoadStep, Model};
use super::Path;
use crate::newton::{NewtonError, NewtonOptions};
use crate::set::rotations::shorten;

impl<M: Model> Path<'_, M> {
    /// Equilibrium at a factor, from the last one.
    pub(super) fn step(&mut self, [last, factor]: [f64; 2]) -> Result<(Unknowns, Rows), Failure> {
        let between = |from: f64, to: f64| if factor == 1.0 { to } else { from + factor * (to - from) };
        let loads: Vec<f64> = self.start.loads.iter().zip(self.target.loads).map(|(&a, &b)| between(a, b)).collect();
        let prescribed: Vec<(usize, f64)> =
            self.target.prescribed.iter().map(|&(j, v)| (j, between(self.start.u[j], v))).collect();
        // Half a turn at most, so that none comes to a whole one, where it is singular.
        self.rotations.iter().for_each(|&vector| _ = shorten(&mut self.at.u, vector));
        let rows = self.origin(&prescribed);
        self.course.go(factor)?;
        if let Some(branch) = &self.branch {
            branch.lead(&mut self.course, [last, factor], &mut self.state.quantities)?;
        }
        let first = rows.and_then(|rows| self.attempt(self.at.clone(), rows, factor, (&loads, &prescribed)));
        match first {
            Err(failure @ Failure::Branch(_)) => Err(failure),
            Err(failure) if !failure.is_fatal() => self.again(failure, factor, (&loads, &prescribed)),
            other => other,
        }
    }

    /// From the nearest configuration that satisfies the constraints.
    fn again(
        &mut self,
        failure: Failure,
        factor: f64,
        (loads, prescribed): (&[f64], &[(usize, f64)]),
    ) -> Result<(Unknowns, Rows), Failure> {
        let u = match self.consistent(prescribed, NewtonOptions::default().steps) {
            Ok(u) if u != self.at.u => u,
            Err(proof @ Failure::Constraints(NewtonError::Conflict { .. })) => return Err(proof),
            _ => return Err(failure),
        };
        let rows = self.rows_at(&u, prescribed)?;
        let from = Unknowns { u, multipliers: self.at.multipliers.clone() };
        self.attempt(from, rows, factor, (loads, prescribed)).map_err(|second| match second {
            // Of two reasons the first, which is that of the shorter way.
            Failure::NoConvergence => failure,
            other => other,
        })
    }

    fn attempt(
        &mut self,
        mut x: Unknowns,
        mut rows: Rows,
        factor: f64,
        (loads, prescribed): (&[f64], &[(usize, f64)]),
    ) -> Result<(Unknowns, Rows), Failure> {
        let mut corrector = Corrector {
            model: &mut *self.model,
            set: self.course.set(),
            options: self.options,
            loads,
            prescribed,
            free: &self.free,
            state: &mut self.state,
            iterates: Vec::new(),
            changes: 0,
            pattern: &mut self.pattern,
            in_units: &mut self.in_units,
        };
        let mut result = corrector.run(&mut x, &mut rows);
        if result.is_ok() {
            let turn = self.branch.as_ref().map_or(Ok(Turn::default()), |b| b.turn(&corrector.state.quantities));
            result = turn.map(|turn| self.turn = turn);
        }
        if result.is_ok() && factor == 1.0 {
            result = corrector.supported(&rows).map(|saddle| {
                let asked = self.options.stability;
                self.stability = asked.then(|| stability(saddle.matrix(), self.free.len()));
            });
        }
        let iterates = corrector.iterates;
        let branches_meet = self.turn.met || self.rank.is_some_and(|rank| rank != rows.list().len());
        self.steps.push(LoadStep { factor, converged: result.is_ok(), branches_meet, iterates });
        result.map(|()| (x, rows))
    }
}
