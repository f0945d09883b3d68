//! Load steps: `f_ext = f_0 + s (f_1 - f_0)`, `u_p = u_p0 + s (v - u_p0)`, s from 0 to 1.
//!
//! A step that fails is tried once more from the nearest configuration that satisfies the constraints (at a dead centre first order knows no
//! way), then it is cut to a quarter. After an easy step the next one is twice as long.

use qless::SystemBuilder;

use super::correct::Corrector;
use super::failure::{Failure, Reached};
use super::rows::Rows;
use super::state::{State, Unknowns, constraint_forces};
use super::{Equilibrium, EquilibriumError, EquilibriumOptions, LoadStep, Model, Start, Target};
use crate::ConstraintSet;
use crate::newton::{self, NewtonError, NewtonOptions};

/// A step with fewer iterates was easy.
const EASY: usize = 8;
/// Steps of Newton's method on the constraints, to see which rows are redundant.
const LOOK: usize = 10;

/// Lengths, before anything else.
pub fn check(dofs: usize, set: &ConstraintSet, start: &Start, target: &Target) -> Result<(), EquilibriumError> {
    let (n, m) = (set.dofs(), set.equations());
    let lengths = [
        ("DOFs of the model", dofs, n),
        ("values of u at the start", start.u.len(), n),
        ("multipliers at the start", start.multipliers.len(), m),
        ("loads at the start", start.loads.len(), n),
        ("loads", target.loads.len(), n),
    ];
    if let Some((what, found, expected)) = lengths.into_iter().find(|(_, found, expected)| found != expected) {
        return Err(EquilibriumError::Size { what, found, expected });
    }
    let numbers =
        [("u", &start.u[..]), ("multiplier", &start.multipliers), ("load", &start.loads), ("load", target.loads)];
    for (what, list) in numbers {
        if let Some(at) = list.iter().position(|x| !x.is_finite()) {
            return Err(EquilibriumError::NotFinite { factor: 0.0, what, at });
        }
    }
    // DOFs out of range or named twice, and values that are not finite.
    let mut builder = SystemBuilder::new(set.dofs());
    target.prescribed.iter().for_each(|&(dof, value)| builder.prescribe(dof, value));
    let checked = builder.build().map(drop).map_err(crate::LineariseError::from);
    checked.map_err(|source| EquilibriumError::System { factor: 0.0, source })
}

/// The way from the start to the target.
pub struct Path<'a, M> {
    model: &'a mut M,
    set: &'a ConstraintSet,
    start: &'a Start,
    target: &'a Target<'a>,
    options: &'a EquilibriumOptions,
    free: Vec<usize>,
    state: State,
    /// The last equilibrium.
    at: Unknowns,
    rows: Option<Rows>,
    steps: Vec<LoadStep>,
}

impl<'a, M: Model> Path<'a, M> {
    pub fn new(
        model: &'a mut M,
        set: &'a ConstraintSet,
        start: &'a Start,
        target: &'a Target<'a>,
        options: &'a EquilibriumOptions,
    ) -> Result<Self, EquilibriumError> {
        let mut held = vec![false; set.dofs()];
        target.prescribed.iter().for_each(|&(j, _)| held[j] = true);
        let free = (0..set.dofs()).filter(|&j| !held[j]).collect();
        let state = State::new(model, set)?;
        let at = Unknowns { u: start.u.clone(), multipliers: start.multipliers.clone() };
        Ok(Self { model, set, start, target, options, free, state, at, rows: None, steps: Vec::new() })
    }

    pub fn follow(mut self) -> Result<Equilibrium, EquilibriumError> {
        let (mut factor, mut length) = (0.0, self.options.first);
        while factor < 1.0 {
            let tried: f64 = if factor + 1.001 * length >= 1.0 { 1.0 } else { factor + length };
            match self.step(tried) {
                Ok((at, rows)) => {
                    self.model.accept(&at.u);
                    (self.at, self.rows, factor) = (at, Some(rows), tried);
                    let easy = self.steps.last().is_some_and(|step| step.iterates.len() <= EASY);
                    length *= if easy { 2.0 } else { 1.0 };
                }
                Err(failure) => {
                    length = 0.25 * (tried - factor);
                    if failure.is_fatal() || length < self.options.shortest {
                        return Err(failure.into_error(self.set, self.reached(factor)));
                    }
                }
            }
        }
        Ok(self.finish())
    }

    fn reached(&self, factor: f64) -> Reached {
        let last = self.steps.last();
        let iterate = last.and_then(|step| step.iterates.last()).copied().unwrap_or_default();
        let tried = last.map_or(factor, |step| step.factor);
        Reached { factor, tried, force: iterate.force, constraint: iterate.constraint }
    }

