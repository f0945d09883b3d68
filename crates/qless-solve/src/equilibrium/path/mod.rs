//! Load steps: `f_ext = f_0 + s (f_1 - f_0)`, `u_p = u_p0 + s (v - u_p0)`, `t = t_0 + s (t_1 - t_0)`, with s from 0 to 1.
//!
//! A step that fails twice is shortened to a quarter; after an easy step the next one is twice as long. If a branch check fails or is close
//! to its limit, the spectral radius determines the next length. Time and history belong to the whole model, so that all parts share their
//! steps; the part with the hardest step determines the length.

mod origin;
mod step;
mod track;

use std::sync::Arc;

use qless::{ArgumentError, SystemBuilder};
use qless_constraints::ConstraintSet;

use super::branch::growth;
use super::check_tangent::{TangentCheck, WrongEntry};
use super::correct::Factoring;
use super::parts::{EquilibriumPart, EquilibriumParts};
use super::rows::PartRows;
use super::stability::Stability;
use super::state::{EquilibriumState, Unknowns, constraint_forces};
use super::time_path::TimePath;
use super::{Equilibrium, EquilibriumError, EquilibriumOptions, LoadStep, Model, Start, Target};
use track::PartTrack;

/// A step with at most so many iterates was easy.
const EASY: usize = 8;

/// The state of a load path.
pub struct Path<'a, M> {
    model: &'a mut M,
    constraints: TimePath<'a>,
    start: &'a Start,
    target: &'a Target<'a>,
    options: &'a EquilibriumOptions,
    parts: Arc<EquilibriumParts>,
    state: EquilibriumState,
    /// The last equilibrium.
    at: Unknowns,
    /// Kept rows of each part at the last equilibrium.
    rows: Option<Vec<PartRows>>,
    rotations: Vec<[usize; 3]>,
    factoring: Vec<Factoring>,
    tracks: Vec<PartTrack>,
    steps: Vec<LoadStep>,
}

impl<'a, M: Model> Path<'a, M> {
    pub fn new(
        model: &'a mut M,
        constraints: TimePath<'a>,
        start: &'a Start,
        target: &'a Target<'a>,
        options: &'a EquilibriumOptions,
    ) -> Result<Self, EquilibriumError> {
        let set = constraints.set();
        let state = EquilibriumState::new(model, set)?;
        let parts = Arc::new(EquilibriumParts::new(&state.assembly, set, &state.evaluation, target.prescribed));
        let mut moves = vec![false; set.dofs()];
        target.prescribed.iter().for_each(|&(j, v)| moves[j] = start.u[j] != v);
        let in_time = matches!(constraints, TimePath::Driven { .. });
        let driven =
            |part: &EquilibriumPart| (in_time || part.prescribed.iter().any(|&j| moves[j])) && !is_straight(set, part);
        let track = |part: &EquilibriumPart| PartTrack { driven: driven(part), ..PartTrack::default() };
        let tracks = parts.list.iter().map(track).collect();
        let factoring = parts.list.iter().map(|_| Factoring::default()).collect();
        let at = Unknowns { u: start.u.clone(), multipliers: start.multipliers.in_rows(set)? };
        let (rows, rotations, steps) = (None, Vec::new(), Vec::new());
        Ok(Self {
            model,
            constraints,
            start,
            target,
            options,
            parts,
            state,
            at,
            rows,
            rotations,
            factoring,
            tracks,
            steps,
        })
    }

    /// Runs the path; after an error, the constraint set returns to its start.
    pub fn follow(mut self) -> Result<Equilibrium, EquilibriumError> {
        self.rotations = self.loose_rotations();
        let found = self.go();
        if found.is_err() {
            self.constraints.return_to(0.0);
        }
        found?;
        Ok(self.finish()?)
    }

    fn go(&mut self) -> Result<(), EquilibriumError> {
        let (mut factor, mut length) = (0.0, self.options.first);
        while factor < 1.0 {
            let tried: f64 = if factor + 1.001 * length >= 1.0 { 1.0 } else { factor + length };
            match self.step([factor, tried]) {
                Ok((at, rows)) => {
                    self.model.accept(&at.u);
                    (self.at, self.rows, factor) = (at, Some(rows), tried);
                    length = (self.longer() * length).max(length.min(self.options.shortest));
                }
                Err(failures) => {
                    self.constraints.return_to(factor);
                    length = failures.shorter() * (tried - factor);
                    if failures.is_fatal() || length < self.options.shortest {
                        let tried = self.steps.last().map_or(factor, |step| step.factor);
                        let error = failures.into_error(self.constraints.set(), factor, tried);
                        return Err(self.or_wrong_tangent(error, factor));
                    }
                }
            }
        }
        Ok(())
    }

