//! One load step of all parts: first from the last equilibrium, then those that failed once more from the nearest configuration that satisfies the
//! constraints (at a dead centre first order knows no way).

use super::super::branch::{Branch, Turn, lead};
use super::super::correct::{Corrector, Progress, side_by_side};
use super::super::failure::Failure;
use super::super::rows::Rows;
use super::super::stability::stability;
use super::super::state::Unknowns;
use super::super::{LoadStep, Model};
use super::Path;
use super::track::Failures;
use qless_constraints::shorten_rotation;

/// Where a load step goes to.
pub(super) struct End {
    pub factor: f64,
    pub loads: Vec<f64>,
    pub prescribed: Vec<(usize, f64)>,
    /// The value of each prescribed DOF.
    pub goal: Vec<Option<f64>>,
}

impl<M: Model> Path<'_, M> {
    /// Equilibrium at a factor, from the last one.
    pub(super) fn step(&mut self, [last, factor]: [f64; 2]) -> Result<(Unknowns, Vec<Rows>), Failures> {
        let end = self.end(factor);
        // Half a turn at most, so that none comes to a whole one, where it is singular.
        self.rotations.iter().for_each(|&vector| _ = shorten_rotation(&mut self.at.u, vector));
        let origin = self.origin(&end.prescribed);
        self.course.go(factor)?;
        let branches: Vec<&Branch> = self.tracks.iter().filter_map(|track| track.branch.as_ref()).collect();
        let led = lead(&branches, &mut self.course, [last, factor], &mut self.state.quantities)?;
        if !led.is_empty() {
            return Err(led.into_values().collect());
        }
        let mut x = self.at.clone();
        let (mut all, mut whole) = match origin {
            Ok(all) => (all, None),
            Err(failure) => (Vec::new(), Some(failure)),
        };
        if whole.is_none() {
            whole = self.attempt((&mut x, None), &mut all, &end).err();
        }
        if !whole.as_ref().is_some_and(Failure::is_fatal)
            && (whole.is_some() || all.iter().any(Progress::may_start_again))
        {
            whole = self.again(&mut x, &mut all, whole, &end);
        }
        let all = Failures::new(whole, all)?;
        Ok((x, all.into_iter().map(|own| own.rows).collect()))
    }

    fn end(&self, factor: f64) -> End {
        let between = |from: f64, to: f64| if factor == 1.0 { to } else { from + factor * (to - from) };
        let loads = self.start.loads.iter().zip(self.target.loads).map(|(&a, &b)| between(a, b)).collect();
        let value = |&(j, v): &(usize, f64)| (j, between(self.start.u[j], v));
        let prescribed: Vec<(usize, f64)> = self.target.prescribed.iter().map(value).collect();
        let mut goal = vec![None; self.start.u.len()];
        prescribed.iter().for_each(|&(j, v)| goal[j] = Some(v));
        End { factor, loads, prescribed, goal }
    }

    /// Goes with the parts that are going as far as they come; an error is one of the whole model. `before` is where it could be evaluated.
    pub(super) fn attempt(
        &mut self,
        (x, before): (&mut Unknowns, Option<Unknowns>),
        all: &mut [Progress],
        end: &End,
    ) -> Result<(), Failure> {
        let ran: Vec<usize> = (0..all.len()).filter(|&part| all[part].is_going()).collect();
        let mut corrector = Corrector {
            model: &mut *self.model,
            set: self.course.set(),
            options: self.options,
            loads: &end.loads,
            prescribed: &end.prescribed,
            parts: &self.parts,
            state: &mut self.state,
            factoring: &mut self.factoring,
            all,
            goal: &end.goal,
            looked: before,
        };
        let mut result = corrector.run(x);
        if result.is_ok() {
            for &part in &ran {
                let own = &mut corrector.all[part];
                let branch = self.tracks[part].branch.as_ref().filter(|_| own.is_done());
                match branch.map_or(Ok(Turn::default()), |branch| branch.turn(&corrector.state.quantities)) {
                    Ok(turn) => self.tracks[part].turn = turn,
                    Err(failure) => own.fail(failure),
                }
            }
        }
        if result.is_ok() && end.factor == 1.0 {
            let done: Vec<usize> = ran.iter().copied().filter(|&part| corrector.all[part].is_done()).collect();
            result = corrector.supported(&done, x).map(|tangents| {
                for (part, saddle) in tangents.into_iter().filter(|_| self.options.stability) {
                    let free = self.parts.list[part].free.len();
                    self.tracks[part].stability = Some(stability(saddle.matrix(), free));
                }
            });
        }
        self.note(&ran, all, end.factor, result.is_ok());
        result
    }

    fn note(&mut self, ran: &[usize], all: &[Progress], factor: f64, evaluated: bool) {
        ran.iter().for_each(|&part| self.tracks[part].iterates = all[part].iterates.len());
        let converged = evaluated && ran.iter().all(|&part| all[part].is_done());
        let branches_meet = self.tracks.iter().zip(all).any(|(track, own)| track.meets(own));
        let iterates: Vec<_> = ran.iter().map(|&part| &all[part].iterates[..]).collect();
        self.steps.push(LoadStep { factor, converged, branches_meet, iterates: side_by_side(&iterates) });
    }
}
