//! Finds step lengths t by the natural monotonicity test (Deuflhard, Newton Methods for Nonlinear Problems, NLEQ-ERR). The next correction
//! with the same tangent A and the residual F, `A^-1 F(x + t dx)`, must be shorter than dx by at least the fraction `t / 4`. The test
//! compares corrections, not residuals: if a stiff direction bends (an axis, a rod), a step raises forces although it reduces the error.
//!
//! All parts try their lengths together. Parts that have found their length wait.

use super::corrector::{Correction, Corrector, PartStage};
use super::state::Unknowns;
use super::{EquilibriumError, Model};

/// A part whose step length falls below this number fails. The load step is then shortened instead, which serves better, since Newton's
/// method converges along a shorter load step.
const SHORTEST: f64 = 1e-4;
/// If residuals are within this factor of their tolerance, a full step is taken without a test. Rounding would make the test meaningless,
/// and the next residual is about the square of this one.
const NEAR: f64 = 1e3;

/// A part that searches for its step length.
struct LengthSearch {
    step: Correction,
    size: f64,
    t: f64,
    found: bool,
}

impl<M: Model> Corrector<'_, M> {
    /// Moves each part by its step length. Parts whose prescribed DOFs have yet to move become ready instead.
    pub fn go(&mut self, x: &mut Unknowns, steps: Vec<Correction>) -> Result<(), EquilibriumError> {
        let mut searches: Vec<LengthSearch> = steps.into_iter().filter_map(|step| self.start(step)).collect();
        while searches.iter().any(|search| !search.found) {
            self.attempt(x, &mut searches)?;
        }
        for LengthSearch { step, t, .. } in searches {
            if step.only_multipliers {
                self.advance(x, step.part, &step.dx, (0.0, 1.0));
            } else if t < SHORTEST {
                self.fail_part(step.part, self.no_convergence(step.part), x);
            } else {
                self.advance(x, step.part, &step.dx, (t, t));
            }
            self.all[step.part].length = t;
        }
        Ok(())
    }

    /// Starts the search for the step length of a part. If residuals are near their tolerance, a full step needs no search; `None` if the
    /// part waits for prescribed DOFs.
    fn start(&mut self, step: Correction) -> Option<LengthSearch> {
        let own = &mut self.all[step.part];
        if step.only_multipliers {
            return Some(LengthSearch { step, size: 0.0, t: 0.0, found: true });
        }
        if self.awaits[step.part] {
            own.stage = PartStage::Ready(step.dx);
            return None;
        }
        let now = own.iterates.last().copied().unwrap_or_default();
        let limits = [self.options.tolerance, f64::EPSILON * self.options.roundings];
        let near = now.force <= NEAR * limits[0] && now.constraint <= NEAR * limits[1];
        let t = if near || own.length <= 0.0 { 1.0 } else { (4.0 * own.length).min(1.0) };
        Some(LengthSearch { size: step.saddle.length(&step.dx), step, t, found: near })
    }

    /// Tries the lengths of all open searches once. This overwrites the evaluated forces, constraint values and Jacobian.
    fn attempt(&mut self, x: &Unknowns, searches: &mut [LengthSearch]) -> Result<(), EquilibriumError> {
        let mut trial = x.clone();
        let mut open: Vec<&mut LengthSearch> = searches.iter_mut().filter(|search| !search.found).collect();
        open.iter().for_each(|LengthSearch { step, t, .. }| self.advance(&mut trial, step.part, &step.dx, (*t, *t)));
        match self.state.balance(self.model, self.set, &trial, &self.end.loads) {
            Ok(()) => open.iter_mut().for_each(|search| self.judge(search)),
            Err(EquilibriumError::Model { .. }) => {
                let parts: Vec<usize> = open.iter().map(|search| search.step.part).collect();
                let mut rejected = self.rejected(&x.u, &trial.u, &parts);
                if rejected.is_empty() {
                    rejected = parts;
                }
                let of_rejected = open.iter_mut().filter(|search| rejected.contains(&search.step.part));
                of_rejected.for_each(|search| search.put(0.25 * search.t));
            }
            Err(other) => return Err(other),
        }
        Ok(())
    }

    /// Accepts the length t if the next Newton correction with the same tangent is short enough; otherwise chooses the next length.
    fn judge(&self, search: &mut LengthSearch) {
        let LengthSearch { step: Correction { part, saddle, dx, .. }, size, t, .. } = &*search;
        let (size, t) = (*size, *t);
        if self.state.finite(&self.parts.list[*part]).is_err() {
            return search.put(0.25 * t);
        }
        let next = saddle.solve(&self.rhs(*part));
        if saddle.length(&next) <= (1.0 - 0.25 * t) * size {
            search.found = true;
            return;
        }
        let off: Vec<f64> = next.iter().zip(dx).map(|(a, b)| a - (1.0 - t) * b).collect();
        let best = 0.5 * size * t * t / saddle.length(&off);
        search.put(best.clamp(0.1 * t, 0.5 * t));
    }

    /// Finds by bisection the parts whose motion from `before` to `now` the model rejects, if each moves alone.
    fn rejected(&mut self, before: &[f64], now: &[f64], moved: &[usize]) -> Vec<usize> {
        let mut u = before.to_vec();
        moved.iter().flat_map(|&part| &self.parts.list[part].free).for_each(|&j| u[j] = now[j]);
        self.state.assembly.clear(false);
        if moved.is_empty() || self.model.assemble(&u, &mut self.state.assembly).is_ok() {
            return Vec::new();
        }
        if moved.len() == 1 {
            return moved.to_vec();
        }
        let (first, second) = moved.split_at(moved.len() / 2);
        [first, second].into_iter().flat_map(|half| self.rejected(before, now, half)).collect()
    }
}

impl LengthSearch {
    fn put(&mut self, t: f64) {
        let t = if t.is_nan() { 0.0 } else { t };
        (self.t, self.found) = (t, t < SHORTEST);
    }
}
