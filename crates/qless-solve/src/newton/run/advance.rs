//! One step of all parts, each by its own length.

use qless::ArgumentError;

use super::super::NewtonError;
use super::super::linearisation::Linearisation;
use super::super::place::Place;
use super::super::singular::ways_out;
use super::super::step::{Line, Way};
use super::{FALLS, Run, kept, shorten_all};

/// Where to.
struct Target {
    u: Vec<f64>,
    /// Of each part, 0 where it stays.
    lengths: Vec<f64>,
}

impl Run<'_> {
    /// Goes with each part as far along its step as that is good for it; one that has no way to go says so, and stays.
    pub fn advance(&mut self, found: &Linearisation, step: usize) -> Result<(), NewtonError> {
        let analysis = &found.analysis;
        let (du, conflicts) = self.directions(found, step)?;
        let target = self.search(du, &kept(analysis)).map_err(|source| NewtonError::Argument { step, source })?;
        for part in 0..self.parts.count() {
            let stuck = self.states[part].way != Way::Done && target.lengths[part] == 0.0;
            if conflicts[part] {
                self.fail(part, self.conflict(part, analysis));
            } else if stuck && (self.states[part].settled || self.states[part].way == Way::Out) {
                self.fail(part, self.no_convergence(step, part));
            }
        }
        self.go(target, step)
    }

    /// du, by what each part has to do, and which parts have proof that there is none.
    fn directions(&mut self, found: &Linearisation, step: usize) -> Result<(Vec<f64>, Vec<bool>), NewtonError> {
        let down = self.downhill(found, step)?;
        let (out, exists) = if self.contradicted.is_empty() {
            (vec![0.0; self.set.dofs()], vec![true; self.parts.count()])
        } else {
            ways_out(self, &found.analysis, step)?
        };
        let choose = |j: usize| match self.parts.of_dof(j).map_or(Way::Done, |part| self.states[part].way) {
            Way::Done => 0.0,
            Way::Downhill => down[j],
            Way::Out => out[j],
        };
        let conflicts = self.states.iter().zip(exists).map(|(state, exists)| state.way == Way::Out && !exists);
        Ok(((0..self.set.dofs()).map(choose).collect(), conflicts.collect()))
    }

    /// A step of the parts that want one; that of others means nothing.
    fn downhill(&self, found: &Linearisation, step: usize) -> Result<Vec<f64>, NewtonError> {
        if !self.states.iter().any(|state| state.way == Way::Downhill) {
            return Ok(vec![0.0; self.set.dofs()]);
        }
        if found.current { found.step(step) } else { self.linearised(&self.place.quantities, step)?.step(step) }
    }

    fn search(&mut self, du: Vec<f64>, kept: &[bool]) -> Result<Target, ArgumentError> {
        let line = Line::new((self.set, &self.parts), &self.place, du);
        let ways: Vec<Way> = self.states.iter().map(|state| state.way).collect();
        let lengths = line.lengths(&ways, (kept, self.options.tolerance), &mut self.room)?;
        Ok(Target { u: line.at(|part| lengths[part]), lengths })
    }

    /// Parts that stay although they are not done come to rest where they are.
    fn go(&mut self, Target { mut u, lengths }: Target, step: usize) -> Result<(), NewtonError> {
        let moves = |part: usize| lengths[part] > 0.0;
        let moved = |vector: &&[usize; 3]| self.parts.of_dof(vector[0]).is_some_and(moves);
        shorten_all(self.rotations.iter().filter(moved), &mut u);
        let place = Place::new(self.set, u, &self.parts).map_err(|source| NewtonError::Argument { step, source })?;
        let before = std::mem::replace(&mut self.place, place);
        for (part, state) in self.states.iter_mut().enumerate().filter(|(_, state)| state.way != Way::Done) {
            state.settled = !moves(part) || self.place.residuals[part] > FALLS * before.residuals[part];
            state.length = if moves(part) { lengths[part] } else { state.length };
        }
        self.measure();
        Ok(())
    }
}
