//! Evaluates all parts and decides which of them need a correction. If the model rejects a configuration, it does not say for which part;
//! parts are then evaluated without the others, by bisection.

use std::error::Error;

use super::super::rows::RowChoice;
use super::super::state::Unknowns;
use super::super::{EquilibriumIterate, Model, StepFailure};
use super::{CHANGES, Corrector, PartStage};

/// Constraint values fall if they are at most this fraction of those before.
const FALLS: f64 = 0.5;

impl<M: Model> Corrector<'_, M> {
    /// Evaluates everything at x, and records the residuals of each part that iterates.
    pub(super) fn evaluate_all(&mut self, x: &mut Unknowns) -> Result<(), StepFailure> {
        let iterating = self.iterating();
        for &part in &iterating {
            let left_out = self.parts.list[part].rows.iter().filter(|&&r| !self.all[part].rows.kept(r));
            left_out.for_each(|&r| x.multipliers[r] = 0.0);
        }
        self.evaluate(x, &iterating)?;
        let rest = &self.parts.untouched;
        self.state.finite(rest).and_then(|()| self.state.finite_stiffness(rest))?;
        for part in iterating {
            let there = &self.parts.list[part];
            let found = self.state.finite(there).and_then(|()| self.state.finite_stiffness(there));
            found.unwrap_or_else(|failure| self.fail_part(part, failure, x));
        }
        self.measure(x);
        self.last_valid = Some(x.clone());
        Ok(())
    }

    /// Evaluates; parts that the model rejects return to their last valid configuration.
    fn evaluate(&mut self, x: &mut Unknowns, iterating: &[usize]) -> Result<(), StepFailure> {
        loop {
            let error = match self.state.evaluate(self.model, self.set, x, self.loads) {
                Err(StepFailure::Model(error)) => error,
                other => return other,
            };
            let Some(last_valid) = &self.last_valid else { return Err(StepFailure::Model(error)) };
            let (before, mut moved) = (last_valid.u.clone(), iterating.to_vec());
            moved.retain(|&part| self.all[part].is_iterating());
            let found = self.locate_failure(&before, &x.u, &moved, error).map_err(StepFailure::Model)?;
            found.into_iter().for_each(|(part, failure)| self.fail_part(part, failure, x));
        }
    }

    pub(super) fn iterating(&self) -> Vec<usize> {
        (0..self.all.len()).filter(|&part| self.all[part].is_iterating()).collect()
    }

    /// The part fails and returns to the last configuration that could be evaluated.
    pub(super) fn fail_part(&mut self, part: usize, failure: StepFailure, x: &mut Unknowns) {
        self.all[part].fail(failure);
        let Some(last_valid) = &self.last_valid else { return };
        let there = &self.parts.list[part];
        there.free.iter().for_each(|&j| x.u[j] = last_valid.u[j]);
        there.rows.iter().for_each(|&r| x.multipliers[r] = last_valid.multipliers[r]);
    }

    fn measure(&mut self, x: &Unknowns) {
        let iterating = self.iterating();
        let constraint =
            |own: &Self, part: usize| f64::EPSILON * own.state.constraint(own.all[part].rows.list.iter().copied());
        let falls = |&part: &usize| {
            let last = self.all[part].iterates.last();
            last.is_none_or(|last| constraint(self, part) <= FALLS * last.constraint)
        };
        let settled: Vec<_> =
            iterating.iter().filter(|part| !falls(part)).map(|&part| &self.parts.list[part]).collect();
        if !settled.is_empty() {
            self.state.settle((self.set, self.parts), settled.into_iter(), &x.u);
        }
        for part in iterating {
            let force = self.state.force(&self.parts.list[part].free, self.options.tolerance);
            let constraint = constraint(self, part);
            let own = &mut self.all[part];
            let (length, regularised) = (own.length, own.loose.is_some());
            own.iterates.push(EquilibriumIterate { force, constraint, length, regularised });
        }
    }

    /// The parts that need a correction. The others are done, or get other rows.
    pub(super) fn unbalanced(&mut self, x: &Unknowns) -> Result<Vec<usize>, StepFailure> {
        let (balanced, others): (Vec<usize>, Vec<usize>) =
            self.iterating().into_iter().partition(|&part| self.balanced(part, x));
        let (hold, off): (Vec<usize>, Vec<usize>) = balanced.into_iter().partition(|&part| self.all_hold(part));
        hold.into_iter().for_each(|part| self.all[part].stage = PartStage::Done);
        self.change(&off)?;
        Ok(others)
    }

    fn balanced(&self, part: usize, x: &Unknowns) -> bool {
        let found = self.all[part].iterates.last().copied().unwrap_or_default();
        self.arrived(part, x)
            && found.force <= self.options.tolerance
            && found.constraint <= f64::EPSILON * self.options.roundings
    }

    /// Whether redundant rows hold as well; rounding of the rows that they depend on is allowed.
    fn all_hold(&self, part: usize) -> bool {
        let (limit, rows) = (self.options.roundings, &self.all[part].rows);
        let holds = |r: usize| self.state.constraints[r] <= limit || self.state.follows(r, rows.certificate(r), limit);
        self.parts.list[part].rows.iter().all(|&r| rows.kept(r) || holds(r))
    }

    /// Gives these parts the rows that are independent here.
    fn change(&mut self, off: &[usize]) -> Result<(), StepFailure> {
        off.iter().for_each(|&part| self.all[part].changes += 1);
        let may = |&&part: &&usize| self.all[part].changes <= CHANGES;
        let choice = if off.iter().any(|part| may(&part)) { Some(self.choose()?) } else { None };
        for &part in off {
            let (rows, own) = (&self.parts.list[part].rows, &mut self.all[part]);
            let choice = choice.as_ref().filter(|_| own.changes <= CHANGES);
            if !choice.is_some_and(|choice| own.rows.renew(rows, choice)) {
                let violated = |&&r: &&usize| self.state.constraints[r] > self.options.roundings;
                own.fail(StepFailure::Conflict(rows.iter().filter(violated).copied().collect()));
            }
        }
        Ok(())
    }

    /// Analyses the rows where everything was evaluated last.
    pub(super) fn choose(&self) -> Result<std::sync::Arc<RowChoice>, StepFailure> {
        let before = self.all.iter().flat_map(|own| own.rows.list.iter().copied()).collect();
        let place = (self.set, self.parts);
        RowChoice::new(place, &self.state.evaluation, self.prescribed, (self.options, before))
    }
}

