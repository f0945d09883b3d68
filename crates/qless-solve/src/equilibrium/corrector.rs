//! Newton's method at one load: `[K + H, G^T; G, 0] [du; lambda' - lambda] = -[r; c]`, where H is the stiffness of the constraints at the
//! current multipliers lambda.
//!
//! All parts are iterated together: one evaluation of model and constraints serves all. Scales, factors, step lengths, kept rows and
//! termination are separate. A part that has converged or failed does not move. One iteration:
//!
//! | operation | for | cost |
//! | --- | --- | --- |
//! | evaluation with stiffness | all parts together | one pass |
//! | new choice of rows | parts that need it | one analysis, rarely |
//! | tangent | each part | one numeric LU of it |
//! | step lengths | all parts together | one pass and one solve of each part per trial |

use qless_constraints::ConstraintSet;

use super::rows::{PartRows, RowChoice};
use super::saddle::{Saddle, SaddlePattern};
use super::state::{EquilibriumState, Unknowns};
use super::{EquilibriumError, EquilibriumIterate, EquilibriumOptions, Model};
use crate::newton::Parts;

/// Largest number of new choices of rows in one load step. One choice should give the rows at the solution; more mean that choices
/// alternate.
const CHANGES: usize = 4;

/// Load factor, loads and prescribed values at the end of a load step.
pub struct StepTarget {
    pub factor: f64,
    pub loads: Vec<f64>,
    pub prescribed: Vec<(usize, f64)>,
}

/// Newton's method in one load step of all parts.
pub struct Corrector<'a, M> {
    pub model: &'a mut M,
    pub set: &'a ConstraintSet,
    pub options: &'a EquilibriumOptions,
    pub parts: &'a Parts,
    pub end: &'a StepTarget,
    pub state: &'a mut EquilibriumState,
    pub patterns: &'a mut [SaddlePattern],
    pub all: &'a mut [PartProgress],
    /// Remaining motion of the prescribed DOFs; zero for free DOFs.
    pub ahead: Vec<f64>,
    /// For each part, whether its forces or equations depend on prescribed DOFs that have yet to move.
    pub awaits: Vec<bool>,
    /// For each part, whether its forces or equations depend on prescribed DOFs that have not yet moved to their new values.
    pub last_valid: Option<Unknowns>,
}

/// A Newton correction of a part.
pub struct Correction {
    pub part: usize,
    pub saddle: Saddle,
    pub dx: Vec<f64>,
    /// Whether the correction changes multipliers only. New multipliers may make a singular tangent regular, as tension does for a slack
    /// chain.
    pub only_multipliers: bool,
}

pub struct PartProgress {
    pub rows: PartRows,
    pub stage: PartStage,
    pub iterates: Vec<EquilibriumIterate>,
    /// Length of the last step, 1 for a full correction.
    pub length: f64,
    /// DOFs of a motion that the tangent does not resist, at the last iterate; none if it resists all motions.
    pub loose: Option<Vec<usize>>,
    /// Number of changes of the kept rows.
    changes: usize,
}

/// The stage of a part's iteration.
pub enum PartStage {
    /// The part is iterated.
    Iterating,
    /// The part is ready to take this correction. It waits until all parts are ready to move their prescribed DOFs, since parts may share
    /// these DOFs.
    Ready(Vec<f64>),
    /// The part is in equilibrium.
    Done,
    Failed(EquilibriumError),
}

impl PartProgress {
    pub fn new(rows: PartRows) -> Self {
        Self { rows, stage: PartStage::Iterating, iterates: Vec::new(), length: 1.0, loose: None, changes: 0 }
    }

    pub fn is_iterating(&self) -> bool {
        matches!(self.stage, PartStage::Iterating)
    }

    pub fn is_done(&self) -> bool {
        matches!(self.stage, PartStage::Done)
    }

    /// Records a failure; missing convergence at a singular tangent counts as missing support.
    pub fn fail(&mut self, failure: EquilibriumError) {
        self.stage = PartStage::Failed(match (failure, &self.loose) {
            (EquilibriumError::NoConvergence { factor, .. }, Some(dofs)) => {
                EquilibriumError::Unsupported { factor, dofs: dofs.clone() }
            }
            (other, _) => other,
        });
    }
}

