//! Load steps: `f_ext = f_0 + s (f_1 - f_0)`, `u_p = u_p0 + s (v - u_p0)`, `t = t_0 + s (t_1 - t_0)`, s from 0 to 1.
//!
//! A step that fails twice is cut to a quarter. After an easy step the next one is twice as long.

mod check;
mod origin;
mod step;

use super::branch::{Branch, Turn, growth, is_straight};
use super::course::Course;
use super::failure::Reached;
use super::pattern::Pattern;
use super::rows::Rows;
use super::stability::Stability;
use super::state::{State, Unknowns, constraint_forces};
use super::{Equilibrium, EquilibriumError, EquilibriumOptions, LoadStep, Model, Start, Target};

pub use check::check;

/// A step with fewer iterates was easy.
const EASY: usize = 8;
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
    /// Of the last step.
    turn: Turn,
    /// The rank of the constraints where the last step started, if they hold there.
    rank: Option<usize>,
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
            turn: Turn::default(),
            rank: None,
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
                    let longer = growth(self.turn.radius).min(if easy { 2.0 } else { 1.0 });
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
