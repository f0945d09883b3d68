//! Load steps: `f_ext = f_0 + s (f_1 - f_0)`, `u_p = u_p0 + s (v - u_p0)`, `t = t_0 + s (t_1 - t_0)`, s from 0 to 1.
//!
//! A step that fails is tried once more from the nearest configuration that satisfies the constraints (at a dead centre first order knows no
//! way), then it is cut to a quarter. After an easy step the next one is twice as long.

use qless::SystemBuilder;

use super::branch::{Branch, growth, is_straight};
use super::correct::Corrector;
use super::course::Course;
use super::failure::{Failure, Reached};
use super::pattern::Pattern;
use super::rows::Rows;
use super::stability::{Stability, stability};
use super::state::{State, Unknowns, constraint_forces};
use super::{Equilibrium, EquilibriumError, EquilibriumOptions, LoadStep, Model, Start, Target};
use crate::ConstraintSet;
use crate::newton::{self, NewtonError, NewtonOptions};
use crate::set::rotations::shorten;

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
    course: Course<'a>,
    start: &'a Start,
    target: &'a Target<'a>,
    options: &'a EquilibriumOptions,
    free: Vec<usize>,
    state: State,
    /// The last equilibrium.
    at: Unknowns,
    rows: Option<Rows>,
    rotations: Vec<[usize; 3]>,
    pattern: Pattern,
    in_units: bool,
    /// Whether constraints that are not linear are made to move.
    driven: bool,
    branch: Option<Branch>,
    of_branch: Pattern,
    /// The spectral radius of the last step.
    radius: f64,
    stability: Option<Stability>,
    steps: Vec<LoadStep>,
}

impl<'a, M: Model> Path<'a, M> {
    pub fn new(
        model: &'a mut M,
        course: Course<'a>,
        start: &'a Start,
        target: &'a Target<'a>,
        options: &'a EquilibriumOptions,
    ) -> Result<Self, EquilibriumError> {
        let set = course.set();
        let mut held = vec![false; set.dofs()];
        target.prescribed.iter().for_each(|&(j, _)| held[j] = true);
        let free = (0..set.dofs()).filter(|&j| !held[j]).collect();
        let state = State::new(model, set)?;
        let prescribed = target.prescribed.iter().any(|&(j, v)| start.u[j] != v);
        let driven = (prescribed || matches!(course, Course::Driven { .. })) && !is_straight(set);
        let at = Unknowns { u: start.u.clone(), multipliers: start.multipliers.clone() };
        Ok(Self {
            model,
            course,
            start,
            target,
            options,
            free,
            state,
            at,
            rows: None,
            rotations: Vec::new(),
            pattern: Pattern::default(),
            in_units: false,
            driven,
            branch: None,
            of_branch: Pattern::default(),
            radius: 0.0,
            stability: None,
            steps: Vec::new(),
        })
    }

    /// Where nothing is found, the constraints are those of the start again.
    pub fn follow(mut self) -> Result<Equilibrium, EquilibriumError> {
        self.rotations = self.loose_rotations();
        let found = self.go();
        if found.is_err() {
            self.course.back(0.0);
        }
        found.map(|()| self.finish())
    }

    fn go(&mut self) -> Result<(), EquilibriumError> {
        let (mut factor, mut length) = (0.0, self.options.first);
        while factor < 1.0 {
            let tried: f64 = if factor + 1.001 * length >= 1.0 { 1.0 } else { factor + length };
            match self.step([factor, tried]) {
                Ok((at, rows)) => {
                    self.model.accept(&at.u);
                    (self.at, self.rows, factor) = (at, Some(rows), tried);
                    let easy = self.steps.last().is_some_and(|step| step.iterates.len() <= EASY);
                    let longer = growth(self.radius).min(if easy { 2.0 } else { 1.0 });
                    length = (longer * length).max(length.min(self.options.shortest));
                }
                Err(failure) => {
                    self.course.back(factor);
                    length = failure.shorter() * (tried - factor);
                    if failure.is_fatal() || length < self.options.shortest {
                        return Err(failure.into_error(self.course.set(), self.reached(factor)));
                    }
                }
            }
        }
        Ok(())
    }

    fn reached(&self, factor: f64) -> Reached {
        let last = self.steps.last();
        let iterate = last.and_then(|step| step.iterates.last()).copied().unwrap_or_default();
        let tried = last.map_or(factor, |step| step.factor);
        Reached { factor, tried, force: iterate.force, constraint: iterate.constraint }
    }

    /// Equilibrium at a factor, from the last one.
    fn step(&mut self, [last, factor]: [f64; 2]) -> Result<(Unknowns, Rows), Failure> {
        let between = |from: f64, to: f64| if factor == 1.0 { to } else { from + factor * (to - from) };
        let loads: Vec<f64> = self.start.loads.iter().zip(self.target.loads).map(|(&a, &b)| between(a, b)).collect();
        let prescribed: Vec<(usize, f64)> =
            self.target.prescribed.iter().map(|&(j, v)| (j, between(self.start.u[j], v))).collect();
        // Half a turn at most, so that none comes to a whole one, where it is singular.
        self.rotations.iter().for_each(|&vector| _ = shorten(&mut self.at.u, vector));
        let rows = self.origin(&prescribed);
        self.course.go(factor)?;
        if let Some(branch) = &self.branch {
            branch.lead(&mut self.course, [last, factor], &mut self.state.quantities)?;
        }
        let first = rows.and_then(|rows| self.attempt(self.at.clone(), rows, factor, (&loads, &prescribed)));
        match first {
            Err(failure @ Failure::Branch(_)) => Err(failure),
            Err(failure) if !failure.is_fatal() => self.again(failure, factor, (&loads, &prescribed)),
            other => other,
        }
    }

