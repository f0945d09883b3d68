//! What an analysis says of a constraint system, and what can be asked of it afterwards.

mod analyse;
mod because;
pub(crate) mod certificate;
pub(crate) mod classify;
pub(crate) mod confidence;
mod consistent;
mod core;
mod distance;
pub mod exact;
pub(crate) mod generated;
mod near_dependence;
pub(crate) mod nullspace_probe;
mod pass_result;
mod preferred_equations;
mod proof;
mod readings;

use std::sync::OnceLock;
use std::time::Duration;

use crate::common::identity::Identity;
use crate::factor::backend::BackendError;
use crate::factor::block::Block;
use crate::input::incidence::Incidence;
use crate::input::numbering::Numbering;
use crate::input::scale::Scaling;
use crate::presolve::basis::Basis;
use crate::{ConstraintSystem, OptionError, Options};
use certificate::History;
use classify::{Dependent, Kind};
use confidence::Confidence;
use exact::{ExactError, ExactRank};

pub use crate::input::noise::NoiseTerm;
pub use near_dependence::{NearDependence, NearDependent};
pub use proof::Proof;
pub(crate) use readings::analysed_parts;
pub use readings::{OtherReading, analyse};

/// Why an analysis could not be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AnalysisError {
    /// A setting out of its range.
    #[error(transparent)]
    Option(#[from] OptionError),
    /// The backend failed.
    #[error(transparent)]
    Backend(#[from] BackendError),
    /// Exact arithmetic was given up.
    #[error(transparent)]
    Exact(#[from] ExactError),
    /// An equation whose coefficients are all below 2.2e-308, where doubles lose their digits.
    #[error(
        "row {row}: its coefficients are all below 2.2e-308, where numbers lose their digits; rescale the equation"
    )]
    Subnormal {
        /// The equation, 0-based.
        row: usize,
    },
    /// Numbers so large or so small that the scaled right-hand side leaves the range of doubles.
    #[error(
        "row {row}: its right-hand side is too large for its coefficients (ratio beyond 1e308); rescale the equation"
    )]
    Range {
        /// The equation, 0-based.
        row: usize,
    },
}

/// How much work presolve saved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct PresolveStatistics {
    /// Equations taken out with a DOF that occurs in no other (column singletons).
    pub rows_removed_by_column_singletons: usize,
    /// Equations taken out by elimination without fill (row singletons, two-term rows, DOFs in two rows).
    pub rows_removed_by_elimination: usize,
    /// Equations found dependent before any factorization (empty rows included).
    pub rows_found_dependent: usize,
    /// Equations left for the backend.
    pub core_rows: usize,
    /// Free DOFs in them.
    pub core_dofs: usize,
    /// Number of blocks.
    pub blocks: usize,
    /// Rows of the largest block.
    pub largest_block: usize,
}

/// Time spent in each stage.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Timings {
    /// Scaling and presolve.
    pub presolve: Duration,
    /// The backend, with everything that follows from its factors.
    pub factor: Duration,
    /// Classification and generated boundary conditions.
    pub classify: Duration,
}

