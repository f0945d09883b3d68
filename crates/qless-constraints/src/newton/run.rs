//! The state between two steps.

use qless::{Analysis, ArgumentError, Kind, SystemBuilder};

use super::linearisation::Linearisation;
use super::residual::in_roundings;
use super::scaling::at_rest;
use super::singular::way_out;
use super::step::{Line, Place};
use super::{Iterate, NewtonError, NewtonOptions, Solution, dependent};
use crate::set::rotations::shorten;
use crate::{ConstraintSet, Quantities};

/// A residual above this part of the one before no longer falls.
const FALLS: f64 = 0.5;

pub struct Run<'a> {
    pub set: &'a ConstraintSet,
    pub options: &'a NewtonOptions,
    pub prescribed: &'a [(usize, f64)],
    /// Rotation vectors, none of them prescribed: kept below half a turn, so that none comes to a whole one, where it is singular.
    rotations: Vec<[usize; 3]>,
    pub place: Place,
    /// For trial points.
    room: Quantities,
    /// `|c_r|` in roundings of its own terms; as [`at_rest`] once the iteration has settled.
    residuals: Vec<f64>,
    /// Whether c no longer falls.
    settled: bool,
    iterates: Vec<Iterate>,
    /// The part of the last step that was gone.
    length: f64,
}

impl<'a> Run<'a> {
    pub fn new(
        set: &'a ConstraintSet,
        u: &[f64],
        prescribed: &'a [(usize, f64)],
        options: &'a NewtonOptions,
    ) -> Result<Self, NewtonError> {
        if !prescribed.is_empty() {
            let mut builder = SystemBuilder::new(set.dofs());
            prescribed.iter().for_each(|&(dof, value)| builder.prescribe(dof, value));
            builder.build().map_err(|source| NewtonError::System { step: 0, source: source.into() })?;
        }
        let mut u = u.to_vec();
        prescribed.iter().for_each(|&(j, v)| u.iter_mut().skip(j).take(1).for_each(|u| *u = v));
        let mut rotations = set.rotation_vectors();
        rotations.retain(|vector| prescribed.iter().all(|(dof, _)| !vector.contains(dof)));
        shorten_all(&rotations, &mut u);
        let place = Place::new(set, u).map_err(|source| NewtonError::Argument { step: 0, source })?;
        let residuals = in_roundings(place.quantities.c(), place.rounding.c());
        let (room, iterates) = (set.allocate(), Vec::new());
        Ok(Self { set, options, prescribed, rotations, place, room, residuals, settled: false, iterates, length: 1.0 })
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
            residual: self.place.residual(),
            rank: found.analysis.rank(),
            left_out: dependent(&found.analysis),
            length: self.length,
        });
        Ok(found)
    }

    /// Whether the chosen equations hold to the tolerance.
    fn satisfied(&self, chosen: impl Fn(usize) -> bool) -> bool {
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
        let t = line
            .downhill(&kept, self.options.tolerance, &mut self.room)
            .map_err(|source| NewtonError::Argument { step, source })?;
        if t.is_none() && !self.settled {
            self.settle();
            return Ok(true);
        }
        let target = t.map(|t| (line.at(t), t));
        self.go(target, step)
    }

    /// All that is kept holds, and something that is left out does not: G has lost rank here.
    fn leave(&mut self, analysis: &Analysis, step: usize) -> Result<bool, NewtonError> {
        let argument = |source| NewtonError::Argument { step, source };
        let rows = self.contradicted(analysis).map_err(argument)?;
        let Some(du) = way_out(self, analysis, &rows, step)? else { return Err(self.conflict(rows, analysis)) };
        let line = Line::new(self.set, &self.place, du);
        let t = line.trusted(&mut self.room).map_err(argument)?;
        let target = t.map(|t| (line.at(t), t));
        self.go(target, step)
    }

    /// Whether all kept equations hold to the tolerance, and all others to what that makes of them.
    pub fn done(&self, analysis: &Analysis) -> Result<bool, ArgumentError> {
        let kept = |row: usize| analysis.kinds()[row] == Kind::Independent;
        Ok(self.satisfied(kept) && self.contradicted(analysis)?.is_empty())
    }

    /// Equations that are left out and do not hold: `c_k` is that of its certificate, and so is its rounding.
    fn contradicted(&self, analysis: &Analysis) -> Result<Vec<usize>, ArgumentError> {
        let mut rows = Vec::new();
        for row in dependent(analysis) {
            if self.residuals[row] <= self.options.tolerance {
                continue;
            }
            let rounding = self.place.rounding.c();
            let parts = analysis.because(row)?.into_iter().map(|b| b.coefficient.abs() * rounding[b.row]);
            let allowed = self.options.tolerance * parts.fold(rounding[row], |sum, part| sum + part);
            if !(self.place.quantities.c()[row].abs() <= allowed && allowed.is_finite()) {
                rows.push(row);
            }
        }
        Ok(rows)
    }

    /// Goes to u, or nowhere.
    fn go(&mut self, target: Option<(Vec<f64>, f64)>, step: usize) -> Result<bool, NewtonError> {
        let Some((mut u, t)) = target else { return Ok(false) };
        shorten_all(&self.rotations, &mut u);
        let before = self.place.residual();
        self.place = Place::new(self.set, u).map_err(|source| NewtonError::Argument { step, source })?;
        self.residuals = in_roundings(self.place.quantities.c(), self.place.rounding.c());
        self.length = t;
        self.settled = false;
        if self.place.residual() > FALLS * before {
            self.settle();
        }
        Ok(true)
    }

    /// No step makes c smaller: what is left may be the rounding of other rows.
    fn settle(&mut self) {
        let place = &self.place;
        let extents = self.set.extents(&place.u);
        self.residuals = at_rest(&place.weights, &place.quantities, &place.rounding, &extents);
        self.settled = true;
    }

    fn conflict(&self, rows: Vec<usize>, analysis: &Analysis) -> NewtonError {
        let named = |rows: &[usize]| rows.iter().filter_map(|&row| self.set.label(row).ok()).collect();
        let mut others: Vec<usize> =
            rows.iter().flat_map(|&row| analysis.because(row).unwrap_or_default()).map(|b| b.row).collect();
        others.sort_unstable();
        others.dedup();
        let amount = rows.iter().map(|&row| self.place.quantities.c()[row].abs()).fold(0.0, f64::max);
        NewtonError::Conflict { labels: named(&rows), others: named(&others), rows, amount }
    }

    pub fn no_convergence(&self, steps: usize) -> NewtonError {
        let weighted = |&r: &usize| self.place.weights[r] * self.place.quantities.c()[r].abs();
        let worst = (0..self.residuals.len()).max_by(|a, b| weighted(a).total_cmp(&weighted(b)));
        let label = worst.and_then(|row| self.set.label(row).ok()).unwrap_or_default();
        NewtonError::NoConvergence { steps, residual: self.place.residual(), label }
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