    /// Equilibrium at a factor, from the last one.
    fn step(&mut self, factor: f64) -> Result<(Unknowns, Rows), Failure> {
        let between = |from: f64, to: f64| if factor == 1.0 { to } else { from + factor * (to - from) };
        let loads: Vec<f64> = self.start.loads.iter().zip(self.target.loads).map(|(&a, &b)| between(a, b)).collect();
        let prescribed: Vec<(usize, f64)> =
            self.target.prescribed.iter().map(|&(j, v)| (j, between(self.start.u[j], v))).collect();
        let first = match self.rows.clone().map_or_else(|| self.rows_at_start(&prescribed), Ok) {
            Ok(rows) => self.attempt(self.at.clone(), rows, factor, (&loads, &prescribed)),
            Err(failure) => Err(failure),
        };
        match first {
            Err(failure) if !failure.is_fatal() => self.again(failure, factor, (&loads, &prescribed)),
            other => other,
        }
    }

    /// Rows where the constraints hold nearest to the start; where that is not found in a few steps, at the start.
    fn rows_at_start(&mut self, prescribed: &[(usize, f64)]) -> Result<Rows, Failure> {
        let held: Vec<(usize, f64)> = prescribed.iter().map(|&(j, _)| (j, self.at.u[j])).collect();
        let found = self.consistent(&held, LOOK).or_else(|_| self.consistent(prescribed, LOOK));
        let u = match found {
            Err(Failure::Constraints(NewtonError::NoConvergence { .. })) => self.at.u.clone(),
            other => other?,
        };
        self.rows_at(&u, prescribed)
    }

    fn rows_at(&mut self, u: &[f64], prescribed: &[(usize, f64)]) -> Result<Rows, Failure> {
        self.set.evaluate(u, &mut self.state.quantities)?;
        let before = self.rows.as_ref().map_or(&[][..], |rows| rows.list());
        Rows::new(self.set, &self.state.quantities, prescribed, (self.options, before))
    }

    /// The nearest configuration that satisfies the constraints.
    fn consistent(&self, prescribed: &[(usize, f64)], steps: usize) -> Result<Vec<f64>, Failure> {
        let (tolerance, analysis) = (self.options.roundings, self.options.analysis.clone());
        let options = NewtonOptions { tolerance, steps, analysis };
        let found = newton::solve(self.set, &self.at.u, prescribed, &options);
        found.map(|found| found.u).map_err(Failure::Constraints)
    }

    /// From the nearest configuration that satisfies the constraints.
    fn again(
        &mut self,
        failure: Failure,
        factor: f64,
        (loads, prescribed): (&[f64], &[(usize, f64)]),
    ) -> Result<(Unknowns, Rows), Failure> {
        let u = match self.consistent(prescribed, NewtonOptions::default().steps) {
            Ok(u) if u != self.at.u => u,
            Err(proof @ Failure::Constraints(NewtonError::Conflict { .. })) => return Err(proof),
            _ => return Err(failure),
        };
        let rows = self.rows_at(&u, prescribed)?;
        let from = Unknowns { u, multipliers: self.at.multipliers.clone() };
        self.attempt(from, rows, factor, (loads, prescribed)).map_err(|second| match second {
            // Of two reasons the first, which is that of the shorter way.
            Failure::NoConvergence => failure,
            other => other,
        })
    }

    fn attempt(
        &mut self,
        mut x: Unknowns,
        mut rows: Rows,
        factor: f64,
        (loads, prescribed): (&[f64], &[(usize, f64)]),
    ) -> Result<(Unknowns, Rows), Failure> {
        let mut corrector = Corrector {
            model: &mut *self.model,
            set: self.set,
            options: self.options,
            loads,
            prescribed,
            free: &self.free,
            state: &mut self.state,
            iterates: Vec::new(),
            changes: 0,
        };
        let mut result = corrector.run(&mut x, &mut rows);
        if result.is_ok() && factor == 1.0 {
            result = corrector.supported(&rows);
        }
        let iterates = corrector.iterates;
        self.steps.push(LoadStep { factor, converged: result.is_ok(), iterates });
        result.map(|()| (x, rows))
    }

    fn finish(self) -> Equilibrium {
        let Self { target, state, at, rows, steps, .. } = self;
        let forces = constraint_forces(state.quantities.g(), &at.multipliers);
        let kept = |r: &usize| rows.as_ref().is_none_or(|rows| rows.kept(*r));
        Equilibrium {
            reactions: target.prescribed.iter().map(|&(j, _)| state.residual[j]).collect(),
            constraint_forces: forces.iter().map(|f| -f).collect(),
            redundant: (0..at.multipliers.len()).filter(|r| !kept(r)).collect(),
            loads: target.loads.to_vec(),
            u: at.u,
            multipliers: at.multipliers,
            steps,
        }
    }
}
