//! The start of a load step: its independent rows, the branches of mechanisms, and rotations that only constraints use.

use std::sync::Arc;

use super::super::Model;
use super::super::branch::{Branch, BranchCheck};
use super::super::correct::{PartProgress, PartStage};
use super::super::error::StepFailure;
use super::super::rows::{PartRows, RowChoice};
use super::Path;
use crate::newton::{NewtonError, NewtonOptions, PartwiseSolution, solve_each};

/// Newton steps on the constraints, to find the redundant rows.
const LOOK: usize = 10;

/// The nearest configuration that satisfies the constraints, and the errors of parts without one.
pub(super) struct NearestConsistent {
    pub u: Vec<f64>,
    pub errors: Vec<Option<NewtonError>>,
}

impl<M: Model> Path<'_, M> {
    /// Rotation vectors that neither the model nor a load or prescribed value uses.
    pub(super) fn loose_rotations(&mut self) -> Vec<[usize; 3]> {
        let evaluated = self.state.balance(self.model, self.constraints.set(), &self.at, &self.start.loads).is_ok();
        let mut known = self.state.assembly.known();
        self.target.prescribed.iter().for_each(|&(j, _)| known[j] = true);
        let loads = self.start.loads.iter().zip(self.target.loads);
        known.iter_mut().zip(loads).for_each(|(known, (a, b))| *known |= *a != 0.0 || *b != 0.0);
        let mut vectors = self.constraints.set().rotation_vectors();
        vectors.retain(|vector| evaluated && vector.iter().all(|&dof| !known[dof]));
        vectors
    }

    /// All parts with the rows of the next step; also sets their branches.
    pub(super) fn origin(&mut self, prescribed: &[(usize, f64)]) -> Result<Vec<PartProgress>, StepFailure> {
        self.tracks
            .iter_mut()
            .for_each(|track| (track.branch, track.branch_check, track.rank) = (None, BranchCheck::default(), None));
        let (all, holds) = match self.rows.clone() {
            Some(rows) => (rows.into_iter().map(PartProgress::new).collect(), vec![true; self.parts.list.len()]),
            None => self.rows_at_start(prescribed)?,
        };
        let asked = |part: &usize| self.tracks[*part].driven && holds[*part];
        let asked: Vec<usize> = (0..self.parts.list.len()).filter(asked).collect();
        if asked.is_empty() {
            return Ok(all);
        }
        if self.rows.is_some() {
            self.constraints.set().evaluate(&self.at.u, &mut self.state.evaluation)?;
        }
        let before = Arc::new(self.state.evaluation.clone());
        for part in asked {
            let (track, rows) = (&mut self.tracks[part], &all[part].rows);
            track.rank = Some(rows.list.len());
            track.branch = Branch::new(&before, rows, (&self.parts, part), &mut track.of_branch);
        }
        Ok(all)
    }

    /// Chooses the rows of each part at a configuration near the start that satisfies its constraints. If Newton's method finds none within
    /// a few steps, the second result is `false`, and the rows are chosen by `rows_ahead` or else at the start itself.
    fn rows_at_start(&mut self, prescribed: &[(usize, f64)]) -> Result<(Vec<PartProgress>, Vec<bool>), StepFailure> {
        let held: Vec<(usize, f64)> = prescribed.iter().map(|&(j, _)| (j, self.at.u[j])).collect();
        let near = self.consistent(&held, LOOK).ok();
        let is_near = |part: usize| near.as_ref().is_some_and(|near| near.errors[part].is_none());
        let holds: Vec<bool> = (0..self.parts.list.len()).map(is_near).collect();
        let mut u = self.at.u.clone();
        let near = near.iter().flat_map(|near| self.parts.list.iter().map(|part| (part, &near.u))).zip(&holds);
        let near = near.filter(|(_, holds)| **holds);
        near.for_each(|((part, near), _)| part.free.iter().for_each(|&j| u[j] = near[j]));
        let mut far: Vec<Option<Result<Arc<RowChoice>, NewtonError>>> = holds.iter().map(|_| None).collect();
        if holds.contains(&false) {
            self.rows_ahead(&u, &holds, prescribed, &mut far)?;
        }
        let choice = self.choice_at(&u, prescribed)?;
        let start = |(part, far): (usize, Option<Result<Arc<RowChoice>, NewtonError>>)| {
            let rows = &self.parts.list[part].rows;
            match far {
                Some(Ok(far)) => PartProgress::new(PartRows::new(rows, &far)),
                other => {
                    let mut own = PartProgress::new(PartRows::new(rows, &choice));
                    if let Some(Err(error)) = other {
                        own.stage = PartStage::Failed(StepFailure::Constraints(error));
                    }
                    own
                }
            }
        };
        Ok((far.into_iter().enumerate().map(start).collect(), holds))
    }

    /// For parts without a consistent configuration near the start: a choice of rows at a configuration that is consistent with the new
    /// prescribed values, or the error if there is none. Missing convergence is not an error here.
    fn rows_ahead(
        &mut self,
        u: &[f64],
        holds: &[bool],
        prescribed: &[(usize, f64)],
        far: &mut [Option<Result<Arc<RowChoice>, NewtonError>>],
    ) -> Result<(), StepFailure> {
        let mut found = self.consistent(prescribed, LOOK)?;
        let (mut ahead, mut there) = (u.to_vec(), Vec::new());
        prescribed.iter().for_each(|&(j, v)| ahead[j] = v);
        for part in (0..holds.len()).filter(|&part| !holds[part]) {
            match found.errors[part].take() {
                None => {
                    self.parts.list[part].free.iter().for_each(|&j| ahead[j] = found.u[j]);
                    there.push(part);
                }
                Some(NewtonError::NoConvergence { .. }) => (),
                Some(error) => far[part] = Some(Err(error)),
            }
        }
        if !there.is_empty() {
            let choice = self.choice_at(&ahead, prescribed)?;
            there.into_iter().for_each(|part| far[part] = Some(Ok(choice.clone())));
        }
        Ok(())
    }

    /// Evaluates the constraints at u and analyses their rows.
    pub(super) fn choice_at(&mut self, u: &[f64], prescribed: &[(usize, f64)]) -> Result<Arc<RowChoice>, StepFailure> {
        let set = self.constraints.set();
        set.evaluate(u, &mut self.state.evaluation)?;
        let before = self.rows.iter().flatten().flat_map(|rows| rows.list.iter().copied()).collect();
        RowChoice::new((set, &self.parts), &self.state.evaluation, prescribed, (self.options, before))
    }

    /// Finds the nearest configuration that satisfies the constraints.
    pub(super) fn consistent(
        &self,
        prescribed: &[(usize, f64)],
        steps: usize,
    ) -> Result<NearestConsistent, StepFailure> {
        let (tolerance, analysis) = (self.options.roundings, self.options.analysis.clone());
        let options = NewtonOptions { tolerance, steps, analysis };
        let found = solve_each(self.constraints.set(), &self.at.u, prescribed, &options);
        let PartwiseSolution { u, parts: of_equations, failures } = found.map_err(StepFailure::Constraints)?;
        let mut first = vec![usize::MAX; of_equations.count];
        failures.iter().enumerate().rev().for_each(|(k, (part, _))| first[*part] = k);
        let error = |rows: &Vec<usize>| {
            let first = rows.iter().map(|&r| first[of_equations.of_row(r)]).min()?;
            failures.get(first).map(|(_, error)| error.clone())
        };
        Ok(NearestConsistent { u, errors: self.parts.list.iter().map(|part| error(&part.rows)).collect() })
    }
}
