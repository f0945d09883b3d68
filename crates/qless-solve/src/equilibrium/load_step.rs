//! One load step of all parts. The first attempt starts from the last equilibrium. Failed parts are tried again from the nearest
//! configuration that satisfies the constraints, which helps at dead centres.

use std::sync::Arc;

use qless_constraints::shorten_rotation;

use super::branch::{Branch, BranchCheck, check_jumps};
use super::corrector::{Corrector, PartProgress, PartStage, StepTarget};
use super::path::Path;
use super::rows::{PartRows, RowChoice};
use super::stability::stability;
use super::state::Unknowns;
use super::{EquilibriumError, EquilibriumIterate, LoadStep, Model};
use crate::newton::{NewtonError, NewtonOptions, PartwiseSolution, solve_each};

/// Displacements, multipliers, and the kept rows of each part.
type StepEnd = (Unknowns, Vec<PartRows>);

impl<M: Model> Path<'_, M> {
    /// Finds the equilibrium at a load factor, starting from the last one.
    pub fn step(&mut self, [last, factor]: [f64; 2]) -> Result<StepEnd, EquilibriumError> {
        let between = |from: f64, to: f64| if factor == 1.0 { to } else { from + factor * (to - from) };
        let loads = self.start.loads.iter().zip(self.target.loads).map(|(&a, &b)| between(a, b)).collect();
        let value = |&(j, v): &(usize, f64)| (j, between(self.start.u[j], v));
        let prescribed: Vec<(usize, f64)> = self.target.prescribed.iter().map(value).collect();
        let end = StepTarget { factor, loads, prescribed };
        // A rotation vector of a whole turn is singular, so that vectors are shortened to half a turn at most.
        self.rotations.iter().for_each(|&vector| _ = shorten_rotation(&mut self.at.u, vector));
        let mut all = self.origin(&end.prescribed)?;
        self.constraints.advance_to(factor)?;
        let branches: Vec<&Branch> = self.tracks.iter().filter_map(|track| track.branch.as_ref()).collect();
        check_jumps(&branches, &mut self.constraints, [last, factor], &mut self.state.evaluation)?;
        let mut x = self.at.clone();
        let mut whole = self.attempt((&mut x, None), &mut all, &end).err();
        if !whole.as_ref().is_some_and(EquilibriumError::is_fatal) {
            whole = self.try_again(&mut x, &mut all, whole, &end);
        }
        let failed = |own: &mut PartProgress| match std::mem::replace(&mut own.stage, PartStage::Done) {
            PartStage::Failed(failure) => Some(failure),
            _ => None,
        };
        let failures: Vec<EquilibriumError> = whole.into_iter().chain(all.iter_mut().filter_map(failed)).collect();
        match failures.into_iter().min_by_key(|failure| !failure.is_fatal()) {
            Some(first) => Err(first),
            None => Ok((x, all.into_iter().map(|own| own.rows).collect())),
        }
    }

    /// Prepares all parts for the step with the rows that they keep, and sets up their branch checks.
    fn origin(&mut self, prescribed: &[(usize, f64)]) -> Result<Vec<PartProgress>, EquilibriumError> {
        let (all, holds) = match self.rows.clone() {
            Some(rows) => (rows.into_iter().map(PartProgress::new).collect(), vec![true; self.parts.list.len()]),
            None => self.rows_at_start(prescribed)?,
        };
        if self.rows.is_some() {
            self.constraints.set().evaluate(&self.at.u, &mut self.state.evaluation)?;
        }
        let before = Arc::new(self.state.evaluation.clone());
        for (part, track) in self.tracks.iter_mut().enumerate() {
            let rows = Some(&all[part].rows).filter(|_| track.driven && holds[part]);
            track.rank = rows.map(|rows| rows.list.len());
            track.branch = rows.and_then(|rows| Branch::new(&before, rows, (&self.parts, part)));
            track.branch_check = BranchCheck::default();
        }
        Ok(all)
    }

    /// Chooses the rows of each part at a configuration that satisfies its constraints: near the start, or else near the end of the step.
    /// The second result tells which parts have such a configuration near the start. The constraints of these parts are then evaluated
    /// there. A part without any such configuration takes the rows that are independent where the part is, or fails if its constraints
    /// conflict.
    fn rows_at_start(
        &mut self,
        prescribed: &[(usize, f64)],
    ) -> Result<(Vec<PartProgress>, Vec<bool>), EquilibriumError> {
        let held: Vec<(usize, f64)> = prescribed.iter().map(|&(j, _)| (j, self.at.u[j])).collect();
        let mut rows: Vec<Option<PartProgress>> = self.parts.list.iter().map(|_| None).collect();
        let (mut holds, mut near) = (Vec::new(), self.at.u.clone());
        for (place, values) in [&held[..], prescribed].into_iter().enumerate() {
            let Ok(found) = self.consistent(values) else { continue };
            let choice = self.choice_at(&found.u, values)?;
            for ((rows, error), part) in rows.iter_mut().zip(found.errors).zip(&self.parts.list) {
                if rows.is_none() {
                    let conflict =
                        error.clone().filter(|error| place == 1 && !matches!(error, NewtonError::NoConvergence { .. }));
                    if error.is_none() || conflict.is_some() {
                        let mut own = PartProgress::new(PartRows::new(&part.rows, &choice));
                        conflict
                            .into_iter()
                            .for_each(|source| own.fail(EquilibriumError::Constraints { factor: 0.0, source }));
                        *rows = Some(own);
                    }
                }
            }
            if place == 0 {
                holds = rows.iter().map(Option::is_some).collect();
                let parts = self.parts.list.iter().zip(&holds).filter(|(_, holds)| **holds);
                parts.flat_map(|(part, _)| &part.free).for_each(|&j| near[j] = found.u[j]);
                if !holds.contains(&false) {
                    break;
                }
            }
        }
        holds.resize(rows.len(), false);
        let choice = self.choice_at(&near, prescribed)?;
        let start = |(rows, part): (Option<PartProgress>, &crate::newton::Part)| {
            rows.unwrap_or_else(|| PartProgress::new(PartRows::new(&part.rows, &choice)))
        };
        Ok((rows.into_iter().zip(&self.parts.list).map(start).collect(), holds))
    }

    /// Evaluates the constraints at u and analyses their rows.
    fn choice_at(&mut self, u: &[f64], prescribed: &[(usize, f64)]) -> Result<Arc<RowChoice>, EquilibriumError> {
        let set = self.constraints.set();
        set.evaluate(u, &mut self.state.evaluation)?;
        let before = self.rows.iter().flatten().flat_map(|rows| rows.list.iter().copied()).collect();
        RowChoice::new((set, &self.parts), &self.state.evaluation, prescribed, (self.options, before))
    }

    /// Solves `c(u) = 0` with these prescribed values by Newton's method from the current configuration. The result has the error of each
    /// part in which this fails.
    fn consistent(&self, prescribed: &[(usize, f64)]) -> Result<PartwiseSolution, NewtonError> {
        let (tolerance, analysis) = (self.options.roundings, self.options.analysis.clone());
        let options = NewtonOptions { tolerance, analysis, ..NewtonOptions::default() };
        solve_each((self.constraints.set(), &self.parts), &self.at.u, prescribed, &options)
    }

    /// Iterates the parts that are not done. An error concerns the whole model; `last_valid` is the last configuration that could be
    /// evaluated.
    fn attempt(
        &mut self,
        (x, last_valid): (&mut Unknowns, Option<Unknowns>),
        all: &mut [PartProgress],
        end: &StepTarget,
    ) -> Result<(), EquilibriumError> {
        let ran: Vec<usize> = (0..all.len()).filter(|&part| all[part].is_iterating()).collect();
        let ahead = Self::ahead(&end.prescribed, &x.u);
        let awaits = self.awaits(&ahead);
        let mut corrector = Corrector {
            model: &mut *self.model,
            set: self.constraints.set(),
            options: self.options,
            parts: &self.parts,
            end,
            state: &mut self.state,
            patterns: &mut self.patterns,
            all,
            ahead,
            awaits,
            last_valid,
        };
        let mut result = corrector.run(x);
        for &part in ran.iter().filter(|_| result.is_ok()) {
            let (own, track) = (&mut corrector.all[part], &mut self.tracks[part]);
            let branch = track.branch.as_ref().filter(|_| own.is_done());
            match branch.map_or(Ok(BranchCheck::default()), |branch| branch.check(&corrector.state.evaluation)) {
                Ok(check) => track.branch_check = check,
                Err(failure) => own.fail(failure),
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
        let changed = |rank: Option<usize>, own: &PartProgress| rank.is_some_and(|rank| rank != own.rows.list.len());
        let mut tracks = self.tracks.iter().zip(all);
        let branches_meet = tracks.any(|(track, own)| track.branch_check.met || changed(track.rank, own));
        let iterates: Vec<_> = ran.iter().map(|&part| &all[part].iterates[..]).collect();
        self.steps.push(LoadStep { factor, converged, branches_meet, iterates: side_by_side(&iterates) });
    }

    /// Tries failed parts again from a configuration that satisfies the constraints, or all parts if the whole model failed. Returns the
    /// failure of the whole model, if it remains.
    ///
    /// The error of the first attempt is kept if the second one only lacks convergence. If the constraints are proven to have no solution,
    /// the error says so.
    fn try_again(
        &mut self,
        x: &mut Unknowns,
        all: &mut [PartProgress],
        whole: Option<EquilibriumError>,
        end: &StepTarget,
    ) -> Option<EquilibriumError> {
        // A part that left its branch would leave it again, so it is not tried again.
        let fails = |own: &PartProgress| matches!(&own.stage, PartStage::Failed(failure) if !matches!(failure, EquilibriumError::Branch { .. }));
        let asked: Vec<usize> = (0..all.len()).filter(|&part| whole.is_some() || fails(&all[part])).collect();
        if asked.is_empty() {
            return whole;
        }
        let Ok(mut found) = self.consistent(&end.prescribed) else { return whole };
        let moves = self.awaits(&Self::ahead(&end.prescribed, &self.at.u));
        let mut retried = Vec::new();
        for part in asked {
            match found.errors[part].take() {
                Some(source @ NewtonError::Conflict { .. }) => {
                    all[part].stage = PartStage::Failed(EquilibriumError::Constraints { factor: 0.0, source });
                }
                None if moves[part] || self.parts.list[part].free.iter().any(|&j| found.u[j] != self.at.u[j]) => {
                    retried.push(part);
                }
                _ => (),
            }
        }
        let proven = |own: &PartProgress| matches!(own.stage, PartStage::Failed(EquilibriumError::Constraints { .. }));
        if whole.is_some() && all.iter().any(proven) {
            return None;
        }
        if retried.is_empty() {
            return whole;
        }
        let before = if whole.is_some() { None } else { Some(x.clone()) };
        if whole.is_some() {
            *x = self.at.clone();
        }
        for part in retried.iter().map(|&part| &self.parts.list[part]) {
            part.free.iter().for_each(|&j| x.u[j] = found.u[j]);
            part.rows.iter().for_each(|&r| x.multipliers[r] = self.at.multipliers[r]);
        }
        end.prescribed.iter().for_each(|&(j, v)| x.u[j] = v);
        let choice = match self.choice_at(&x.u, &end.prescribed) {
            Ok(choice) => choice,
            Err(failure) => return Some(failure),
        };
        let again = if whole.is_some() { (0..all.len()).collect() } else { retried };
        let other = |&part: &usize| {
            let rows = PartRows::new(&self.parts.list[part].rows, &choice);
            (part, std::mem::replace(&mut all[part], PartProgress::new(rows)))
        };
        let firsts: Vec<_> = again.iter().map(other).collect();
        let second = self.attempt((x, before), all, end).err();
        let diverges =
            |own: &PartProgress| matches!(own.stage, PartStage::Failed(EquilibriumError::NoConvergence { .. }));
        if whole.is_some() {
            return second.or(whole.filter(|_| all.iter().any(diverges)));
        }
        firsts
            .into_iter()
            .filter(|(part, _)| diverges(&all[*part]))
            .collect::<Vec<_>>()
            .into_iter()
            .for_each(|(part, first)| all[part].stage = first.stage);
        second
    }
}

/// Merges the iterates of all parts; a part that has finished keeps its last iterate.
fn side_by_side(parts: &[&[EquilibriumIterate]]) -> Vec<EquilibriumIterate> {
    let most = parts.iter().map(|iterates| iterates.len()).max().unwrap_or(1);
    let mut all = vec![EquilibriumIterate { length: 1.0, ..EquilibriumIterate::default() }; most];
    for iterates in parts {
        let ended = iterates.last().map(|last| EquilibriumIterate { length: 1.0, regularised: false, ..*last });
        let own = iterates.iter().copied().chain(ended.into_iter().cycle());
        all.iter_mut().zip(own).for_each(|(all, own)| {
            all.force = all.force.max(own.force);
            all.constraint = all.constraint.max(own.constraint);
            all.length = all.length.min(own.length);
            all.regularised |= own.regularised;
        });
    }
    all
}
