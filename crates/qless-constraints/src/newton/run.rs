//! The state between two steps.

use qless::{Analysis, Kind};

use super::linearisation::Linearisation;
use super::residual::in_roundings;
use super::singular::way_out;
use super::step::{Line, Place};
use super::{Iterate, NewtonError, NewtonOptions, Solution, dependent};
use crate::set::rotations::shorten;
use crate::{ConstraintSet, Quantities};

pub struct Run<'a> {
    pub set: &'a ConstraintSet,
    pub options: &'a NewtonOptions,
    pub prescribed: &'a [(usize, f64)],
    /// Rotation vectors, none of them prescribed: kept below half a turn, so that none comes to a whole one, where it is singular.
    rotations: Vec<[usize; 3]>,
    pub place: Place,
    /// For trial points.
    room: Quantities,
    /// `|c_r|` in roundings.
    residuals: Vec<f64>,
    iterates: Vec<Iterate>,
    /// Of the last step.
    length: f64,
}

impl<'a> Run<'a> {
    pub fn new(
        set: &'a ConstraintSet,
        u: &[f64],
        prescribed: &'a [(usize, f64)],
        options: &'a NewtonOptions,
    ) -> Result<Self, NewtonError> {
        let mut u = u.to_vec();
        // DOFs that are not there are named when the equations are linearised.
        prescribed.iter().for_each(|&(j, v)| u.iter_mut().skip(j).take(1).for_each(|u| *u = v));
        let mut rotations = set.rotation_vectors();
        rotations.retain(|vector| prescribed.iter().all(|(dof, _)| !vector.contains(dof)));
        shorten_all(&rotations, &mut u);
        let place = Place::new(set, u).map_err(|source| NewtonError::Argument { step: 0, source })?;
        let residuals = in_roundings(place.quantities.c(), &place.rounding);
        let (room, iterates) = (set.allocate(), Vec::new());
        Ok(Self { set, options, prescribed, rotations, place, room, residuals, iterates, length: 1.0 })
    }

    /// Linearises and analyses at the present u; where all equations are linear, what was found before still holds.
    pub fn look(&mut self, step: usize, before: Option<Linearisation>) -> Result<Linearisation, NewtonError> {
        let constant = self.set.linear_rows().len() == self.set.equations();
        let known = before.filter(|_| constant).and_then(|before| before.refreshed(&self.place.quantities));
        let found = match known {
            Some(known) => known,
            None => Linearisation::new(self.set, &self.place.quantities, self.prescribed, (step, self.options))?,
        };
        self.iterates.push(Iterate {
            residual: f64::EPSILON * self.worst().1,
            rank: found.analysis.rank(),
            left_out: dependent(&found.analysis),
            length: self.length,
        });
        Ok(found)
    }

    /// The equation that is farthest from zero, and by how many roundings.
    fn worst(&self) -> (usize, f64) {
        let all = self.residuals.iter().copied().enumerate();
        all.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0, 0.0))
    }

    /// Whether the chosen equations hold to the tolerance.
    pub fn satisfied(&self, chosen: impl Fn(usize) -> bool) -> bool {
        self.residuals.iter().enumerate().all(|(row, &r)| r <= self.options.tolerance || !chosen(row))
    }

    /// Goes as far along the step as it is good for; false if there is no way to go.
    pub fn advance(&mut self, found: &mut Linearisation, step: usize) -> Result<bool, NewtonError> {
        let analysis = std::sync::Arc::clone(&found.analysis);
        let kept: Vec<bool> = analysis.kinds().iter().map(|&kind| kind == Kind::Independent).collect();
        if self.satisfied(|row| kept[row]) {
            return self.leave(&analysis, step);
        }
        let line = Line::new(self.set, &self.place, found.step(step)?);
        let t = line.downhill(&kept, &mut self.room).map_err(|source| NewtonError::Argument { step, source })?;
        let target = t.map(|t| (line.at(t), t));
        self.go(target, step)
    }

    /// All that is kept holds, and something that is left out does not: G has lost rank here.
    fn leave(&mut self, analysis: &Analysis, step: usize) -> Result<bool, NewtonError> {
        let rows: Vec<usize> = dependent(analysis).into_iter().filter(|&row| !self.satisfied(|r| r != row)).collect();
        let rows: Vec<usize> = if rows.is_empty() { self.unsatisfied() } else { rows };
        let Some(du) = way_out(self, analysis, &rows, step)? else { return Err(self.conflict(rows)) };
        let line = Line::new(self.set, &self.place, du);
        let t = line.trusted(&mut self.room).map_err(|source| NewtonError::Argument { step, source })?;
        let target = t.map(|t| (line.at(t), t));
        self.go(target, step)
    }

    fn unsatisfied(&self) -> Vec<usize> {
        (0..self.residuals.len()).filter(|&r| self.residuals[r] > self.options.tolerance).collect()
    }

    fn go(&mut self, target: Option<(Vec<f64>, f64)>, step: usize) -> Result<bool, NewtonError> {
        let Some((mut u, t)) = target else { return Ok(false) };
        shorten_all(&self.rotations, &mut u);
        self.place.move_to(self.set, u).map_err(|source| NewtonError::Argument { step, source })?;
        self.residuals = in_roundings(self.place.quantities.c(), &self.place.rounding);
        self.length = t;
        Ok(true)
    }

    fn conflict(&self, rows: Vec<usize>) -> NewtonError {
        let labels = rows.iter().filter_map(|&row| self.set.label(row).ok()).collect();
        let amount = rows.iter().map(|&row| self.place.quantities.c()[row].abs()).fold(0.0, f64::max);
        NewtonError::Conflict { rows, labels, amount }
    }

    pub fn no_convergence(&self, steps: usize) -> NewtonError {
        let (row, residual) = self.worst();
        let label = self.set.label(row).unwrap_or_default();
        NewtonError::NoConvergence { steps, residual: f64::EPSILON * residual, label }
    }

    pub fn into_solution(self, redundant: Vec<usize>) -> Solution {
        Solution { u: self.place.u, iterates: self.iterates, redundant }
    }
}

/// Rotation vectors of at most half a turn, where u has all of their DOFs.
fn shorten_all(rotations: &[[usize; 3]], u: &mut [f64]) {
    let count = u.len();
    let there = rotations.iter().filter(|vector| vector.iter().all(|&dof| dof < count));
    there.for_each(|&vector| _ = shorten(u, vector));
}
