//! How far a part has come in a load step.

use super::super::rows::Rows;
use super::super::{Failure, Iterate};

pub struct Progress {
    pub rows: Rows,
    pub way: Way,
    pub iterates: Vec<Iterate>,
    /// How much of the last correction was gone.
    pub(super) length: f64,
    /// DOFs of a motion that nothing resists, at the last iterate.
    pub(super) loose: Option<Vec<usize>>,
    /// Times that the kept rows changed.
    pub(super) changes: usize,
}

/// What a part has to do next.
pub enum Way {
    /// To go on.
    Going,
    /// To take this correction, which moves its prescribed DOFs, once all others are ready for theirs: they may be the same.
    Ready(Vec<f64>),
    /// Nothing: it is in equilibrium, or has no part in this.
    Done,
    /// Nothing: it comes to none.
    Failed(Failure),
}

impl Progress {
    pub fn new(rows: Rows) -> Self {
        Self { rows, way: Way::Going, iterates: Vec::new(), length: 1.0, loose: None, changes: 0 }
    }

    pub fn is_going(&self) -> bool {
        matches!(self.way, Way::Going)
    }

    pub fn is_done(&self) -> bool {
        matches!(self.way, Way::Done)
    }

    /// Whether it failed in a way that another start may mend: not by leaving its branch.
    pub fn may_start_again(&self) -> bool {
        matches!(&self.way, Way::Failed(failure) if !matches!(failure, Failure::Branch(_)))
    }

    /// Whether it is still on its way.
    pub fn goes_on(&self) -> bool {
        matches!(self.way, Way::Going | Way::Ready(_))
    }

    /// Why it failed, and its last iterate.
    pub fn into_failure(self) -> Option<(Failure, Iterate)> {
        let last = self.iterates.last().copied().unwrap_or_default();
        if let Way::Failed(failure) = self.way { Some((failure, last)) } else { None }
    }

    /// Without convergence where the tangent is singular, that is the reason.
    pub fn fail(&mut self, failure: Failure) {
        self.way = Way::Failed(failure.or_unsupported(self.loose.as_ref()));
    }
}

/// The iterates of parts side by side: a part that has come to its end stays as it is.
pub fn side_by_side(parts: &[&[Iterate]]) -> Vec<Iterate> {
    let most = parts.iter().map(|iterates| iterates.len()).max().unwrap_or(0);
    let mut all = vec![Iterate { length: 1.0, ..Iterate::default() }; if parts.is_empty() { 1 } else { most }];
    for iterates in parts {
        let ended = iterates.last().map(|last| Iterate { length: 1.0, regularised: false, ..*last });
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
