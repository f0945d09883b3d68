//! What a path knows of a part, and how a load step of all parts failed.

use super::super::branch::{Branch, Turn};
use super::super::correct::Progress;
use super::super::failure::{Failure, Reached};
use super::super::pattern::Pattern;
use super::super::stability::Stability;
use super::super::{EquilibriumError, Iterate};
use qless_constraints::ConstraintSet;

#[derive(Default)]
pub struct Track {
    /// Whether constraints that are not linear are made to move.
    pub driven: bool,
    pub branch: Option<Branch>,
    pub of_branch: Pattern,
    /// Of the last step.
    pub turn: Turn,
    /// The rank of the constraints where the last step started, if they hold there.
    pub rank: Option<usize>,
    pub stability: Option<Stability>,
    /// How many iterates it had in its last attempt.
    pub iterates: usize,
}

impl Track {
    /// Whether branches meet on the way, so that the rows there may be others.
    pub fn meets(&self, own: &Progress) -> bool {
        self.turn.met || self.rank.is_some_and(|rank| rank != own.rows.list().len())
    }
}

/// Why a load step failed: the whole model or some of its parts, in their order, with their last iterates.
pub struct Failures {
    whole: Option<Failure>,
    parts: Vec<(Failure, Iterate)>,
}

impl Failures {
    /// Nothing if all parts are where they should be.
    pub fn new(whole: Option<Failure>, all: Vec<Progress>) -> Result<Vec<Progress>, Self> {
        if whole.is_none() && all.iter().all(Progress::is_done) {
            return Ok(all);
        }
        let parts = all.into_iter().filter_map(Progress::into_failure).collect();
        Err(Self { whole, parts })
    }

    fn all(&self) -> impl Iterator<Item = &Failure> {
        self.whole.iter().chain(self.parts.iter().map(|(failure, _)| failure))
    }

    pub fn is_fatal(&self) -> bool {
        self.all().any(Failure::is_fatal)
    }

    /// The worst decides.
    pub fn shorter(&self) -> f64 {
        self.all().map(Failure::shorter).fold(1.0, f64::min)
    }

    /// What is said: what is fatal, else what is of the whole model, else what the first part says.
    pub fn into_error(self, set: &ConstraintSet, factor: f64, tried: f64) -> EquilibriumError {
        let whole = self.whole.into_iter().map(|failure| (failure, Iterate::default()));
        let mut list: Vec<_> = whole.chain(self.parts).collect();
        let first = list.iter().position(|(failure, _)| failure.is_fatal()).unwrap_or(0);
        let (failure, iterate) =
            if list.is_empty() { (Failure::NoConvergence, Iterate::default()) } else { list.swap_remove(first) };
        failure.into_error(set, Reached { factor, tried, iterate })
    }
}

impl From<Failure> for Failures {
    fn from(failure: Failure) -> Self {
        Self { whole: Some(failure), parts: Vec::new() }
    }
}

impl FromIterator<Failure> for Failures {
    fn from_iter<I: IntoIterator<Item = Failure>>(parts: I) -> Self {
        Self { whole: None, parts: parts.into_iter().map(|failure| (failure, Iterate::default())).collect() }
    }
}