impl<M: Model> Corrector<'_, M> {
    /// Iterates the unfinished parts to equilibrium; their kept rows may change. An error concerns the whole model.
    pub fn run(&mut self, x: &mut Unknowns) -> Result<(), EquilibriumError> {
        self.move_prescribed(x);
        loop {
            self.evaluate(x)?;
            let mut steps = Vec::new();
            for part in self.unbalanced()? {
                steps.extend(self.correction(part));
            }
            self.go(x, steps)?;
            self.move_prescribed(x);
            for part in self.iterating() {
                if self.all[part].iterates.len() > self.options.iterations {
                    self.fail_part(part, self.no_convergence(part), x);
                }
            }
            if !self.all.iter().any(|own| matches!(own.stage, PartStage::Iterating | PartStage::Ready(_))) {
                return Ok(());
            }
        }
    }

    pub fn iterating(&self) -> Vec<usize> {
        (0..self.all.len()).filter(|&part| self.all[part].is_iterating()).collect()
    }

    /// Evaluates everything at x, and records the residuals of each part that iterates.
    fn evaluate(&mut self, x: &mut Unknowns) -> Result<(), EquilibriumError> {
        for &part in &self.iterating() {
            let left_out = self.parts.list[part].rows.iter().filter(|&&r| !self.all[part].rows.kept(r));
            left_out.for_each(|&r| x.multipliers[r] = 0.0);
        }
        self.state.evaluate(self.model, self.set, x, &self.end.loads)?;
        self.state.finite_at(&self.end.prescribed)?;
        for part in self.iterating() {
            let found = self.state.finite(&self.parts.list[part]);
            found.unwrap_or_else(|failure| self.fail_part(part, failure, x));
        }
        let no_longer_falls = |part: &usize| {
            let last = self.all[*part].iterates.last();
            last.is_some_and(|last| self.constraint(*part) >= last.constraint)
        };
        let settled: Vec<usize> = self.iterating().into_iter().filter(no_longer_falls).collect();
        self.state.settle(self.set, self.parts, &settled)?;
        for part in self.iterating() {
            let force = self.state.force(&self.parts.list[part].free, self.options.tolerance);
            let (constraint, own) = (self.constraint(part), &mut self.all[part]);
            let (length, regularised) = (own.length, own.loose.is_some());
            own.iterates.push(EquilibriumIterate { force, constraint, length, regularised });
        }
        self.last_valid = Some(x.clone());
        Ok(())
    }

    /// The constraint residual of a part: the largest `eps |c_r| / rounding_r` of its kept rows, where `rounding_r` bounds the rounding of
    /// the constraint value c_r.
    fn constraint(&self, part: usize) -> f64 {
        f64::EPSILON * self.state.constraint(&self.all[part].rows.list)
    }

    /// The part fails and returns to the last configuration that could be evaluated.
    pub fn fail_part(&mut self, part: usize, failure: EquilibriumError, x: &mut Unknowns) {
        self.all[part].fail(failure);
        let Some(last_valid) = &self.last_valid else { return };
        let there = &self.parts.list[part];
        there.free.iter().for_each(|&j| x.u[j] = last_valid.u[j]);
        there.rows.iter().for_each(|&r| x.multipliers[r] = last_valid.multipliers[r]);
    }

    pub fn no_convergence(&self, part: usize) -> EquilibriumError {
        let EquilibriumIterate { force, constraint, .. } = self.all[part].iterates.last().copied().unwrap_or_default();
        EquilibriumError::NoConvergence { factor: 0.0, tried: self.end.factor, force, constraint }
    }

    /// The parts that need a correction. A converged part is done if its redundant rows hold. If they do not, the part gets the rows that
    /// are independent at the current configuration.
    fn unbalanced(&mut self) -> Result<Vec<usize>, EquilibriumError> {
        let (mut unbalanced, mut choice) = (Vec::new(), None);
        for part in self.iterating() {
            let last = self.all[part].iterates.last().copied().unwrap_or_default();
            let limit = f64::EPSILON * self.options.roundings;
            if self.awaits[part] || last.force > self.options.tolerance || last.constraint > limit {
                unbalanced.push(part);
            } else if self.all_hold(part) {
                self.all[part].stage = PartStage::Done;
            } else {
                if choice.is_none() {
                    choice = Some(self.choose()?);
                }
                choice.iter().for_each(|choice| self.renew(part, choice));
            }
        }
        Ok(unbalanced)
    }

    /// Whether all redundant rows of a part hold; the rounding of the rows that they depend on is allowed.
    fn all_hold(&self, part: usize) -> bool {
        let (limit, rows) = (self.options.roundings, &self.all[part].rows);
        let holds = |r: usize| self.state.constraints[r] <= limit || self.state.follows(r, rows.certificate(r), limit);
        self.parts.list[part].rows.iter().all(|&r| rows.kept(r) || holds(r))
    }

    /// Analyses the rows of all parts at the configuration that was evaluated last.
    fn choose(&self) -> Result<std::sync::Arc<RowChoice>, EquilibriumError> {
        let before = self.all.iter().flat_map(|own| own.rows.list.iter().copied()).collect();
        let place = (self.set, self.parts);
        RowChoice::new(place, &self.state.evaluation, &self.end.prescribed, (self.options, before))
    }

    /// Gives a part other rows. If they stay the same, the rows that do not hold are conflicting.
    fn renew(&mut self, part: usize, choice: &std::sync::Arc<RowChoice>) {
        let (all, own) = (&self.parts.list[part].rows, &mut self.all[part]);
        let rows = PartRows::new(all, choice);
        own.changes += 1;
        if rows.list != own.rows.list && own.changes <= CHANGES {
            own.rows = rows;
        } else {
            let violated = all.iter().filter(|&&r| self.state.constraints[r] > self.options.roundings);
            let labels = violated.filter_map(|&r| self.set.label(r).ok()).collect();
            own.fail(EquilibriumError::Conflict { factor: 0.0, labels });
        }
    }

    /// The correction of a part; none if its rows changed or it failed.
    fn correction(&mut self, part: usize) -> Option<Correction> {
        let before = self.all[part].rows.list.len();
        let (saddle, motion) = match self.regular_tangent(part) {
            Ok(found) => found,
            Err(failure) => {
                self.all[part].fail(failure);
                return None;
            }
        };
        let own = &mut self.all[part];
        if own.rows.list.len() != before {
            return None;
        }
        let only_multipliers = motion.is_some() && own.loose.is_none() && !own.rows.list.is_empty();
        own.loose = motion;
        let mut rhs = self.rhs(part);
        if only_multipliers {
            // The multipliers are to balance the forces, although the constraints do not hold yet: the constraint values c count as zero.
            rhs[self.parts.list[part].free.len()..].fill(0.0);
        }
        let dx = saddle.solve(&rhs);
        Some(Correction { part, saddle, dx, only_multipliers })
    }

    /// The right-hand side `-[r; c]`: residual forces r on the free DOFs of a part, and constraint values c of its kept rows. It includes
    /// the effect of prescribed DOFs that have yet to move.
    pub fn rhs(&self, part: usize) -> Vec<f64> {
        let (g, h, awaits) = (self.state.evaluation.g(), self.state.evaluation.h(), self.awaits[part]);
        let more = |start: f64, entries: &mut dyn Iterator<Item = (usize, f64)>| {
            if awaits { entries.fold(start, |sum, (j, v)| sum + v * self.ahead[j]) } else { start }
        };
        let stiffness = |i| self.state.moments_of(i).chain(self.state.assembly.row(i)).chain(h.row(i));
        let force = |&i: &usize| -more(self.state.residual[i], &mut stiffness(i));
        let c = |&r: &usize| -more(self.state.evaluation.c()[r], &mut g.row(r));
        self.parts.list[part].free.iter().map(force).chain(self.all[part].rows.list.iter().map(c)).collect()
    }

    /// Moves prescribed DOFs to their values as soon as all parts are ready, together with these parts.
    fn move_prescribed(&mut self, x: &mut Unknowns) {
        if self.iterating().into_iter().any(|part| self.awaits[part]) {
            return;
        }
        for part in 0..self.all.len() {
            if let PartStage::Ready(dx) = &self.all[part].stage {
                self.advance(x, part, dx, (1.0, 1.0));
                (self.all[part].stage, self.all[part].length) = (PartStage::Iterating, 1.0);
            }
        }
        self.end.prescribed.iter().for_each(|&(j, v)| x.u[j] = v);
        self.awaits.fill(false);
    }

    /// Moves a part along a correction dx: the DOFs by the fraction t of it, the multipliers by the fraction `of_multipliers`.
    pub fn advance(&self, x: &mut Unknowns, part: usize, dx: &[f64], (t, of_multipliers): (f64, f64)) {
        let free = &self.parts.list[part].free;
        free.iter().zip(dx).for_each(|(&j, dx)| x.u[j] += t * dx);
        let multipliers = self.all[part].rows.list.iter().zip(&dx[free.len()..]);
        multipliers.for_each(|(&r, dx)| x.multipliers[r] += of_multipliers * dx);
    }
}
