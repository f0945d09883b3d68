//! Newton's iteration of all parts: analyse, decide what each part needs, compute its direction, and move it by a length of its own.

use qless::{Analysis, ArgumentError, SystemBuilder};
use qless_constraints::{ConstraintSet, Evaluation, shorten_rotation};

use super::configuration::{Configuration, at_rest, in_roundings};
use super::error::NewtonError;
use super::linearisation::{Motions, dependent, kept, linearise};
use super::lower_rank::{LowerRank, Searches};
use super::parts::Parts;
use super::singular::second_order_directions;
use super::solution::{NewtonIterate, NewtonOptions};
use super::step::{StepGoal, StepLine};

pub struct Iteration<'a> {
    set: &'a ConstraintSet,
    options: &'a NewtonOptions,
    prescribed: &'a [(usize, f64)],
    parts: &'a Parts,
    /// Rotation vectors without prescribed DOFs. They are shortened to at most half a turn, since a whole turn is singular.
    rotations: Vec<[usize; 3]>,
    pub now: Configuration,
    /// Buffers for trial points.
    buffer: Evaluation,
    /// For each equation, `|c_r|` divided by the bound on its rounding. In settled parts, it is the value of [`at_rest`], which may be
    /// smaller.
    residuals: Vec<f64>,
    states: Vec<PartStatus>,
    searches: Vec<Searches>,
    /// Redundant equations that do not hold although the kept equations of their part hold.
    contradicted: Vec<usize>,
    pub iterates: Vec<NewtonIterate>,
    /// Parts that failed, ordered by the step at which they failed and then by their lowest DOFs.
    pub failures: Vec<(usize, NewtonError)>,
}

/// Status of one part.
#[derive(Clone)]
struct PartStatus {
    goal: StepGoal,
    /// Whether the constraint values c of the part no longer fall.
    settled: bool,
    /// Length t of the last step, which moved the part by t du.
    length: f64,
}

impl<'a> Iteration<'a> {
    pub fn new(
        (set, parts): (&'a ConstraintSet, &'a Parts),
        u: &[f64],
        prescribed: &'a [(usize, f64)],
        options: &'a NewtonOptions,
    ) -> Result<Self, NewtonError> {
        let mut u = u.to_vec();
        prescribed.iter().for_each(|&(j, v)| u.iter_mut().skip(j).take(1).for_each(|u| *u = v));
        let argument = |source| NewtonError::Argument { step: 0, source };
        // The check covers all DOFs, also those that no equation uses.
        if let Some(place) = u.iter().position(|u| !u.is_finite()) {
            return Err(argument(ArgumentError::NotFinite { what: "u", place, value: u[place] }));
        }
        let rotations = free_rotations(set, prescribed);
        rotations.iter().for_each(|&vector| _ = shorten_rotation(&mut u, vector));
        let now = Configuration::new(set, u, parts).map_err(argument)?;
        let states = vec![PartStatus { goal: StepGoal::Downhill, settled: false, length: 1.0 }; parts.list.len()];
        Ok(Self {
            set,
            options,
            prescribed,
            parts,
            rotations,
            residuals: in_roundings(now.evaluation.c(), now.rounding.c()),
            now,
            buffer: set.allocate(),
            states,
            searches: vec![Searches::default(); parts.list.len()],
            contradicted: Vec::new(),
            iterates: Vec::new(),
            failures: Vec::new(),
        })
    }

    /// Makes steps until all parts are done or have failed, or until `may_go_on` rejects the failures. Returns the equations that are
    /// redundant at the end.
    pub fn run(&mut self, may_go_on: impl Fn(&[(usize, NewtonError)]) -> bool) -> Result<Vec<usize>, NewtonError> {
        for step in 0.. {
            let analysis = linearise(self.now.place(self.set), self.prescribed, (step, &self.options.analysis))?;
            self.note(&analysis);
            self.decide(&analysis).map_err(|source| NewtonError::Argument { step, source })?;
            for part in self.going().filter(|_| step == self.options.steps).collect::<Vec<_>>() {
                self.fail(part, self.no_convergence(step, part));
            }
            if self.going().next().is_some() && may_go_on(&self.failures) {
                self.advance(&analysis, step)?;
            }
            if self.going().next().is_none() || !may_go_on(&self.failures) {
                return Ok(dependent(&analysis));
            }
        }
        Ok(Vec::new())
    }

