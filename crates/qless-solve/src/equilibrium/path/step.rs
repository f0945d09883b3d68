//! One load step of all parts. The first attempt starts from the last equilibrium. Failed parts are tried again from the nearest
//! configuration that satisfies the constraints, which helps at dead centres.

use qless_constraints::shorten_rotation;

use super::super::branch::{Branch, BranchCheck, check_jumps};
use super::super::correct::{Corrector, PartProgress, PartStage, side_by_side};
use super::super::error::StepFailure;
use super::super::rows::PartRows;
use super::super::stability::stability;
use super::super::state::Unknowns;
use super::super::{LoadStep, Model};
use super::Path;
use super::origin::NearestConsistent;
use super::track::StepFailures;
use crate::newton::{NewtonError, NewtonOptions};

/// The end of a load step.
pub(super) struct StepTarget {
    pub factor: f64,
    pub loads: Vec<f64>,
    pub prescribed: Vec<(usize, f64)>,
    /// The value of each prescribed DOF; none for free DOFs.
    pub goal: Vec<Option<f64>>,
}

impl<M: Model> Path<'_, M> {
    /// Finds the equilibrium at a load factor, starting from the last one.
    pub(super) fn step(&mut self, [last, factor]: [f64; 2]) -> Result<(Unknowns, Vec<PartRows>), StepFailures> {
        let end = self.end(factor);
        // A rotation vector of a whole turn is singular, so that vectors are shortened to half a turn at most.
        self.rotations.iter().for_each(|&vector| _ = shorten_rotation(&mut self.at.u, vector));
        let origin = self.origin(&end.prescribed);
        self.constraints.advance_to(factor)?;
        let branches: Vec<&Branch> = self.tracks.iter().filter_map(|track| track.branch.as_ref()).collect();
        let failures = check_jumps(&branches, &mut self.constraints, [last, factor], &mut self.state.evaluation)?;
        if !failures.is_empty() {
            return Err(failures.into_values().collect());
        }
        let mut x = self.at.clone();
        let (mut all, mut whole) = match origin {
            Ok(all) => (all, None),
            Err(failure) => (Vec::new(), Some(failure)),
        };
        if whole.is_none() {
            whole = self.attempt((&mut x, None), &mut all, &end).err();
        }
        if !whole.as_ref().is_some_and(StepFailure::is_fatal)
            && (whole.is_some() || all.iter().any(PartProgress::may_start_again))
        {
            whole = self.try_again(&mut x, &mut all, whole, &end);
        }
        let all = StepFailures::new(whole, all)?;
        Ok((x, all.into_iter().map(|own| own.rows).collect()))
    }

    fn end(&self, factor: f64) -> StepTarget {
        let between = |from: f64, to: f64| if factor == 1.0 { to } else { from + factor * (to - from) };
        let loads = self.start.loads.iter().zip(self.target.loads).map(|(&a, &b)| between(a, b)).collect();
        let value = |&(j, v): &(usize, f64)| (j, between(self.start.u[j], v));
        let prescribed: Vec<(usize, f64)> = self.target.prescribed.iter().map(value).collect();
        let mut goal = vec![None; self.start.u.len()];
        prescribed.iter().for_each(|&(j, v)| goal[j] = Some(v));
        StepTarget { factor, loads, prescribed, goal }
    }

    /// Iterates the parts that are not done. An error concerns the whole model; `before` is the last configuration that could be evaluated.
    pub(super) fn attempt(
        &mut self,
        (x, before): (&mut Unknowns, Option<Unknowns>),
        all: &mut [PartProgress],
        end: &StepTarget,
    ) -> Result<(), StepFailure> {
        let ran: Vec<usize> = (0..all.len()).filter(|&part| all[part].is_iterating()).collect();
        let mut corrector = Corrector {
            model: &mut *self.model,
            set: self.constraints.set(),
            options: self.options,
            loads: &end.loads,
            prescribed: &end.prescribed,
            parts: &self.parts,
            state: &mut self.state,
            factoring: &mut self.factoring,
            all,
            goal: &end.goal,
            last_valid: before,
        };
        let mut result = corrector.run(x);
        if result.is_ok() {
            for &part in &ran {
                let own = &mut corrector.all[part];
                let branch = self.tracks[part].branch.as_ref().filter(|_| own.is_done());
                match branch.map_or(Ok(BranchCheck::default()), |branch| branch.check(&corrector.state.evaluation)) {
                    Ok(check) => self.tracks[part].branch_check = check,
                    Err(failure) => own.fail(failure),
                }
            }
        }
        if result.is_ok() && end.factor == 1.0 {
            let done: Vec<usize> = ran.iter().copied().filter(|&part| corrector.all[part].is_done()).collect();
            result = corrector.check_support(&done, x).map(|tangents| {
                for (part, saddle) in tangents.into_iter().filter(|_| self.options.stability) {
                    let free = self.parts.list[part].free.len();
                    self.tracks[part].stability = Some(stability(&saddle.a, free));
                }
            });
        }
        self.note(&ran, all, end.factor, result.is_ok());
        result
    }

    fn note(&mut self, ran: &[usize], all: &[PartProgress], factor: f64, evaluated: bool) {
        ran.iter().for_each(|&part| self.tracks[part].iterates = all[part].iterates.len());
        let converged = evaluated && ran.iter().all(|&part| all[part].is_done());
        let branches_meet = self.tracks.iter().zip(all).any(|(track, own)| track.branches_meet(own));
        let iterates: Vec<_> = ran.iter().map(|&part| &all[part].iterates[..]).collect();
        self.steps.push(LoadStep { factor, converged, branches_meet, iterates: side_by_side(&iterates) });
    }
}