/// The diagnosis of a constraint system, which it keeps: all that it is asked for is of that system, and of no other.
pub struct Analysis {
    pub(crate) identity: Identity,
    pub(crate) system: ConstraintSystem,
    pub(crate) kinds: Vec<Kind>,
    pub(crate) dependent: Vec<Dependent>,
    pub(crate) generated: Vec<(usize, f64)>,
    pub(crate) unmet_equations: Vec<usize>,
    pub(crate) confidence: Confidence,
    pub(crate) noise: Vec<NoiseTerm>,
    pub(crate) other: Option<OtherReading>,
    pub(crate) exact: Option<ExactRank>,
    pub(crate) proof: Option<Proof>,
    pub(crate) presolve: PresolveStatistics,
    pub(crate) timings: Timings,
    pub(crate) backend: (&'static str, String),
    pub(crate) options: Options,
    pub(crate) basis: Basis,
    /// Of the rows of T, as [`nullspace_probe::NullspaceProbe::bounds`] has them.
    pub(crate) bounds: Vec<f64>,
    pub(crate) blocks: Vec<Block>,
    pub(crate) history: History,
    pub(crate) scaling: Scaling,
    /// b as analysed, less what equations that were given up for others contradict.
    pub(crate) rhs: Vec<f64>,
    pub(crate) numbering: Numbering,
    /// Local numbers of [`Analysis::generated`].
    pub(crate) fixed: Vec<u32>,
    times: OnceLock<Vec<u32>>,
    /// The equations of each DOF, made when an explanation is wanted.
    pub(crate) incidence: OnceLock<Incidence>,
    /// The basis with the rows of the blocks, made when they are wanted.
    pub(crate) solved: OnceLock<Basis>,
}

/// Sizes and verdict: the factors would fill pages.
impl std::fmt::Debug for Analysis {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut text = f.debug_struct("Analysis");
        text.field("equations", &self.kinds.len()).field("rank", &self.rank());
        text.field("dependent", &self.dependent.len()).field("confidence", &self.confidence);
        text.finish_non_exhaustive()
    }
}

impl Analysis {
    /// Rank of the free part of C, which is the number of slaves.
    pub fn rank(&self) -> usize {
        self.basis.rank()
    }

    /// The system as it was read: without the coefficients of [`Analysis::noise`].
    pub fn system(&self) -> &ConstraintSystem {
        &self.system
    }

    /// What each equation is; length m.
    pub fn kinds(&self) -> &[Kind] {
        &self.kinds
    }

    /// Redundant and conflicting equations, ascending by row.
    pub fn dependent(&self) -> &[Dependent] {
        &self.dependent
    }

    /// Free DOFs that the equations fix, and their values; ascending.
    pub fn generated(&self) -> &[(usize, f64)] {
        &self.generated
    }

    /// Equations of [`crate::Preferences::equations`] that are dependent on other such equations only, ascending.
    pub fn unmet_equations(&self) -> &[usize] {
        &self.unmet_equations
    }

    /// How sure the rank is.
    pub fn confidence(&self) -> Confidence {
        self.confidence
    }

    /// Coefficients that count as zero by [`Options::noise`], ascending by row; [`Analysis::system`] is without them.
    pub fn noise(&self) -> &[NoiseTerm] {
        &self.noise
    }

    /// Another rank or verdict, if numbers that may be rounding are read the other way.
    pub fn other_reading(&self) -> Option<&OtherReading> {
        self.other.as_ref()
    }

    /// The rank in exact arithmetic, with [`crate::Effort::Exact`].
    pub fn exact_rank(&self) -> Option<&ExactRank> {
        self.exact.as_ref()
    }

    /// The chance that [`Analysis::exact_rank`] is wrong: 0 if certificates prove the same rank from above, else what two primes leave.
    pub fn exact_error_chance(&self) -> Option<f64> {
        let (exact, proof) = (self.exact.as_ref()?, self.proof.as_ref()?);
        let is_certain = exact.rank == self.rank() && proof.exact == self.dependent.len();
        Some(if is_certain { 0.0 } else { exact.error_chance() })
    }

    /// How the verdict was proved, with [`crate::Effort::Proved`] and [`crate::Effort::Exact`].
    pub fn proof(&self) -> Option<&Proof> {
        self.proof.as_ref()
    }

    /// What presolve did.
    pub fn presolve(&self) -> PresolveStatistics {
        self.presolve
    }

    /// Time spent.
    pub fn timings(&self) -> Timings {
        self.timings
    }

    /// Name and version of the backend.
    pub fn backend(&self) -> (&'static str, &str) {
        (self.backend.0, &self.backend.1)
    }

    /// What is known of an equation if it is dependent.
    pub(crate) fn dependent_of(&self, row: usize) -> Option<&Dependent> {
        self.dependent.binary_search_by_key(&row, |d| d.row).ok().map(|place| &self.dependent[place])
    }

    pub(crate) fn independent(&self) -> Vec<bool> {
        self.kinds.iter().map(|&kind| kind == Kind::Independent).collect()
    }
}
