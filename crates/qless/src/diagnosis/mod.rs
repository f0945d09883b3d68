//! The diagnosis of a constraint system, and the questions that it answers afterwards.

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
pub(crate) mod hidden_conflicts;
mod near_dependence;
pub(crate) mod nullspace_probe;
mod pass_result;
mod peel;
mod preferred_equations;
pub(crate) mod proof;
mod readings;
pub(crate) mod refined;

use std::sync::OnceLock;
use std::time::Duration;

use crate::common::identity::Identity;
use crate::factor::backend::BackendError;
use crate::factor::block::Block;
use crate::input::components::Labels;
use crate::input::incidence::Incidence;
use crate::input::numbering::{LocalSystem, Numbering};
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

/// Why an analysis failed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AnalysisError {
    /// A setting is out of its range.
    #[error(transparent)]
    Option(#[from] OptionError),
    /// The backend failed.
    #[error(transparent)]
    Backend(#[from] BackendError),
    /// Exact arithmetic exceeded its limit.
    #[error(transparent)]
    Exact(#[from] ExactError),
    /// All coefficients of an equation are below 2.2e-308, where doubles lose digits.
    #[error(
        "row {row}: its coefficients are all below 2.2e-308, where numbers lose their digits; rescale the equation"
    )]
    Subnormal {
        /// The equation with the small coefficients, 0-based.
        row: usize,
    },
    /// Numbers are so large or so small that the scaled right-hand side leaves the range of doubles.
    #[error(
        "row {row}: its right-hand side is too large for its coefficients (ratio beyond 1e308); rescale the equation"
    )]
    Range {
        /// The equation with the large right-hand side, 0-based.
        row: usize,
    },
}

/// The sizes before and after presolve.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct PresolveStatistics {
    /// Equations removed with a DOF that occurs in no other equation (column singletons).
    pub rows_removed_by_column_singletons: usize,
    /// Equations removed by elimination with little fill (row singletons, two-term rows, DOFs in few rows).
    pub rows_removed_by_elimination: usize,
    /// Equations found dependent before any factorization (empty rows included).
    pub rows_found_dependent: usize,
    /// Equations that remain for the backend.
    pub core_rows: usize,
    /// Free DOFs in the equations that remain for the backend.
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
    /// Time of scaling and presolve.
    pub presolve: Duration,
    /// Time of the backend and of all computations with its factors.
    pub factor: Duration,
    /// Time of classification and of generated boundary conditions.
    pub classify: Duration,
}

/// The diagnosis of a constraint system. It keeps the system, so all later results belong to this system.
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
    /// For each row of the basis, a bound of the row of T ([`nullspace_probe::NullspaceProbe::bounds`]).
    pub(crate) bounds: Vec<f64>,
    pub(crate) blocks: Vec<Block>,
    pub(crate) history: History,
    pub(crate) scaling: Scaling,
    pub(crate) numbering: Numbering,
    /// Local numbers of the fixed DOFs, which [`Analysis::generated`] lists by the user's numbers.
    pub(crate) fixed: Vec<u32>,
    times: OnceLock<Vec<u32>>,
    /// The equations of each DOF, computed when an explanation needs them.
    pub(crate) incidence: OnceLock<Incidence>,
    /// The components, found when an explanation or a repair needs them.
    labels: OnceLock<Labels>,
    /// One equation of each core of kept equations, and the distance of the core from dependence.
    pub(crate) distances: Vec<(u32, f64)>,
    /// For each component, the least of the distances of its cores.
    distance_of_label: OnceLock<Vec<f64>>,
    /// The basis, extended by the blocks: each block is solved for its slaves, and these relations become rows. The first call that needs
    /// them computes them.
    pub(crate) solved: OnceLock<Basis>,
}

/// Prints sizes and verdict, because the factors would fill pages.
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

    /// The analysed system, without the coefficients that count as zero ([`Analysis::noise`]).
    pub fn system(&self) -> &ConstraintSystem {
        &self.system
    }

    /// The verdict on each equation; length m.
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

    /// Equations of [`crate::Preferences::equations`] that depend on other such equations only, ascending.
    pub fn unmet_equations(&self) -> &[usize] {
        &self.unmet_equations
    }

    /// The certainty of the rank.
    pub fn confidence(&self) -> Confidence {
        self.confidence
    }

    /// Coefficients that count as zero by [`Options::noise`], ascending by row; [`Analysis::system`] does not contain them.
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

    /// Upper bound of the probability that [`Analysis::exact_rank`] is wrong: 0 if certificates prove the same rank, else
    /// [`ExactRank::error_chance`].
    pub fn exact_error_chance(&self) -> Option<f64> {
        let (exact, proof) = (self.exact.as_ref()?, self.proof.as_ref()?);
        let is_certain = exact.rank == self.rank() && proof.exact == self.dependent.len();
        Some(if is_certain { 0.0 } else { exact.error_chance() })
    }

    /// How the verdict was proved, with [`crate::Effort::Proved`] and [`crate::Effort::Exact`].
    pub fn proof(&self) -> Option<&Proof> {
        self.proof.as_ref()
    }

    /// Statistics of presolve.
    pub fn presolve(&self) -> PresolveStatistics {
        self.presolve
    }

    /// The time spent in each stage.
    pub fn timings(&self) -> Timings {
        self.timings
    }

    /// Name and version of the backend.
    pub fn backend(&self) -> (&'static str, &str) {
        (self.backend.0, &self.backend.1)
    }

    /// The dependent equation in this row, if there is one.
    pub(crate) fn dependent_of(&self, row: usize) -> Option<&Dependent> {
        self.dependent.binary_search_by_key(&row, |d| d.row).ok().map(|place| &self.dependent[place])
    }

    /// The system in local numbers.
    pub(crate) fn local(&self) -> LocalSystem<'_> {
        self.numbering.view(&self.system, self.system.rhs())
    }

    /// The component of each equation.
    pub(crate) fn labels(&self) -> &Labels {
        self.labels.get_or_init(|| Labels::of(self.local()))
    }

    /// The distance of the kept equations in the component of a row from dependence.
    pub(crate) fn distance_near(&self, row: usize) -> f64 {
        if self.distances.is_empty() {
            return 1.0;
        }
        let least = self.distance_of_label.get_or_init(|| distance::least_distances(self.labels(), &self.distances));
        least[self.labels().of_row[row] as usize]
    }

    pub(crate) fn independent(&self) -> Vec<bool> {
        self.kinds.iter().map(|&kind| kind == Kind::Independent).collect()
    }
}
