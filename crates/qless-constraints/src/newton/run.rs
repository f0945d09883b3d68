//! The state between two steps: all parts go in lock step, each by its own length, and those that are done stay where they are.

use qless::{Analysis, ArgumentError, Kind, SystemBuilder};

use super::linearisation::Linearisation;
use super::parts::Parts;
use super::place::Place;
use super::residual::in_roundings;
use super::scaling::at_rest;
use super::singular::ways_out;
use super::step::{Line, Way};
use super::{Iterate, NewtonError, NewtonOptions, Solution, dependent};
use crate::set::rotations::shorten;
use crate::{ConstraintSet, Quantities};

/// A residual above this part of the one before no longer falls.
const FALLS: f64 = 0.5;

pub struct Run<'a> {
    pub set: &'a ConstraintSet,
    pub options: &'a NewtonOptions,
    pub prescribed: &'a [(usize, f64)],
    pub parts: Parts,
    /// Rotation vectors, none of them prescribed: kept below half a turn, so that none comes to a whole one, where it is singular.
    rotations: Vec<[usize; 3]>,
    pub place: Place,
    /// For trial points.
    room: Quantities,
    /// `|c_r|` in roundings of its own terms; as [`at_rest`] once its part has settled.
    residuals: Vec<f64>,
    states: Vec<State>,
    /// Equations that are left out and do not hold, of parts where all that is kept does.
    pub contradicted: Vec<usize>,
    iterates: Vec<Iterate>,
}

/// Of a part.
#[derive(Clone)]
struct State {
    way: Way,
    /// Whether c no longer falls.
    settled: bool,
    /// The part of the last step that was gone.
    length: f64,
}

