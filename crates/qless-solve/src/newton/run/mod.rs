//! The state between two steps: all parts go in lock step, each by its own length, and those that are done stay where they are.

mod advance;
mod decide;
mod refusal;

use qless::{Analysis, ArgumentError, Kind, SystemBuilder};

use super::linearisation::Linearisation;
use super::parts::Parts;
use super::place::Place;
use super::residual::in_roundings;
use super::scaling::at_rest;
use super::step::Way;
use super::{Iterate, NewtonError, NewtonOptions, Solution, dependent};
use qless_constraints::shorten_rotation;
use qless_constraints::{ConstraintSet, Quantities};

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
    /// Parts that have no way to go, by their steps and then by their first rows.
    pub failures: Vec<(usize, NewtonError)>,
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
        let (contradicted, iterates, failures) = (Vec::new(), Vec::new(), Vec::new());
        Ok(Self {
            set,
            options,
            prescribed,
            parts,
            rotations,
            place,
            room,
            residuals,
            states,
            contradicted,
            iterates,
            failures,
        })
    }

    /// Goes step by step until no part goes on, or `may_go_on` says that the failures are enough; equations that are redundant there.
    pub fn follow(&mut self, may_go_on: impl Fn(&[(usize, NewtonError)]) -> bool) -> Result<Vec<usize>, NewtonError> {
        let (mut before, mut step) = (None, 0);
        loop {
            let found = self.look(step, before)?;
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
    there.for_each(|&vector| _ = shorten_rotation(u, vector));
}
