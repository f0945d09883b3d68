//! Load steps: `f_ext = f_0 + s (f_1 - f_0)`, `u_p = u_p0 + s (v - u_p0)`, `t = t_0 + s (t_1 - t_0)`, with s from 0 to 1 and the prescribed
//! values v of the target.
//!
//! A step that fails twice is shortened to a quarter; after an easy step the next one is twice as long, or as long as its branch check
//! allows. Time and history belong to the whole model, so that all parts share their steps; the part with the hardest step determines the
//! length.

use std::sync::Arc;

use qless_constraints::ConstraintSet;

use super::branch::{Branch, BranchCheck};
use super::check_tangent::{TangentCheck, WrongEntry};
use super::rows::PartRows;
use super::saddle::SaddlePattern;
use super::stability::Stability;
use super::state::{EquilibriumState, Unknowns, constraint_forces};
use super::time_path::TimePath;
use super::{Equilibrium, EquilibriumError, EquilibriumOptions, LoadStep, Model, Start, Target};
use crate::newton::{Parts, check_prescribed};

/// The state of a load path.
pub struct Path<'a, M> {
    pub model: &'a mut M,
    pub constraints: TimePath<'a>,
    pub start: &'a Start,
    pub target: &'a Target<'a>,
    pub options: &'a EquilibriumOptions,
    pub parts: Arc<Parts>,
    pub state: EquilibriumState,
    /// The last equilibrium.
    pub at: Unknowns,
    /// Kept rows of each part at the last equilibrium.
    pub rows: Option<Vec<PartRows>>,
    /// Rotation vectors that neither the model nor a load or prescribed value uses.
    pub rotations: Vec<[usize; 3]>,
    pub patterns: Vec<SaddlePattern>,
    pub tracks: Vec<PartTrack>,
    pub steps: Vec<LoadStep>,
}

/// State of each part along a load path.
#[derive(Default)]
pub struct PartTrack {
    /// Whether time or prescribed DOFs move nonlinear constraints of the part.
    pub driven: bool,
    pub branch: Option<Branch>,
    /// Result of the branch check of the last step.
    pub branch_check: BranchCheck,
    /// Number of independent rows at the start of the last step, if the constraints hold there.
    pub rank: Option<usize>,
    pub stability: Option<Stability>,
    /// Number of iterates in the last attempt.
    pub iterates: usize,
}

impl<'a, M: Model> Path<'a, M> {
    pub fn new(
        model: &'a mut M,
        constraints: TimePath<'a>,
        start: &'a Start,
        target: &'a Target<'a>,
        options: &'a EquilibriumOptions,
    ) -> Result<Self, EquilibriumError> {
        options.validate()?;
        let set = constraints.set();
        let multipliers = check(model.dofs(), set, start, target)?;
        let state = EquilibriumState::new(model, set)?;
        let n = set.dofs();
        let elements = (0..n).map(|i| std::iter::once(i).chain(state.assembly.row(i).map(|(j, _)| j)).collect());
        let is_held = |j: &usize| target.prescribed.iter().any(|(held, _)| held == j);
        let vectors = set.rotation_vectors().into_iter().filter(|vector| !vector.iter().any(is_held));
        // A prescribed DOF does not join other DOFs to one part, although its row of K couples them.
        let mut held = vec![false; n];
        target.prescribed.iter().for_each(|&(j, _)| held[j] = true);
        let elements = elements.enumerate().filter(|(i, _)| !held[*i]).map(|(_, row): (_, Vec<usize>)| row);
        let together = elements.chain(vectors.map(Vec::from));
        let parts = Arc::new(Parts::new(state.evaluation.g(), target.prescribed, together));
        let (patterns, tracks) = parts.list.iter().map(|_| (SaddlePattern::default(), PartTrack::default())).unzip();
        let at = Unknowns { u: start.u.clone(), multipliers };
        let (rows, rotations, steps) = (None, Vec::new(), Vec::new());
        let mut path = Self {
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
            patterns,
            tracks,
            steps,
        };
        path.find_driven();
        path.find_rotations();
        Ok(path)
    }

    fn find_driven(&mut self) {
        let set = self.constraints.set();
        let in_time = matches!(self.constraints, TimePath::Driven { .. });
        let moves = self.awaits(&Self::ahead(self.target.prescribed, &self.start.u));
        for ((track, part), moves) in self.tracks.iter_mut().zip(&self.parts.list).zip(moves) {
            track.driven = (in_time || moves) && !part.rows.iter().all(|r| set.linear_rows().contains(r));
        }
    }

