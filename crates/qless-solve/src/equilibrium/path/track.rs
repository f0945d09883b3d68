//! State of each part along a load path, and the failures of a load step.

use qless_constraints::ConstraintSet;

use super::super::branch::{Branch, BranchCheck};
use super::super::correct::PartProgress;
use super::super::error::{Reached, StepFailure};
use super::super::saddle::SaddlePattern;
use super::super::stability::Stability;
use super::super::{EquilibriumError, EquilibriumIterate};

#[derive(Default)]
pub struct PartTrack {
    /// Whether time or prescribed DOFs move nonlinear constraints of the part.
    pub driven: bool,
    pub branch: Option<Branch>,
    pub of_branch: SaddlePattern,
    /// Result of the branch check of the last step.
    pub branch_check: BranchCheck,
    /// Number of independent rows at the start of the last step, if the constraints hold there.
    pub rank: Option<usize>,
    pub stability: Option<Stability>,
    /// Number of iterates in the last attempt.
    pub iterates: usize,
}

impl PartTrack {
    /// Whether branches meet on the way, or the rank changed.
    pub fn branches_meet(&self, own: &PartProgress) -> bool {
        self.branch_check.met || self.rank.is_some_and(|rank| rank != own.rows.list.len())
    }
}

/// Failures of a load step: of the whole model or of some parts, in order, with their last iterates.
pub struct StepFailures {
    whole: Option<StepFailure>,
    parts: Vec<(StepFailure, EquilibriumIterate)>,
}

impl StepFailures {
    /// The progress of all parts if all are done; otherwise the failures.
    pub fn new(whole: Option<StepFailure>, all: Vec<PartProgress>) -> Result<Vec<PartProgress>, Self> {
        if whole.is_none() && all.iter().all(PartProgress::is_done) {
            return Ok(all);
        }
        let parts = all.into_iter().filter_map(PartProgress::into_failure).collect();
        Err(Self { whole, parts })
    }

    fn all(&self) -> impl Iterator<Item = &StepFailure> {
        self.whole.iter().chain(self.parts.iter().map(|(failure, _)| failure))
    }

    pub fn is_fatal(&self) -> bool {
        self.all().any(StepFailure::is_fatal)
    }

    /// Length of the next attempt: the shortest that any failure asks for.
    pub fn shorter(&self) -> f64 {
        self.all().map(StepFailure::shorter).fold(1.0, f64::min)
    }

    /// The most important failure as an error: a fatal one, else that of the whole model, else that of the first part.
    pub fn into_error(self, set: &ConstraintSet, factor: f64, tried: f64) -> EquilibriumError {
        let whole = self.whole.into_iter().map(|failure| (failure, EquilibriumIterate::default()));
        let mut list: Vec<_> = whole.chain(self.parts).collect();
        let first = list.iter().position(|(failure, _)| failure.is_fatal()).unwrap_or(0);
        let (failure, iterate) = if list.is_empty() {
            (StepFailure::NoConvergence, EquilibriumIterate::default())
        } else {
            list.swap_remove(first)
        };
        failure.into_error(set, Reached { factor, tried, iterate })
    }
}

impl From<StepFailure> for StepFailures {
    fn from(failure: StepFailure) -> Self {
        Self { whole: Some(failure), parts: Vec::new() }
    }
}

impl FromIterator<StepFailure> for StepFailures {
    fn from_iter<I: IntoIterator<Item = StepFailure>>(parts: I) -> Self {
        Self { whole: None, parts: parts.into_iter().map(|failure| (failure, EquilibriumIterate::default())).collect() }
    }
}