impl<M: Model> Path<'_, M> {
    /// Second attempt with the failed parts, or with all if the whole model failed; returns the remaining failure of the whole.
    ///
    /// The error of the first attempt is kept, unless the second one says more than missing convergence, or there is proof that the
    /// constraints have no solution.
    pub(super) fn try_again(
        &mut self,
        x: &mut Unknowns,
        all: &mut Vec<PartProgress>,
        whole: Option<StepFailure>,
        end: &StepTarget,
    ) -> Option<StepFailure> {
        let Ok(mut found) = self.consistent(&end.prescribed, NewtonOptions::default().steps) else { return whole };
        match whole {
            None => self.parts_again(x, all, found, end),
            Some(whole) => {
                let proof = |error: &Option<NewtonError>| matches!(error, Some(NewtonError::Conflict { .. }));
                if let Some(part) = found.errors.iter().position(proof) {
                    return found.errors[part].take().map(StepFailure::Constraints);
                }
                self.all_again(x, all, (whole, found), end)
            }
        }
    }

    fn parts_again(
        &mut self,
        x: &mut Unknowns,
        all: &mut [PartProgress],
        mut found: NearestConsistent,
        end: &StepTarget,
    ) -> Option<StepFailure> {
        let mut retried = Vec::new();
        for (part, own) in all.iter_mut().enumerate().filter(|(_, own)| own.may_start_again()) {
            match found.errors[part].take() {
                Some(proof @ NewtonError::Conflict { .. }) => {
                    own.stage = PartStage::Failed(StepFailure::Constraints(proof));
                }
                None if self.is_elsewhere(part, &found.u, end) => retried.push(part),
                _ => (),
            }
        }
        if retried.is_empty() {
            return None;
        }
        let before = x.clone();
        self.put(x, &retried, &found.u, end);
        let choice = match self.choice_at(&x.u, &end.prescribed) {
            Ok(choice) => choice,
            Err(failure) => return Some(failure),
        };
        let other = |&part: &usize| {
            let rows = PartRows::new(&self.parts.list[part].rows, &choice);
            (part, std::mem::replace(&mut all[part], PartProgress::new(rows)))
        };
        let firsts: Vec<_> = retried.iter().map(other).collect();
        let second = self.attempt((x, Some(before)), all, end).err();
        for (part, first) in firsts {
            if let PartStage::Failed(StepFailure::NoConvergence) = all[part].stage {
                all[part].stage = first.stage;
            }
        }
        second
    }

    fn all_again(
        &mut self,
        x: &mut Unknowns,
        all: &mut Vec<PartProgress>,
        (whole, found): (StepFailure, NearestConsistent),
        end: &StepTarget,
    ) -> Option<StepFailure> {
        let every = 0..self.parts.list.len();
        let there = every.filter(|&part| found.errors[part].is_none());
        let retried: Vec<usize> = there.filter(|&part| self.is_elsewhere(part, &found.u, end)).collect();
        if retried.is_empty() {
            return Some(whole);
        }
        *x = self.at.clone();
        self.put(x, &retried, &found.u, end);
        let choice = match self.choice_at(&x.u, &end.prescribed) {
            Ok(choice) => choice,
            Err(failure) => return Some(failure),
        };
        *all = self.parts.list.iter().map(|part| PartProgress::new(PartRows::new(&part.rows, &choice))).collect();
        let second = self.attempt((x, None), all, end).err();
        let knows_more = |own: &PartProgress| !matches!(own.stage, PartStage::Failed(StepFailure::NoConvergence));
        if second.is_none() && !all.iter().all(knows_more) { Some(whole) } else { second }
    }

    /// Whether u differs from the last equilibrium in the free DOFs of a part, or prescribed DOFs of the part have yet to move.
    fn is_elsewhere(&self, part: usize, u: &[f64], end: &StepTarget) -> bool {
        let (part, at) = (&self.parts.list[part], &self.at.u);
        part.free.iter().any(|&j| u[j] != at[j]) || part.prescribed.iter().any(|&j| end.goal[j] != Some(at[j]))
    }

    /// Moves parts to u, and prescribed DOFs to their values.
    fn put(&self, x: &mut Unknowns, parts: &[usize], u: &[f64], end: &StepTarget) {
        for part in parts.iter().map(|&part| &self.parts.list[part]) {
            part.free.iter().for_each(|&j| x.u[j] = u[j]);
            part.rows.iter().for_each(|&r| x.multipliers[r] = self.at.multipliers[r]);
        }
        end.prescribed.iter().for_each(|&(j, v)| x.u[j] = v);
    }
}