    /// Parts that are neither done nor failed.
    fn going(&self) -> impl Iterator<Item = usize> {
        (0..self.states.len()).filter(|&part| self.states[part].goal != StepGoal::Done)
    }

    fn note(&mut self, analysis: &Analysis) {
        self.iterates.push(NewtonIterate {
            residual: self.now.residuals.iter().copied().fold(0.0, f64::max),
            rank: analysis.rank(),
            ignored: dependent(analysis),
            length: self.going().map(|part| self.states[part].length).fold(1.0, f64::min),
        });
    }

    /// Decides what each part needs next.
    ///
    /// A part is done if its kept equations hold to the tolerance, and its redundant ones to the tolerance plus the rounding of the kept
    /// equations in their certificates.
    fn decide(&mut self, analysis: &Analysis) -> Result<(), ArgumentError> {
        let (kept, tolerance) = (kept(analysis), self.options.tolerance);
        let off = self.parts.fold(false, |off, r| *off |= kept[r] && self.residuals[r] > tolerance);
        self.contradicted.clear();
        for row in dependent(analysis) {
            let part = self.parts.of_row(row);
            if self.states[part].goal != StepGoal::Done && !off[part] && self.contradicts(analysis, row)? {
                self.contradicted.push(row);
            }
        }
        for (part, off) in off
            .into_iter()
            .enumerate()
            .filter(|(part, _)| self.states[*part].goal != StepGoal::Done)
            .collect::<Vec<_>>()
        {
            self.states[part].goal = if off { StepGoal::Downhill } else { StepGoal::Done };
        }
        self.contradicted.iter().for_each(|&row| self.states[self.parts.of_row(row)].goal = StepGoal::Out);
        Ok(())
    }

    /// Whether a redundant equation does not hold, beyond the rounding of this equation and of the equations in its certificate.
    fn contradicts(&self, analysis: &Analysis, row: usize) -> Result<bool, ArgumentError> {
        if self.residuals[row] <= self.options.tolerance {
            return Ok(false);
        }
        let rounding = self.now.rounding.c();
        let terms = analysis.because(row)?.into_iter().map(|term| term.coefficient.abs() * rounding[term.row]);
        let allowed = self.options.tolerance * terms.fold(rounding[row], |sum, term| sum + term);
        Ok(!(self.now.evaluation.c()[row].abs() <= allowed && allowed.is_finite()))
    }

    /// Moves each part by its step length. A part fails and stays if its equations conflict. It also fails if no step length is found while
    /// its c no longer falls, or while its configuration is singular.
    fn advance(&mut self, analysis: &Analysis, step: usize) -> Result<(), NewtonError> {
        let argument = |source| NewtonError::Argument { step, source };
        let units = self.now.scales.units.clone();
        let motions = Motions::new(analysis, &units, step);
        // Equations that are nearly dependent may have no accurate T. A step with a lower rank is tried then.
        let mut du = motions.as_ref().map_or_else(|_| Ok(vec![0.0; units.len()]), Motions::step).map_err(argument)?;
        let mut exists = vec![true; self.states.len()];
        if !self.contradicted.is_empty() {
            let (place, motions) = ((self.set, self.parts, &mut self.now), motions.as_ref().map_err(Clone::clone)?);
            let (out, found) =
                second_order_directions(place, (&self.contradicted, analysis), motions).map_err(argument)?;
            let goes_out =
                |j: &usize| self.parts.of_dof(*j).is_some_and(|part| self.states[part].goal == StepGoal::Out);
            (0..du.len()).filter(goes_out).for_each(|j| du[j] = out[j]);
            exists = found;
        }
        let goals: Vec<StepGoal> = self.states.iter().map(|state| state.goal).collect();
        let (from, kept, tolerance) = (&self.now, &kept(analysis)[..], self.options.tolerance);
        let mut line = StepLine { set: self.set, parts: self.parts, from, kept, tolerance, du };
        let mut found = line.lengths(&goals, &mut self.buffer).map_err(argument)?;
        let (prescribed, options) = (self.prescribed, &self.options.analysis);
        let lower = LowerRank { prescribed, options, goals: &goals, step };
        lower.improve(&mut line, &mut found, (&mut self.searches, &mut self.buffer))?;
        let lengths = found.lengths;
        if lengths.iter().all(|&length| length == 0.0) {
            motions?;
        }
        let u = line.at(&lengths);
        for (part, &goal) in goals.iter().enumerate().filter(|(_, goal)| **goal != StepGoal::Done) {
            if goal == StepGoal::Out && !exists[part] {
                self.fail(part, self.conflict(part, analysis));
            } else if lengths[part] == 0.0 && (self.states[part].settled || goal == StepGoal::Out) {
                self.fail(part, self.no_convergence(step, part));
            }
        }
        self.move_to(u, &lengths).map_err(argument)
    }

