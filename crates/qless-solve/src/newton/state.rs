//! The state between two steps of all parts, and the errors of parts that fail.

use qless::{Analysis, ArgumentError, Kind, SystemBuilder};
use qless_constraints::{ConstraintSet, Evaluation, shorten_rotation};

use super::configuration::{Configuration, at_rest, in_roundings};
use super::error::NewtonError;
use super::linearisation::{Linearisation, dependent};
use super::parts::EquationParts;
use super::solution::{NewtonIterate, NewtonOptions, NewtonSolution};
use super::step::StepGoal;

/// c falls if its residual is at most this fraction of the one before.
pub const FALLS: f64 = 0.5;

pub struct NewtonState<'a> {
    pub set: &'a ConstraintSet,
    pub options: &'a NewtonOptions,
    pub prescribed: &'a [(usize, f64)],
    pub parts: EquationParts,
    /// Rotation vectors without prescribed DOFs. They are kept below half a turn, since a whole turn is singular.
    pub rotations: Vec<[usize; 3]>,
    pub configuration: Configuration,
    /// Buffers for trial points.
    pub buffer: Evaluation,
    /// `|c_r|` in roundings of its own terms, or as [`at_rest`] computes it if the part has settled.
    pub residuals: Vec<f64>,
    pub states: Vec<PartStatus>,
    /// Redundant equations that do not hold, in parts whose kept equations do.
    pub contradicted: Vec<usize>,
    pub iterates: Vec<NewtonIterate>,
    /// Parts that failed, ordered by their steps and then by their first rows.
    pub failures: Vec<(usize, NewtonError)>,
}

/// Status of one part.
#[derive(Clone)]
pub struct PartStatus {
    pub goal: StepGoal,
    /// Whether c no longer falls.
    pub settled: bool,
    /// Length of the last step, relative to du.
    pub length: f64,
}

impl<'a> NewtonState<'a> {
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
        // This check includes DOFs that no equation uses.
        if let Some(place) = u.iter().position(|u| !u.is_finite()) {
            let source = ArgumentError::NotFinite { what: "u", place, value: u[place] };
            return Err(NewtonError::Argument { step: 0, source });
        }
        let mut rotations = set.rotation_vectors();
        rotations.retain(|vector| prescribed.iter().all(|(dof, _)| !vector.contains(dof)));
        shorten_all(rotations.iter(), &mut u);
        let buffer = set.allocate();
        let parts = EquationParts::new(buffer.g(), prescribed, &rotations);
        let configuration =
            Configuration::new(set, u, &parts).map_err(|source| NewtonError::Argument { step: 0, source })?;
        let residuals = in_roundings(configuration.evaluation.c(), configuration.rounding.c());
        let states = vec![PartStatus { goal: StepGoal::Downhill, settled: false, length: 1.0 }; parts.count];
        let (contradicted, iterates, failures) = (Vec::new(), Vec::new(), Vec::new());
        Ok(Self {
            set,
            options,
            prescribed,
            parts,
            rotations,
            configuration,
            buffer,
            residuals,
            states,
            contradicted,
            iterates,
            failures,
        })
    }

    pub fn linearised(&self, evaluation: &Evaluation, step: usize) -> Result<Linearisation, NewtonError> {
        Linearisation::new(self.set, evaluation, (self.prescribed, &self.parts.columns), (step, self.options))
    }

    /// Linearises and analyses at u; the last analysis is kept if all equations are linear.
    pub fn linearise_here(&mut self, step: usize, before: Option<Linearisation>) -> Result<Linearisation, NewtonError> {
        let constant = self.set.linear_rows().len() == self.set.equations();
        let found = match before.filter(|_| constant) {
            Some(known) => known.outdated(),
            None => self.linearised(&self.configuration.evaluation, step)?,
        };
        let on_the_way = self.states.iter().filter(|state| state.goal != StepGoal::Done);
        self.iterates.push(NewtonIterate {
            residual: self.configuration.residual(),
            rank: found.analysis.rank(),
            ignored: dependent(&found.analysis),
            length: on_the_way.map(|state| state.length).fold(1.0, f64::min),
        });
        Ok(found)
    }

    /// Updates the residuals. In settled parts, a residual may be the rounding of other rows.
    pub fn measure(&mut self) {
        let configuration = &self.configuration;
        self.residuals = in_roundings(configuration.evaluation.c(), configuration.rounding.c());
        if !self.states.iter().any(|state| state.settled) {
            return;
        }
        let extents = self.set.extents(&configuration.u).expect("u has a number for each DOF");
        let at_rest = at_rest(
            &configuration.weights,
            &configuration.evaluation,
            (&configuration.rounding, &extents),
            &self.parts,
        );
        let settled = (0..at_rest.len()).filter(|&r| self.states[self.parts.of_row(r)].settled);
        settled.for_each(|r| self.residuals[r] = at_rest[r]);
    }

    pub fn into_solution(self, redundant: Vec<usize>) -> NewtonSolution {
        NewtonSolution { u: self.configuration.u, iterates: self.iterates, redundant }
    }
}

pub fn kept(analysis: &Analysis) -> Vec<bool> {
    analysis.kinds().iter().map(|&kind| kind == Kind::Independent).collect()
}

/// Shortens rotation vectors to half a turn at most; skips those whose DOFs u does not have.
pub fn shorten_all<'a>(rotations: impl Iterator<Item = &'a [usize; 3]>, u: &mut [f64]) {
    let count = u.len();
    let there = rotations.filter(|vector| vector.iter().all(|&dof| dof < count));
    there.for_each(|&vector| _ = shorten_rotation(u, vector));
}

impl NewtonState<'_> {
    /// Marks a part as failed; it does not move any more.
    pub fn fail(&mut self, part: usize, error: NewtonError) {
        self.states[part].goal = StepGoal::Done;
        self.failures.push((part, error));
    }

    pub fn conflict(&self, part: usize, analysis: &Analysis) -> NewtonError {
        let rows: Vec<usize> =
            self.contradicted.iter().copied().filter(|&row| self.parts.of_row(row) == part).collect();
        let named = |rows: &[usize]| rows.iter().filter_map(|&row| self.set.label(row).ok()).collect();
        let mut others: Vec<usize> =
            rows.iter().flat_map(|&row| analysis.because(row).unwrap_or_default()).map(|b| b.row).collect();
        others.sort_unstable();
        others.dedup();
        let amount = rows.iter().map(|&row| self.configuration.evaluation.c()[row].abs()).fold(0.0, f64::max);
        NewtonError::Conflict { labels: named(&rows), others: named(&others), rows, amount }
    }

    pub fn no_convergence(&self, steps: usize, part: usize) -> NewtonError {
        let weighted = |&r: &usize| self.configuration.weights[r] * self.configuration.evaluation.c()[r].abs();
        let rows = (0..self.residuals.len()).filter(|&r| self.parts.of_row(r) == part);
        let worst = rows.max_by(|a, b| weighted(a).total_cmp(&weighted(b)));
        let label = worst.and_then(|row| self.set.label(row).ok()).unwrap_or_default();
        NewtonError::NoConvergence { steps, residual: self.configuration.residuals[part], label }
    }
}
