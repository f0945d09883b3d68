//! The result of the analysis on each rank.

mod attempt;
mod run;

use qless::{Confidence, Kind};

use crate::components::{Directory, Layout};
use crate::solve::{PRESCRIBED_BIT, ReductionRow, ReductionRows};

use crate::solve::DistributedDependent;
pub use run::analyse;

/// One term of a row of T or G.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Term {
    /// The DOF of the job.
    pub dof: u64,
    /// The coefficient.
    pub value: f64,
    /// Whether the DOF is prescribed (term of G) or a master (term of T).
    pub prescribed: bool,
}

/// How much work this rank did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct WorkCounts {
    /// Number of equations of this rank that were peeled: solved for a DOF that occurs in no other equation.
    pub peeled: usize,
    /// Number of equations that this rank analysed, whichever rank they come from.
    pub analysed: usize,
    /// Number of equations of this rank that other ranks analysed.
    pub sent: usize,
    /// Number of attempts at the analysis. Another attempt follows if an equation should not have been peeled.
    pub attempts: usize,
}

/// The diagnosis on one rank: results for its equations, and for the DOFs that it owns and needs.
#[derive(Clone, Debug)]
pub struct Analysis {
    pub(crate) layout: Layout,
    pub(crate) rank_of_job: usize,
    pub(crate) kinds: Vec<Kind>,
    pub(crate) dependent: Vec<DistributedDependent>,
    pub(crate) generated: Vec<(u64, f64)>,
    pub(crate) unmet_equations: Vec<usize>,
    pub(crate) confidence: Confidence,
    pub(crate) counts: JobCounts,
    pub(crate) slaves: Vec<u64>,
    pub(crate) reduction: ReductionRows,
    pub(crate) needed: ReductionRows,
    pub(crate) directory: Directory,
    pub(crate) work: WorkCounts,
}

/// Numbers of equations and DOFs of the whole job.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct JobCounts {
    /// Number of equations.
    pub equations: u64,
    /// Number of redundant equations.
    pub redundant: u64,
    /// Number of conflicting equations.
    pub conflicting: u64,
    /// Number of DOFs.
    pub dofs: u64,
}

impl JobCounts {
    /// The rank of C, restricted to its free DOFs. It is the number of slaves.
    pub fn rank(&self) -> u64 {
        self.equations - self.redundant - self.conflicting
    }
}

impl Analysis {
    /// The kind of each equation of this rank, in the order of its share.
    pub fn kinds(&self) -> &[Kind] {
        &self.kinds
    }

    /// The redundant and conflicting equations of this rank, in the order of its share.
    pub fn dependent(&self) -> &[DistributedDependent] {
        &self.dependent
    }

    /// Free DOFs that this rank owns and that the equations fix, and their values; ascending.
    pub fn generated(&self) -> &[(u64, f64)] {
        &self.generated
    }

    /// Preferred equations ([`qless::Preferences`]) of this rank that depend on other preferred equations only; ascending.
    pub fn unmet_equations(&self) -> &[usize] {
        &self.unmet_equations
    }

    /// The confidence in the rank of the whole system; the same on all ranks.
    pub fn confidence(&self) -> Confidence {
        self.confidence
    }

    /// Numbers of equations and DOFs of the whole job; the same on all ranks.
    pub fn counts(&self) -> JobCounts {
        self.counts
    }

    /// How much work this rank did.
    pub fn work(&self) -> WorkCounts {
        self.work
    }

    /// The slaves that this rank owns, ascending.
    pub fn slaves(&self) -> &[u64] {
        &self.slaves
    }

    /// `u_dof = sum value u_j + g` of a slave that this rank owns or needs: its terms, ascending, and g. None for other DOFs.
    pub fn row(&self, dof: u64) -> Option<(Vec<Term>, f64)> {
        let row = self.reduction_row(dof)?;
        let term = |(&dof, &value): (&u64, &f64)| Term {
            dof: dof & !PRESCRIBED_BIT,
            value,
            prescribed: dof & PRESCRIBED_BIT != 0,
        };
        Some((row.dofs.iter().zip(row.values).map(term).collect(), row.constant))
    }

    pub(crate) fn reduction_row(&self, dof: u64) -> Option<ReductionRow<'_>> {
        self.reduction.find(dof).or_else(|| self.needed.find(dof))
    }

    /// DOFs of other ranks in the rows of the slaves that this rank owns or needs; ascending.
    pub fn ghosts(&self) -> Vec<u64> {
        let own = self.layout.owned(self.rank_of_job);
        let rows = self.reduction.iter().chain(self.needed.iter());
        let mut ghosts: Vec<u64> = rows.flat_map(|row| row.dofs.iter().map(|dof| dof & !PRESCRIBED_BIT)).collect();
        ghosts.retain(|dof| !own.contains(dof));
        ghosts.sort_unstable();
        ghosts.dedup();
        ghosts
    }

    /// Values of the prescribed DOFs that this rank owns, ascending by DOF.
    pub fn prescribed(&self) -> impl Iterator<Item = (u64, f64)> + '_ {
        self.directory.prescribed.iter().map(|(&dof, &value)| (dof, value))
    }
}
