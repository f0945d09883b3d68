//! The result of the analysis on each rank.

mod attempt;
mod run;

use qless::{Confidence, Kind};

use crate::parts::{Directory, Layout};
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
    /// Whether the DOF is prescribed (G), or a master (T).
    pub prescribed: bool,
}

/// How the work was distributed to this rank.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Dealt {
    /// Equations that this rank solved alone, by a DOF of no other equation.
    pub peeled: usize,
    /// Equations that this rank analysed, of any rank.
    pub analysed: usize,
    /// Equations that left this rank to be analysed.
    pub sent: usize,
    /// Attempts at the analysis: another one follows if an equation should not have been solved alone.
    pub attempts: usize,
}

/// The diagnosis, as one rank holds it: of its equations, and of the DOFs that it owns and needs.
#[derive(Clone, Debug)]
pub struct Analysis {
    pub(crate) layout: Layout,
    pub(crate) rank_of_job: usize,
    pub(crate) kinds: Vec<Kind>,
    pub(crate) dependent: Vec<DistributedDependent>,
    pub(crate) generated: Vec<(u64, f64)>,
    pub(crate) unmet_equations: Vec<usize>,
    pub(crate) confidence: Confidence,
    pub(crate) counts: Counts,
    pub(crate) slaves: Vec<u64>,
    pub(crate) lines: ReductionRows,
    pub(crate) needed: ReductionRows,
    pub(crate) directory: Directory,
    pub(crate) dealt: Dealt,
}

/// Of the whole job.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Counts {
    /// Equations.
    pub equations: u64,
    /// Those that are redundant.
    pub redundant: u64,
    /// Those that conflict.
    pub conflicting: u64,
    /// DOFs.
    pub dofs: u64,
}

impl Counts {
    /// Rank of the free part of C, which is the number of slaves.
    pub fn rank(&self) -> u64 {
        self.equations - self.redundant - self.conflicting
    }
}

impl Analysis {
    /// What each equation of this rank is, in the order in which they were given.
    pub fn kinds(&self) -> &[Kind] {
        &self.kinds
    }

    /// The redundant and conflicting equations of this rank, in that order.
    pub fn dependent(&self) -> &[DistributedDependent] {
        &self.dependent
    }

    /// Free DOFs that this rank owns and that the equations fix, and their values; ascending.
    pub fn generated(&self) -> &[(u64, f64)] {
        &self.generated
    }

    /// Equations of this rank that are wanted and dependent on other such equations only; ascending.
    pub fn unmet_equations(&self) -> &[usize] {
        &self.unmet_equations
    }

    /// How sure the rank of the whole is; the same on all ranks.
    pub fn confidence(&self) -> Confidence {
        self.confidence
    }

    /// The whole, counted; the same on all ranks.
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// How the work was distributed to this rank.
    pub fn dealt(&self) -> Dealt {
        self.dealt
    }

    /// The slaves that this rank owns, ascending.
    pub fn slaves(&self) -> &[u64] {
        &self.slaves
    }

    /// `u_dof = sum value u_j + g` of a slave that this rank owns or needs: its terms, ascending, and g. None for other DOFs.
    pub fn row(&self, dof: u64) -> Option<(Vec<Term>, f64)> {
        let line = self.line(dof)?;
        let term = |(&dof, &value): (&u64, &f64)| Term {
            dof: dof & !PRESCRIBED_BIT,
            value,
            prescribed: dof & PRESCRIBED_BIT != 0,
        };
        Some((line.dofs.iter().zip(line.values).map(term).collect(), line.constant))
    }

    pub(crate) fn line(&self, dof: u64) -> Option<ReductionRow<'_>> {
        self.lines.find(dof).or_else(|| self.needed.find(dof))
    }

    /// DOFs of other ranks in the rows of the slaves that this rank owns or needs; ascending.
    pub fn ghosts(&self) -> Vec<u64> {
        let own = self.layout.owned(self.rank_of_job);
        let rows = self.lines.iter().chain(self.needed.iter());
        let mut ghosts: Vec<u64> = rows.flat_map(|line| line.dofs.iter().map(|dof| dof & !PRESCRIBED_BIT)).collect();
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
