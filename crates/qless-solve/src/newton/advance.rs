//! One step of all parts: decide what each part needs, compute its direction, and move it by a length of its own.

use qless::{Analysis, ArgumentError};

use super::configuration::Configuration;
use super::error::NewtonError;
use super::linearisation::{Linearisation, dependent};
use super::singular::second_order_directions;
use super::state::{FALLS, NewtonState, PartStatus, kept, shorten_all};
use super::step::{StepGoal, StepLine};

/// End points of a step.
struct StepEnd {
    u: Vec<f64>,
    /// Step length of each part; 0 if it does not move.
    lengths: Vec<f64>,
}

impl NewtonState<'_> {
    /// Steps until no part is left to move, or `may_go_on` rejects the failures; returns the equations that are redundant at the end.
    pub fn follow(&mut self, may_go_on: impl Fn(&[(usize, NewtonError)]) -> bool) -> Result<Vec<usize>, NewtonError> {
        let (mut before, mut step) = (None, 0);
        loop {
            let found = self.linearise_here(step, before)?;
            self.decide(&found.analysis).map_err(|source| NewtonError::Argument { step, source })?;
            if !self.goes_on(step) || !may_go_on(&self.failures) {
                return Ok(dependent(&found.analysis));
            }
            self.advance(&found, step)?;
            if !may_go_on(&self.failures) {
                return Ok(Vec::new());
            }
            (before, step) = (Some(found), step + 1);
        }
    }

    /// Moves each part by its step length. A part fails and stays if its equations conflict. It also fails if no length is found while it
    /// is settled or in a singular configuration.
    pub fn advance(&mut self, found: &Linearisation, step: usize) -> Result<(), NewtonError> {
        let analysis = &found.analysis;
        let (du, conflicts) = self.directions(found, step)?;
        let target = self.search(du, &kept(analysis)).map_err(|source| NewtonError::Argument { step, source })?;
        for part in 0..self.parts.count {
            let stuck = self.states[part].goal != StepGoal::Done && target.lengths[part] == 0.0;
            if conflicts[part] {
                self.fail(part, self.conflict(part, analysis));
            } else if stuck && (self.states[part].settled || self.states[part].goal == StepGoal::Out) {
                self.fail(part, self.no_convergence(step, part));
            }
        }
        self.move_to(target, step)
    }

    /// The direction du of each part, and whether a conflict is proven in it.
    fn directions(&mut self, found: &Linearisation, step: usize) -> Result<(Vec<f64>, Vec<bool>), NewtonError> {
        let down = self.downhill(found, step)?;
        let (out, exists) = if self.contradicted.is_empty() {
            (vec![0.0; self.set.dofs()], vec![true; self.parts.count])
        } else {
            second_order_directions(self, &found.analysis, step)?
        };
        let choose = |j: usize| match self.parts.of_dof(j).map_or(StepGoal::Done, |part| self.states[part].goal) {
            StepGoal::Done => 0.0,
            StepGoal::Downhill => down[j],
            StepGoal::Out => out[j],
        };
        let conflicts = self.states.iter().zip(exists).map(|(state, exists)| state.goal == StepGoal::Out && !exists);
        Ok(((0..self.set.dofs()).map(choose).collect(), conflicts.collect()))
    }

    /// The Newton step of all parts; zero if no part has the goal [`StepGoal::Downhill`]. The caller uses only the entries of parts with
    /// this goal.
    fn downhill(&self, found: &Linearisation, step: usize) -> Result<Vec<f64>, NewtonError> {
        if !self.states.iter().any(|state| state.goal == StepGoal::Downhill) {
            return Ok(vec![0.0; self.set.dofs()]);
        }
        if found.current { found.step(step) } else { self.linearised(&self.configuration.evaluation, step)?.step(step) }
    }

    fn search(&mut self, du: Vec<f64>, kept: &[bool]) -> Result<StepEnd, ArgumentError> {
        let line = StepLine::new((self.set, &self.parts), &self.configuration, du);
        let goals: Vec<StepGoal> = self.states.iter().map(|state| state.goal).collect();
        let lengths = line.lengths(&goals, (kept, self.options.tolerance), &mut self.buffer)?;
        Ok(StepEnd { u: line.at(|part| lengths[part]), lengths })
    }

    /// Parts that do not move although they are not done count as settled.
    fn move_to(&mut self, StepEnd { mut u, lengths }: StepEnd, step: usize) -> Result<(), NewtonError> {
        let moves = |part: usize| lengths[part] > 0.0;
        let moved = |vector: &&[usize; 3]| self.parts.of_dof(vector[0]).is_some_and(moves);
        shorten_all(self.rotations.iter().filter(moved), &mut u);
        let configuration =
            Configuration::new(self.set, u, &self.parts).map_err(|source| NewtonError::Argument { step, source })?;
        let before = std::mem::replace(&mut self.configuration, configuration);
        for (part, state) in self.states.iter_mut().enumerate().filter(|(_, state)| state.goal != StepGoal::Done) {
            state.settled = !moves(part) || self.configuration.residuals[part] > FALLS * before.residuals[part];
            state.length = if moves(part) { lengths[part] } else { state.length };
        }
        self.measure();
        Ok(())
    }

    /// Decides what each part needs next.
    ///
    /// A part is done if its kept equations hold to the tolerance, and its redundant ones to the tolerance that follows from these.
    pub fn decide(&mut self, analysis: &Analysis) -> Result<(), ArgumentError> {
        let (kept, tolerance) = (kept(analysis), self.options.tolerance);
        let off = self.parts.fold(false, |off, r| *off |= kept[r] && self.residuals[r] > tolerance);
        self.contradicted.clear();
        for row in dependent(analysis) {
            let part = self.parts.of_row(row);
            let asked = self.states[part].goal != StepGoal::Done && !off[part];
            if asked && self.contradicts(analysis, row)? {
                self.contradicted.push(row);
            }
        }
        let goal = |(state, off): (&mut PartStatus, bool)| {
            if state.goal != StepGoal::Done {
                state.goal = if off { StepGoal::Downhill } else { StepGoal::Done };
            }
        };
        self.states.iter_mut().zip(off).for_each(goal);
        self.contradicted.iter().for_each(|&row| self.states[self.parts.of_row(row)].goal = StepGoal::Out);
        Ok(())
    }

    /// Whether some part is neither done nor failed. After the last allowed step, unfinished parts fail.
    pub fn goes_on(&mut self, step: usize) -> bool {
        if step == self.options.steps {
            let unfinished = |part: &usize| self.states[*part].goal != StepGoal::Done;
            let late: Vec<usize> = (0..self.parts.count).filter(unfinished).collect();
            late.into_iter().for_each(|part| self.fail(part, self.no_convergence(step, part)));
        }
        self.states.iter().any(|state| state.goal != StepGoal::Done)
    }

    /// Whether a redundant equation does not hold. Its tolerance includes the rounding of the equations in its certificate.
    fn contradicts(&self, analysis: &Analysis, row: usize) -> Result<bool, ArgumentError> {
        if self.residuals[row] <= self.options.tolerance {
            return Ok(false);
        }
        let rounding = self.configuration.rounding.c();
        let terms = analysis.because(row)?.into_iter().map(|b| b.coefficient.abs() * rounding[b.row]);
        let allowed = self.options.tolerance * terms.fold(rounding[row], |sum, term| sum + term);
        Ok(!(self.configuration.evaluation.c()[row].abs() <= allowed && allowed.is_finite()))
    }
}