    /// If a wrong tangent explains why no equilibrium was found, says so: it looks like a load that is too large, or like missing support.
    fn or_wrong_tangent(&mut self, error: EquilibriumError, factor: f64) -> EquilibriumError {
        let suspicious = matches!(
            error,
            EquilibriumError::NoConvergence { .. }
                | EquilibriumError::Unsupported { .. }
                | EquilibriumError::Solver { .. }
        );
        let last = self.state.evaluation.u().to_vec();
        let mut places = [&self.at.u, &last].into_iter().filter(|_| suspicious);
        let wrong = places.find_map(|u| TangentCheck::new(self.model, u).ok()?.wrong_entry());
        wrong.map_or(error, |WrongEntry { row, column, given, difference }| EquilibriumError::Tangent {
            factor,
            row,
            column,
            given,
            difference,
        })
    }

    /// Factor for the length of the next step.
    fn longer(&self) -> f64 {
        let easy = self.tracks.iter().all(|track| track.iterates <= EASY);
        self.tracks.iter().map(|track| growth(track.branch_check.radius)).fold(if easy { 2.0 } else { 1.0 }, f64::min)
    }

    fn finish(self) -> Result<Equilibrium, ArgumentError> {
        let Self { constraints, target, options, parts, state, at, rows, tracks, steps, .. } = self;
        let set = constraints.set();
        let forces: Vec<f64> = constraint_forces(state.evaluation.g(), &at.multipliers).iter().map(|f| -f).collect();
        let mut reactions = vec![0.0; at.u.len()];
        target.prescribed.iter().for_each(|&(j, _)| reactions[j] = state.residual[j]);
        let kept = |r: &usize| rows.as_ref().is_none_or(|rows| rows[parts.of_row(*r)].kept(*r));
        let stability = || Stability::of_parts(tracks.iter().filter_map(|track| track.stability));
        Ok(Equilibrium {
            reactions: set.forces_in_space(&at.u, &reactions)?,
            constraint_forces: set.forces_in_space(&at.u, &forces)?,
            redundant: (0..at.multipliers.len()).filter(|r| !kept(r)).collect(),
            loads: target.loads.to_vec(),
            stability: options.stability.then(stability),
            multipliers: set.by_constraint(&at.multipliers)?,
            u: at.u,
            steps,
        })
    }
}

/// Whether G of a part is constant.
fn is_straight(set: &ConstraintSet, part: &EquilibriumPart) -> bool {
    part.rows.iter().all(|r| set.linear_rows().contains(r))
}

/// Validates the lengths and numbers of the arguments.
pub fn check(dofs: usize, set: &ConstraintSet, start: &Start, target: &Target) -> Result<(), EquilibriumError> {
    let n = set.dofs();
    let lengths = [
        ("DOFs of the model", dofs, n),
        ("values of u at the start", start.u.len(), n),
        ("loads at the start", start.loads.len(), n),
        ("loads", target.loads.len(), n),
    ];
    if let Some((what, found, expected)) = lengths.into_iter().find(|(_, found, expected)| found != expected) {
        return Err(EquilibriumError::Size { what, found, expected });
    }
    let multipliers = start.multipliers.in_rows(set)?;
    let numbers = [("u", &start.u[..]), ("multiplier", &multipliers), ("load", &start.loads), ("load", target.loads)];
    for (what, list) in numbers {
        if let Some(at) = list.iter().position(|x| !x.is_finite()) {
            return Err(EquilibriumError::NotFinite { factor: 0.0, what, at });
        }
    }
    // The scalar part of Euler parameters has no component of a moment.
    let scalar = |dofs: Vec<usize>| (dofs.len() == 4).then(|| dofs[0]);
    let mut scalars = set.rotations().filter_map(scalar);
    if let Some(dof) = scalars.find(|&dof| start.loads[dof] != 0.0 || target.loads[dof] != 0.0) {
        return Err(EquilibriumError::Moment { dof });
    }
    // Detects DOFs that are out of range or named twice, and values that are not finite.
    let mut builder = SystemBuilder::new(set.dofs());
    target.prescribed.iter().for_each(|&(dof, value)| builder.prescribe(dof, value));
    let checked = builder.build().map(drop).map_err(qless_constraints::LineariseError::from);
    checked.map_err(|source| EquilibriumError::System { factor: 0.0, source })
}