    fn find_rotations(&mut self) {
        let evaluated = self.state.balance(self.model, self.constraints.set(), &self.at, &self.start.loads).is_ok();
        let mut known = self.state.assembly.known();
        self.target.prescribed.iter().for_each(|&(j, _)| known[j] = true);
        let loads = self.start.loads.iter().zip(self.target.loads);
        known.iter_mut().zip(loads).for_each(|(known, (a, b))| *known |= *a != 0.0 || *b != 0.0);
        self.rotations = self.constraints.set().rotation_vectors();
        self.rotations.retain(|vector| evaluated && vector.iter().all(|&dof| !known[dof]));
    }

    /// Remaining motion of the prescribed DOFs; zero for free DOFs.
    pub fn ahead(prescribed: &[(usize, f64)], u: &[f64]) -> Vec<f64> {
        let mut ahead = vec![0.0; u.len()];
        prescribed.iter().for_each(|&(j, v)| ahead[j] = v - u[j]);
        ahead
    }

    /// Whether the forces or equations of each part depend on DOFs that have yet to move.
    pub fn awaits(&self, ahead: &[f64]) -> Vec<bool> {
        let mut awaits: Vec<bool> = self.parts.list.iter().map(|_| false).collect();
        for (part, awaits) in self.parts.list.iter().zip(&mut awaits) {
            let of_k = part.free.iter().flat_map(|&i| self.state.assembly.row(i).map(|(j, _)| j));
            let of_g = part.rows.iter().flat_map(|&r| self.state.evaluation.g().row(r).map(|(j, _)| j));
            *awaits = of_k.chain(of_g).any(|j| ahead[j] != 0.0);
        }
        awaits
    }

    /// Runs the path; after an error, the constraint set returns to its start.
    pub fn follow(mut self) -> Result<Equilibrium, EquilibriumError> {
        let (mut factor, mut length) = (0.0, self.options.first);
        while factor < 1.0 {
            let tried: f64 = if factor + 1.001 * length >= 1.0 { 1.0 } else { factor + length };
            match self.step([factor, tried]) {
                Ok((at, rows)) => {
                    self.model.accept(&at.u);
                    (self.at, self.rows, factor) = (at, Some(rows), tried);
                    length = (self.longer() * length).max(length.min(self.options.shortest));
                }
                Err(error) => {
                    let is_last = error.is_fatal() || length <= self.options.shortest;
                    length = (0.25 * length.min(1.0 - factor)).max(self.options.shortest);
                    let _ = self.constraints.set_factor(if is_last { 0.0 } else { factor });
                    if is_last {
                        return Err(self.or_wrong_tangent(error).at(factor));
                    }
                }
            }
        }
        self.finish()
    }

    /// Replaces an error of convergence, support or the solver by [`EquilibriumError::Tangent`] if an entry of the tangent is wrong. A
    /// wrong tangent looks like a load that is too large, or like missing support.
    fn or_wrong_tangent(&mut self, error: EquilibriumError) -> EquilibriumError {
        let suspicious = matches!(
            error,
            EquilibriumError::NoConvergence { .. }
                | EquilibriumError::Unsupported { .. }
                | EquilibriumError::Solver { .. }
        );
        let last = self.state.evaluation.u().to_vec();
        let mut places = [&self.at.u, &last].into_iter().filter(|_| suspicious);
        let wrong = places.find_map(|u| TangentCheck::new(self.model, u).ok()?.wrong_entry());
        wrong.map_or(error, WrongEntry::into_error)
    }

    /// Factor for the length of the next step: 2 after an easy step, otherwise 1, and less if a branch check demands it. A step was easy if
    /// it took at most a third of the allowed iterations.
    fn longer(&self) -> f64 {
        let easy = self.tracks.iter().all(|track| 3 * track.iterates <= self.options.iterations);
        let growths = self.tracks.iter().map(|track| track.branch_check.growth());
        growths.fold(if easy { 2.0 } else { 1.0 }, f64::min)
    }

    fn finish(self) -> Result<Equilibrium, EquilibriumError> {
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

/// Validates the arguments; returns the multipliers of the start.
fn check(dofs: usize, set: &ConstraintSet, start: &Start, target: &Target) -> Result<Vec<f64>, EquilibriumError> {
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
    // A moment has no component at the scalar part of Euler parameters, so that no load is allowed there.
    let scalar = |dofs: Vec<usize>| (dofs.len() == 4).then(|| dofs[0]);
    let mut scalars = set.rotations().filter_map(scalar);
    if let Some(dof) = scalars.find(|&dof| start.loads[dof] != 0.0 || target.loads[dof] != 0.0) {
        return Err(EquilibriumError::Moment { dof });
    }
    check_prescribed(set, target.prescribed)?;
    Ok(multipliers)
}