    /// Moves the parts by their step lengths. A part then counts as settled if its c did not fall, as that of a part that did not move.
    fn move_to(&mut self, mut u: Vec<f64>, lengths: &[f64]) -> Result<(), ArgumentError> {
        let moved = |vector: &&[usize; 3]| self.parts.of_dof(vector[0]).is_some_and(|part| lengths[part] > 0.0);
        self.rotations.iter().filter(moved).for_each(|&vector| _ = shorten_rotation(&mut u, vector));
        let before = std::mem::replace(&mut self.now, Configuration::new(self.set, u, self.parts)?);
        for part in self.going().collect::<Vec<_>>() {
            let (state, moves) = (&mut self.states[part], lengths[part] > 0.0);
            state.settled = self.now.residuals[part] >= before.residuals[part];
            state.length = if moves { lengths[part] } else { state.length };
        }
        self.residuals = in_roundings(self.now.evaluation.c(), self.now.rounding.c());
        if self.states.iter().any(|state| state.settled) {
            let numbers = (&self.now.evaluation, &self.now.rounding, &self.now.scales.weights[..]);
            let rest = at_rest(self.set, numbers, self.parts)?;
            let settled = (0..rest.len()).filter(|&r| self.states[self.parts.of_row(r)].settled);
            settled.for_each(|r| self.residuals[r] = rest[r]);
        }
        Ok(())
    }

    /// Marks a part as failed; it does not move any more.
    fn fail(&mut self, part: usize, error: NewtonError) {
        self.states[part].goal = StepGoal::Done;
        self.failures.push((part, error));
    }

    fn conflict(&self, part: usize, analysis: &Analysis) -> NewtonError {
        let rows: Vec<usize> =
            self.contradicted.iter().copied().filter(|&row| self.parts.of_row(row) == part).collect();
        let named = |rows: &[usize]| rows.iter().filter_map(|&row| self.set.label(row).ok()).collect();
        let mut others: Vec<usize> =
            rows.iter().flat_map(|&row| analysis.because(row).unwrap_or_default()).map(|term| term.row).collect();
        others.sort_unstable();
        others.dedup();
        let amount = rows.iter().map(|&row| self.now.evaluation.c()[row].abs()).fold(0.0, f64::max);
        NewtonError::Conflict { labels: named(&rows), others: named(&others), rows, amount }
    }

    fn no_convergence(&self, steps: usize, part: usize) -> NewtonError {
        let weighted = |&r: &usize| self.now.scales.weights[r] * self.now.evaluation.c()[r].abs();
        let worst = self.parts.list[part].rows.iter().copied().max_by(|a, b| weighted(a).total_cmp(&weighted(b)));
        let label = worst.and_then(|row| self.set.label(row).ok()).unwrap_or_default();
        NewtonError::NoConvergence { steps, residual: self.now.residuals[part], label }
    }
}

/// Rotation vectors without prescribed DOFs.
pub fn free_rotations(set: &ConstraintSet, prescribed: &[(usize, f64)]) -> Vec<[usize; 3]> {
    let mut rotations = set.rotation_vectors();
    rotations.retain(|vector| prescribed.iter().all(|(dof, _)| !vector.contains(dof)));
    rotations
}

/// Refuses prescribed DOFs that are out of range or named twice, and values that are not finite.
pub fn check_prescribed(set: &ConstraintSet, prescribed: &[(usize, f64)]) -> Result<(), NewtonError> {
    let mut builder = SystemBuilder::new(set.dofs());
    prescribed.iter().for_each(|&(dof, value)| builder.prescribe(dof, value));
    // Only a system with at least one DOF can be built. Without prescribed DOFs there is nothing to check.
    let checked = if prescribed.is_empty() { Ok(()) } else { builder.build().map(drop) };
    checked.map_err(|source| NewtonError::System { step: 0, source: source.into() })
}
