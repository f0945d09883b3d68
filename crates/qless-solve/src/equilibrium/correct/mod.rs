//! Newton's method at one load: `[K + H, G^T; G, 0] [du; lambda' - lambda] = -[r; c]`, with H of the current multipliers.
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

mod evaluate;
mod length;
mod tangent;

use qless_constraints::ConstraintSet;

use super::parts::EquilibriumParts;
use super::rows::PartRows;
use super::saddle::{Saddle, SaddlePattern};
use super::state::{EquilibriumState, Unknowns};
use super::{EquilibriumIterate, EquilibriumOptions, Model, StepFailure};

/// Most changes of the kept rows in one load step.
const CHANGES: usize = 4;

/// Matrix data of a part that the next load step reuses.
#[derive(Default)]
pub struct Factoring {
    /// Pattern of the last tangent.
    pub pattern: SaddlePattern,
    /// Whether scaling starts from the units of DOFs. This is necessary if displacements and rotations differ greatly in size.
    pub in_units: bool,
}

/// One load step of all parts.
pub struct Corrector<'a, M> {
    pub model: &'a mut M,
    pub set: &'a ConstraintSet,
    pub options: &'a EquilibriumOptions,
    pub loads: &'a [f64],
    /// DOFs and their values.
    pub prescribed: &'a [(usize, f64)],
    pub parts: &'a EquilibriumParts,
    pub state: &'a mut EquilibriumState,
    pub factoring: &'a mut [Factoring],
    pub all: &'a mut [PartProgress],
    /// The value of each prescribed DOF; none for free DOFs.
    pub goal: &'a [Option<f64>],
    /// The last configuration that could be evaluated; failed parts return to it.
    pub last_valid: Option<Unknowns>,
}

/// A correction of a part.
struct Correction {
    part: usize,
    saddle: Saddle,
    dx: Vec<f64>,
    /// Whether to change multipliers only, which may make the tangent regular, as for a chain without tension.
    only_multipliers: bool,
}

impl<M: Model> Corrector<'_, M> {
    /// Iterates the unfinished parts to equilibrium; their kept rows may change. An error concerns the whole model.
    pub fn run(&mut self, x: &mut Unknowns) -> Result<(), StepFailure> {
        self.move_prescribed(x);
        loop {
            self.evaluate_all(x)?;
            let iterating = self.unbalanced(x)?;
            let steps = self.steps(x, &iterating)?;
            let searches = self.starts(x, steps);
            self.go(x, searches)?;
            self.move_prescribed(x);
            self.stop_at_limit(x);
            if !self.all.iter().any(PartProgress::goes_on) {
                return Ok(());
            }
        }
    }

    /// The corrections of parts, except those whose rows changed.
    fn steps(&mut self, x: &Unknowns, iterating: &[usize]) -> Result<Vec<Correction>, StepFailure> {
        let lists: Vec<_> = iterating.iter().map(|&part| self.all[part].rows.list.clone()).collect();
        let before = |part: usize| iterating.binary_search(&part).ok().map(|place| &lists[place][..]);
        let mut steps = Vec::new();
        for (part, saddle, motion) in self.regular(iterating)? {
            if before(part) != Some(&self.all[part].rows.list[..]) {
                continue;
            }
            let own = &mut self.all[part];
            let only_multipliers = motion.is_some() && own.loose.is_none() && !own.rows.list.is_empty();
            own.loose = motion;
            let dx = saddle.solve(&self.rhs(part, x));
            steps.push(Correction { part, saddle, dx, only_multipliers });
        }
        Ok(steps)
    }

    /// `-F = -[r; c]` on free DOFs and kept rows of a part, including the effect of prescribed DOFs that have yet to move.
    fn rhs(&self, part: usize, x: &Unknowns) -> Vec<f64> {
        let (g, h) = (self.state.evaluation.g(), self.state.evaluation.h());
        let arrived = self.arrived(part, x);
        let more = |start: f64, entries: &mut dyn Iterator<Item = (usize, f64)>| {
            let held = entries.filter(|&(j, _)| self.goal[j].is_some());
            held.fold(start, |sum, (j, v)| sum + v * self.ahead(j, x))
        };
        let force = |&i: &usize| {
            let now = self.state.residual[i];
            if arrived {
                return now;
            }
            let of_loads = more(now, &mut self.state.moments_of(i));
            more(more(of_loads, &mut self.state.assembly.row(i)), &mut h.row(i))
        };
        let c = |&r: &usize| {
            let now = self.state.evaluation.c()[r];
            if arrived { now } else { more(now, &mut g.row(r)) }
        };
        let free = self.parts.list[part].free.iter().map(|j| -force(j));
        free.chain(self.all[part].rows.list.iter().map(|r| -c(r))).collect()
    }

    /// Remaining motion of a prescribed DOF; zero for free DOFs.
    fn ahead(&self, j: usize, x: &Unknowns) -> f64 {
        self.goal[j].map_or(0.0, |goal| goal - x.u[j])
    }

    /// Whether all prescribed DOFs of a part have their values.
    fn arrived(&self, part: usize, x: &Unknowns) -> bool {
        self.parts.list[part].prescribed.iter().all(|&j| self.goal[j] == Some(x.u[j]))
    }
}

