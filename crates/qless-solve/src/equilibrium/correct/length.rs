//! Step lengths by the natural monotonicity test (Deuflhard, Newton Methods for Nonlinear Problems, NLEQ-ERR): the next correction with the
//! same matrix, `A^-1 F(x + t dx)`, is shorter than dx by the fraction `t / 4`. If a stiff direction bends (an axis, a rod), forces rise
//! for a step although the error falls; a test of the residual would forbid that step.
//!
//! All parts try their lengths together. Parts that have found their length wait.

use super::super::state::Unknowns;
use super::super::{Model, StepFailure};
use super::{Correction, Corrector, PartStage};

/// Smaller step lengths count as failure.
const SHORTEST: f64 = 1e-4;
/// Within this factor of the tolerance, rounding makes the test meaningless.
const NEAR: f64 = 1e3;

/// A part that searches for its step length.
pub(super) struct LengthSearch {
    step: Correction,
    size: f64,
    t: f64,
    found: bool,
}

impl<M: Model> Corrector<'_, M> {
    /// Starts the searches, with a full step if only rounding is left. Parts whose prescribed DOFs have yet to move become ready instead.
    pub(super) fn starts(&mut self, x: &Unknowns, steps: Vec<Correction>) -> Vec<LengthSearch> {
        let mut searches = Vec::new();
        for step in steps {
            let arrived = self.arrived(step.part, x);
            let own = &mut self.all[step.part];
            if step.only_multipliers {
                searches.push(LengthSearch { step, size: 0.0, t: 0.0, found: true });
            } else if !arrived {
                own.stage = PartStage::Ready(step.dx);
            } else {
                let now = own.iterates.last().copied().unwrap_or_default();
                let near = now.force <= NEAR * self.options.tolerance
                    && now.constraint <= NEAR * f64::EPSILON * self.options.roundings;
                let t = if near || own.length <= 0.0 { 1.0 } else { (4.0 * own.length).min(1.0) };
                let size = step.saddle.length(&step.dx);
                searches.push(LengthSearch { step, size, t, found: near });
            }
        }
        searches
    }

    /// Moves each part by its step length.
    pub(super) fn go(&mut self, x: &mut Unknowns, mut searches: Vec<LengthSearch>) -> Result<(), StepFailure> {
        while searches.iter().any(|search| !search.found) {
            self.attempt(x, &mut searches)?;
        }
        for LengthSearch { step, t, .. } in searches {
            if !step.only_multipliers && is_none(t) {
                self.fail_part(step.part, StepFailure::NoConvergence, x);
            } else {
                let of_multipliers = if step.only_multipliers { 1.0 } else { t };
                self.advance(x, step.part, &step.dx, (t, of_multipliers));
                self.all[step.part].length = t;
            }
        }
        Ok(())
    }

    /// One trial of all open searches; overwrites forces, c and G of x.
    fn attempt(&mut self, x: &Unknowns, searches: &mut [LengthSearch]) -> Result<(), StepFailure> {
        let mut trial = x.clone();
        let mut open: Vec<&mut LengthSearch> = searches.iter_mut().filter(|search| !search.found).collect();
        open.iter().for_each(|LengthSearch { step, t, .. }| self.advance(&mut trial, step.part, &step.dx, (*t, *t)));
        match self.state.balance(self.model, self.set, &trial, self.loads) {
            Ok(()) => open.iter_mut().for_each(|search| self.judge(&trial, search)),
            Err(StepFailure::Model(refusal)) => {
                let parts: Vec<usize> = open.iter().map(|search| search.step.part).collect();
                let rejected = self.locate_failure(&x.u, &trial.u, &parts, refusal);
                let is_rejected =
                    |part: usize| rejected.as_ref().map_or(true, |list| list.iter().any(|(p, _)| *p == part));
                open.iter_mut().filter(|search| is_rejected(search.step.part)).for_each(|search| search.cut(0.25));
            }
            Err(other) => return Err(other),
        }
        Ok(())
    }

    /// Accepts the length if the next correction, `-A^-1 F(x + t dx)`, is short enough; otherwise chooses the next length.
    fn judge(&self, trial: &Unknowns, search: &mut LengthSearch) {
        let LengthSearch { step: Correction { part, saddle, dx, .. }, size, t, .. } = &*search;
        let (size, t) = (*size, *t);
        if self.state.finite(&self.parts.list[*part]).is_err() {
            return search.cut(0.25);
        }
        let next = saddle.solve(&self.rhs(*part, trial));
        if saddle.length(&next) <= (1.0 - 0.25 * t) * size {
            search.found = true;
            return;
        }
        let off: Vec<f64> = next.iter().zip(dx).map(|(a, b)| a - (1.0 - t) * b).collect();
        let best = 0.5 * size * t * t / saddle.length(&off);
        search.put(best.clamp(0.1 * t, 0.5 * t));
    }

    /// Moves a part along a correction.
    pub(super) fn advance(&self, x: &mut Unknowns, part: usize, dx: &[f64], (t, of_multipliers): (f64, f64)) {
        let free = &self.parts.list[part].free;
        free.iter().zip(dx).for_each(|(&j, dx)| x.u[j] += t * dx);
        let multipliers = self.all[part].rows.list.iter().zip(&dx[free.len()..]);
        multipliers.for_each(|(&r, dx)| x.multipliers[r] += of_multipliers * dx);
    }

    /// Moves prescribed DOFs to their values as soon as all parts are ready, together with these parts.
    pub(super) fn move_prescribed(&mut self, x: &mut Unknowns) {
        let behind = |part: usize| self.all[part].is_iterating() && !self.arrived(part, x);
        if (0..self.all.len()).any(behind) {
            return;
        }
        for part in 0..self.all.len() {
            if let PartStage::Ready(dx) = &self.all[part].stage {
                self.advance(x, part, dx, (1.0, 1.0));
                (self.all[part].stage, self.all[part].length) = (PartStage::Iterating, 1.0);
            }
        }
        self.prescribed.iter().for_each(|&(j, v)| x.u[j] = v);
    }

    /// Parts that reach the limit of iterations fail.
    pub(super) fn stop_at_limit(&mut self, x: &mut Unknowns) {
        for part in self.iterating() {
            if self.all[part].iterates.len() > self.options.iterations {
                self.fail_part(part, StepFailure::NoConvergence, x);
            }
        }
    }
}

impl LengthSearch {
    fn cut(&mut self, by: f64) {
        self.put(by * self.t);
    }

    fn put(&mut self, t: f64) {
        (self.t, self.found) = (t, is_none(t));
    }
}

fn is_none(t: f64) -> bool {
    t < SHORTEST || t.is_nan()
}