/// Where to.
struct Target {
    u: Vec<f64>,
    /// Of each part, 0 where it stays.
    lengths: Vec<f64>,
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
        // Also those that no equation looks at.
        if let Some(place) = u.iter().position(|u| !u.is_finite()) {
            let source = ArgumentError::NotFinite { what: "u", place, value: u[place] };
            return Err(NewtonError::Argument { step: 0, source });
        }
        let mut rotations = set.rotation_vectors();
        rotations.retain(|vector| prescribed.iter().all(|(dof, _)| !vector.contains(dof)));
        shorten_all(rotations.iter(), &mut u);
        let room = set.allocate();
        let parts = Parts::new(room.g(), prescribed, &rotations);
        let place = Place::new(set, u, &parts).map_err(|source| NewtonError::Argument { step: 0, source })?;
        let residuals = in_roundings(place.quantities.c(), place.rounding.c());
        let states = vec![State { way: Way::Downhill, settled: false, length: 1.0 }; parts.count()];
        let (contradicted, iterates) = (Vec::new(), Vec::new());
        Ok(Self { set, options, prescribed, parts, rotations, place, room, residuals, states, contradicted, iterates })
    }

    pub fn linearised(&self, quantities: &Quantities, step: usize) -> Result<Linearisation, NewtonError> {
        Linearisation::new(self.set, quantities, (self.prescribed, &self.parts.columns), (step, self.options))
    }

    /// Linearises and analyses at the present u; where all equations are linear, what was found before still holds.
    pub fn look(&mut self, step: usize, before: Option<Linearisation>) -> Result<Linearisation, NewtonError> {
        let constant = self.set.linear_rows().len() == self.set.equations();
        let found = match before.filter(|_| constant) {
            Some(known) => known.outdated(),
            None => self.linearised(&self.place.quantities, step)?,
        };
        let on_the_way = self.states.iter().filter(|state| state.way != Way::Done);
        self.iterates.push(Iterate {
            residual: self.place.residual(),
            rank: found.analysis.rank(),
            left_out: dependent(&found.analysis),
            length: on_the_way.map(|state| state.length).fold(1.0, f64::min),
        });
        Ok(found)
    }

    /// Finds out what each part has to do next.
    ///
    /// A part is done where its kept equations hold to the tolerance, and all others to what that makes of them.
    pub fn decide(&mut self, analysis: &Analysis) -> Result<(), ArgumentError> {
        let (kept, tolerance) = (kept(analysis), self.options.tolerance);
        let off = self.parts.fold(false, |off, r| *off |= kept[r] && self.residuals[r] > tolerance);
        self.contradicted.clear();
        for row in dependent(analysis) {
            let part = self.parts.of_row(row);
            let asked = self.states[part].way != Way::Done && !off[part];
            if asked && self.contradicts(analysis, row)? {
                self.contradicted.push(row);
            }
        }
        let way = |(state, off): (&mut State, bool)| {
            if state.way != Way::Done {
                state.way = if off { Way::Downhill } else { Way::Done };
            }
        };
        self.states.iter_mut().zip(off).for_each(way);
        self.contradicted.iter().for_each(|&row| self.states[self.parts.of_row(row)].way = Way::Out);
        Ok(())
    }

    /// The first part that is not done.
    pub fn unfinished(&self) -> Option<usize> {
        self.states.iter().position(|state| state.way != Way::Done)
    }

    /// Whether an equation that is left out does not hold: `c_k` is that of its certificate, and so is its rounding.
    fn contradicts(&self, analysis: &Analysis, row: usize) -> Result<bool, ArgumentError> {
        if self.residuals[row] <= self.options.tolerance {
            return Ok(false);
        }
        let rounding = self.place.rounding.c();
        let terms = analysis.because(row)?.into_iter().map(|b| b.coefficient.abs() * rounding[b.row]);
        let allowed = self.options.tolerance * terms.fold(rounding[row], |sum, term| sum + term);
        Ok(!(self.place.quantities.c()[row].abs() <= allowed && allowed.is_finite()))
    }

    /// Goes with each part as far along its step as that is good for it.
    ///
    /// As an error what the first part that has no way to go says.
    pub fn advance(&mut self, found: &Linearisation, step: usize) -> Result<(), NewtonError> {
        let analysis = &found.analysis;
        let (du, conflicts) = self.directions(found, step)?;
        let target = self.search(du, &kept(analysis)).map_err(|source| NewtonError::Argument { step, source })?;
        for part in 0..self.parts.count() {
            let stuck = self.states[part].way != Way::Done && target.lengths[part] == 0.0;
            if conflicts[part] {
                return Err(self.conflict(part, analysis));
            } else if stuck && (self.states[part].settled || self.states[part].way == Way::Out) {
                return Err(self.no_convergence(step, part));
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

    /// Where no step makes c smaller, what is left may be the rounding of other rows of the part.
    fn measure(&mut self) {
        let place = &self.place;
        self.residuals = in_roundings(place.quantities.c(), place.rounding.c());
        if !self.states.iter().any(|state| state.settled) {
            return;
        }
        let extents = self.set.extents(&place.u);
        let at_rest = at_rest(&place.weights, &place.quantities, (&place.rounding, &extents), &self.parts);
        let settled = (0..at_rest.len()).filter(|&r| self.states[self.parts.of_row(r)].settled);
        settled.for_each(|r| self.residuals[r] = at_rest[r]);
    }

    fn conflict(&self, part: usize, analysis: &Analysis) -> NewtonError {
        let rows: Vec<usize> =
            self.contradicted.iter().copied().filter(|&row| self.parts.of_row(row) == part).collect();
        let named = |rows: &[usize]| rows.iter().filter_map(|&row| self.set.label(row).ok()).collect();
        let mut others: Vec<usize> =
            rows.iter().flat_map(|&row| analysis.because(row).unwrap_or_default()).map(|b| b.row).collect();
        others.sort_unstable();
        others.dedup();
        let amount = rows.iter().map(|&row| self.place.quantities.c()[row].abs()).fold(0.0, f64::max);
        NewtonError::Conflict { labels: named(&rows), others: named(&others), rows, amount }
    }

    pub fn no_convergence(&self, steps: usize, part: usize) -> NewtonError {
        let weighted = |&r: &usize| self.place.weights[r] * self.place.quantities.c()[r].abs();
        let rows = (0..self.residuals.len()).filter(|&r| self.parts.of_row(r) == part);
        let worst = rows.max_by(|a, b| weighted(a).total_cmp(&weighted(b)));
        let label = worst.and_then(|row| self.set.label(row).ok()).unwrap_or_default();
        NewtonError::NoConvergence { steps, residual: self.place.residuals[part], label }
    }

    pub fn into_solution(self, redundant: Vec<usize>) -> Solution {
        Solution { u: self.place.u, iterates: self.iterates, redundant }
    }
}

fn kept(analysis: &Analysis) -> Vec<bool> {
    analysis.kinds().iter().map(|&kind| kind == Kind::Independent).collect()
}

/// Rotation vectors of at most half a turn, where u has all of their DOFs.
fn shorten_all<'a>(rotations: impl Iterator<Item = &'a [usize; 3]>, u: &mut [f64]) {
    let count = u.len();
    let there = rotations.filter(|vector| vector.iter().all(|&dof| dof < count));
    there.for_each(|&vector| _ = shorten(u, vector));
}