pub struct PartProgress {
    pub rows: PartRows,
    pub stage: PartStage,
    pub iterates: Vec<EquilibriumIterate>,
    /// Length of the last step.
    pub(super) length: f64,
    /// DOFs of a motion without resistance, at the last iterate.
    pub(super) loose: Option<Vec<usize>>,
    /// Number of changes of the kept rows.
    pub(super) changes: usize,
}

/// The stage of a part's iteration.
pub enum PartStage {
    /// The part is iterated.
    Iterating,
    /// The part takes this correction as soon as all parts are ready to move their prescribed DOFs: parts may share these.
    Ready(Vec<f64>),
    /// The part is in equilibrium, or is not iterated in this attempt.
    Done,
    /// The part has failed.
    Failed(StepFailure),
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

    /// Whether the part failed in a way that another start may avoid; this excludes a part that left its branch.
    pub fn may_start_again(&self) -> bool {
        matches!(&self.stage, PartStage::Failed(failure) if !matches!(failure, StepFailure::Branch(_)))
    }

    /// Whether it is neither done nor failed.
    pub fn goes_on(&self) -> bool {
        matches!(self.stage, PartStage::Iterating | PartStage::Ready(_))
    }

    /// The reason of its failure, and its last iterate.
    pub fn into_failure(self) -> Option<(StepFailure, EquilibriumIterate)> {
        let last = self.iterates.last().copied().unwrap_or_default();
        if let PartStage::Failed(failure) = self.stage { Some((failure, last)) } else { None }
    }

    /// Records a failure; missing convergence at a singular tangent counts as missing support.
    pub fn fail(&mut self, failure: StepFailure) {
        self.stage = PartStage::Failed(failure.or_unsupported(self.loose.as_ref()));
    }
}

/// Merges the iterates of all parts; a part that has finished keeps its last iterate.
pub fn side_by_side(parts: &[&[EquilibriumIterate]]) -> Vec<EquilibriumIterate> {
    let most = parts.iter().map(|iterates| iterates.len()).max().unwrap_or(0);
    let mut all = vec![
        EquilibriumIterate { length: 1.0, ..EquilibriumIterate::default() };
        if parts.is_empty() { 1 } else { most }
    ];
    for iterates in parts {
        let ended = iterates.last().map(|last| EquilibriumIterate { length: 1.0, regularised: false, ..*last });
        let own = iterates.iter().copied().chain(ended.into_iter().cycle());
        all.iter_mut().zip(own).for_each(|(all, own)| {
            all.force = all.force.max(own.force);
            all.constraint = all.constraint.max(own.constraint);
            all.length = all.length.min(own.length);
            all.regularised |= own.regularised;
        });
    }
    all
}