    /// Rotation vectors that nobody but the constraints knows.
    fn loose_rotations(&mut self) -> Vec<[usize; 3]> {
        let evaluated = self.state.balance(self.model, self.course.set(), &self.at, &self.start.loads).is_ok();
        let mut known = self.state.assembly.known();
        self.target.prescribed.iter().for_each(|&(j, _)| known[j] = true);
        let loads = self.start.loads.iter().zip(self.target.loads);
        known.iter_mut().zip(loads).for_each(|(known, (a, b))| *known |= *a != 0.0 || *b != 0.0);
        let mut vectors = self.course.set().rotation_vectors();
        vectors.retain(|vector| evaluated && vector.iter().all(|&dof| !known[dof]));
        vectors
    }

    /// The rows of the next step, and the branch on which it starts.
    fn origin(&mut self, prescribed: &[(usize, f64)]) -> Result<Rows, Failure> {
        (self.branch, self.radius) = (None, 0.0);
        let (rows, holds) = match self.rows.clone() {
            Some(rows) => (rows, true),
            None => self.rows_at_start(prescribed)?,
        };
        if self.rows.is_some() && self.driven {
            self.course.set().evaluate(&self.at.u, &mut self.state.quantities)?;
        }
        if self.driven && holds {
            self.branch = Branch::new(&self.state.quantities, &rows, &self.free, &mut self.of_branch);
        }
        Ok(rows)
    }

    /// Rows where the constraints hold nearest to the start, which is evaluated; where that is not found in a few steps, at the start, and `false`.
    fn rows_at_start(&mut self, prescribed: &[(usize, f64)]) -> Result<(Rows, bool), Failure> {
        let held: Vec<(usize, f64)> = prescribed.iter().map(|&(j, _)| (j, self.at.u[j])).collect();
        let near = self.consistent(&held, LOOK);
        let holds = near.is_ok();
        let u = match near.or_else(|_| self.consistent(prescribed, LOOK)) {
            Err(Failure::Constraints(NewtonError::NoConvergence { .. })) => self.at.u.clone(),
            other => other?,
        };
        Ok((self.rows_at(&u, prescribed)?, holds))
    }

    fn rows_at(&mut self, u: &[f64], prescribed: &[(usize, f64)]) -> Result<Rows, Failure> {
        let set = self.course.set();
        set.evaluate(u, &mut self.state.quantities)?;
        let before = self.rows.as_ref().map_or(&[][..], |rows| rows.list());
        Rows::new(set, &self.state.quantities, prescribed, (self.options, before))
    }

    /// The nearest configuration that satisfies the constraints.
    fn consistent(&self, prescribed: &[(usize, f64)], steps: usize) -> Result<Vec<f64>, Failure> {
        let (tolerance, analysis) = (self.options.roundings, self.options.analysis.clone());
        let options = NewtonOptions { tolerance, steps, analysis };
        let found = newton::solve(self.course.set(), &self.at.u, prescribed, &options);
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
            set: self.course.set(),
            options: self.options,
            loads,
            prescribed,
            free: &self.free,
            state: &mut self.state,
            iterates: Vec::new(),
            changes: 0,
            pattern: &mut self.pattern,
            in_units: &mut self.in_units,
        };
        let mut result = corrector.run(&mut x, &mut rows);
        if result.is_ok() {
            let turn = self.branch.as_ref().map_or(Ok(0.0), |branch| branch.turn(&corrector.state.quantities));
            result = turn.map(|radius| self.radius = radius);
        }
        if result.is_ok() && factor == 1.0 {
            result = corrector.supported(&rows).map(|saddle| {
                let asked = self.options.stability;
                self.stability = asked.then(|| stability(saddle.matrix(), self.free.len()));
            });
        }
        let iterates = corrector.iterates;
        self.steps.push(LoadStep { factor, converged: result.is_ok(), iterates });
        result.map(|()| (x, rows))
    }

    fn finish(self) -> Equilibrium {
        let Self { target, state, at, rows, stability, steps, .. } = self;
        let forces = constraint_forces(state.quantities.g(), &at.multipliers);
        let kept = |r: &usize| rows.as_ref().is_none_or(|rows| rows.kept(*r));
        Equilibrium {
            reactions: target.prescribed.iter().map(|&(j, _)| state.residual[j]).collect(),
            constraint_forces: forces.iter().map(|f| -f).collect(),
            redundant: (0..at.multipliers.len()).filter(|r| !kept(r)).collect(),
            loads: target.loads.to_vec(),
            u: at.u,
            stability,
            multipliers: at.multipliers,
            steps,
        }
    }
}