type ModelRefusal = Box<dyn Error + Send + Sync>;

impl<M: Model> Corrector<'_, M> {
    /// Finds the parts that the model rejects if they move alone from `before` to `now`; returns the refusal if no part alone is rejected.
    ///
    /// Cost: one evaluation per bisection, and none if only one part moved.
    pub(super) fn locate_failure(
        &mut self,
        before: &[f64],
        now: &[f64],
        moved: &[usize],
        refusal: ModelRefusal,
    ) -> Result<Vec<(usize, StepFailure)>, ModelRefusal> {
        if let [part] = *moved {
            return Ok(vec![(part, StepFailure::Model(refusal))]);
        }
        let (first, second) = moved.split_at(moved.len() / 2);
        let mut found = Vec::new();
        for half in [first, second] {
            if let Err(refusal) = self.alone(before, now, half) {
                found.extend(self.locate_failure(before, now, half, refusal)?);
            }
        }
        if found.is_empty() { Err(refusal) } else { Ok(found) }
    }

    /// Evaluates with only these parts moved, and the prescribed DOFs next to them.
    fn alone(&mut self, before: &[f64], now: &[f64], moved: &[usize]) -> Result<(), ModelRefusal> {
        let mut u = before.to_vec();
        let moved = moved.iter().map(|&part| &self.parts.list[part]);
        moved.for_each(|part| part.free.iter().chain(&part.prescribed).for_each(|&j| u[j] = now[j]));
        self.state.assembly.clear(false);
        self.model.assemble(&u, &mut self.state.assembly)
    }
}
