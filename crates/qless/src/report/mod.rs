//! `qless.report/3`: a diagnosis as plain data; with the feature `serde` it serializes to the JSON report.
//!
//! Rows and DOFs count from 1 here, as in Matrix Market files. `because` is an [`explanation`](crate::explanation): equations and
//! prescribed values with coefficients, whose combination is the dependent equation, or `u_s = value` for a fixed DOF.
//!
//! Explanations can be long: an equation that closes a ring of a million equations depends on all the others. So the total number of
//! members in a report is limited. Conflicts come first, then generated boundary conditions (at most half of the remaining members), then
//! redundant equations. If an explanation is omitted, `because` is empty and `because_omitted` is its number of members, or null if it was
//! not computed.

mod budget;
mod exact;
mod findings;
mod groups;
mod near_dependence;
mod repairs;
mod sizes;

use std::time::Duration;

use crate::diagnosis::PresolveStatistics;
use crate::{Analysis, Confidence, Effort, Form, Kind, Reduction};
use budget::Budget;
use sizes::{from_one, milliseconds};

pub use exact::{ExactDifference, ExactFinding, ProofFinding};
pub use findings::{
    Certificate, DependentEquation, GeneratedCondition, NoiseCoefficient, Omitted, OtherReadingFinding, Term,
};
pub use groups::{Group, PRESCRIBED};
pub use near_dependence::{NearDependenceFinding, NearEquation};
pub use repairs::{ChangeFinding, RepairFinding};
pub use sizes::{BackendUsed, Counts, FactoredSizes, InputSizes, Milliseconds, ReductionSizes, Unmet};

/// The verdict on a system: the worst kind of any equation, or incomplete if constraints were skipped and no equation conflicts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "lowercase"))]
#[non_exhaustive]
pub enum Status {
    /// All equations are independent.
    Independent,
    /// Some equations are combinations of others and consistent with them; none conflicts.
    Redundant,
    /// Some equations conflict with others, whether constraints were skipped or not.
    Conflicting,
    /// No equation conflicts, but some constraints were skipped, and these may conflict.
    Incomplete,
}

impl From<Kind> for Status {
    fn from(kind: Kind) -> Self {
        match kind {
            Kind::Independent => Self::Independent,
            Kind::Redundant => Self::Redundant,
            Kind::Conflicting => Self::Conflicting,
        }
    }
}

/// The diagnosis of a system with labels and 1-based numbers; values that are not finite serialize as null.
///
/// ```
/// use qless::report::Term;
/// use qless::{Options, Report, SystemBuilder, analyse};
/// let mut builder = SystemBuilder::new(2);
/// builder.labelled_equation("tie 7", [(0, 1.0), (1, -1.0)], 0.0);
/// builder.labelled_equation("tie 8", [(0, 2.0), (1, -2.0)], 0.0);
/// let system = builder.build()?;
/// let analysis = analyse(&system, &Options::default())?;
/// let report = Report::new(&analysis, Report::TERMS);
/// assert_eq!((report.rank, report.counts.redundant), (1, 1));
/// let last = &report.dependent[0];
/// let tie = Term::equation(1, "tie 7".to_owned(), 2.0);
/// assert_eq!((last.row, &last.certificate.because), (2, &vec![tie]));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Report {
    /// The version of the schema: [`Report::SCHEMA`].
    pub schema: &'static str,
    /// Sizes of the system.
    pub input: InputSizes,
    /// Conflicting if any equation is, else incomplete if constraints were skipped, else redundant if any equation is, else independent.
    pub status: Status,
    /// Rank of the free part of C.
    pub rank: usize,
    /// Number of equations of each kind.
    pub counts: Counts,
    /// Redundant and conflicting equations, ascending.
    pub dependent: Vec<DependentEquation>,
    /// The dependent equations by kind and origin, if explanations were requested; the key is absent if there are none.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Vec::is_empty"))]
    pub groups: Vec<Group>,
    /// Free DOFs that the equations fix, ascending.
    pub generated_boundary_conditions: Vec<GeneratedCondition>,
    /// The requested effort.
    pub effort: Effort,
    /// What the requested effort guarantees, in one sentence.
    pub promise: &'static str,
    /// How to cure the conflicts; the key is absent if there are none.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Vec::is_empty"))]
    pub repairs: Vec<RepairFinding>,
    /// The confidence in the rank.
    pub confidence: Confidence,
    /// Constraints that were skipped; the key is absent if there are none. The rest of the report is about the constraints that were read.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Vec::is_empty"))]
    pub incomplete: Vec<String>,
    /// The rank in exact arithmetic, with [`Effort::Exact`].
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub exact_rank: Option<ExactFinding>,
    /// How the verdict was proved, with [`Effort::Proved`] and [`Effort::Exact`].
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub proof: Option<ProofFinding>,
    /// Near-dependences: the rank that the user probably meant, if it is less than the rank of the typed numbers.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub meant: Option<NearDependenceFinding>,
    /// The reduced form, if it was computed.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub reduction: Option<ReductionSizes>,
    /// Preferences that are not satisfied; the key is absent if all are.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Unmet::is_empty"))]
    pub unmet_preferences: Unmet,
    /// Coefficients that count as zero, because they are rounding of others; the key is absent if there are none.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Vec::is_empty"))]
    pub noise: Vec<NoiseCoefficient>,
    /// Another rank or verdict, if numbers that may be rounding are read the other way.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub other_reading: Option<OtherReadingFinding>,
    /// Statistics of presolve, if they are known.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub presolve: Option<PresolveStatistics>,
    /// Number of MPI ranks, for an analysis over several.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub ranks: Option<usize>,
    /// The backend that factored the blocks.
    pub backend: BackendUsed,
    /// Times in milliseconds.
    pub timings_ms: Milliseconds,
}

impl Report {
    /// The version of the schema; it changes if a reader of the old version would fail.
    pub const SCHEMA: &'static str = "qless.report/3";

    /// Default limit of the terms of all certificates in a JSON report.
    pub const TERMS: usize = 1_000_000;

    /// Reports an analysis, with explanations of at most `terms` members in total.
    ///
    /// No explanation is computed after the limit is reached, except those computed together with the last one, so `terms` bounds the
    /// time too. For a generated boundary condition the cost of a factorization counts as terms. [`Report::with_reduction`] and
    /// [`Report::with_timings`] add the reduction and the other times.
    pub fn new(analysis: &Analysis, terms: usize) -> Self {
        let (system, times) = (analysis.system(), &analysis.timings);
        let sizes =
            InputSizes::new(system.equations(), system.dofs(), system.matrix().nnz(), system.prescribed().len());
        let count = |kind: Kind| analysis.kinds.iter().filter(|&&k| k == kind).count();
        let counts = Counts::new(count(Kind::Independent), count(Kind::Redundant), count(Kind::Conflicting));
        let (name, version) = &analysis.backend;
        let backend = BackendUsed::new(name, rayon::current_num_threads(), version.clone());
        let (dependent, generated_boundary_conditions) = Budget::new(analysis, terms).spend();
        let [presolve, factor, classify] = [times.presolve, times.factor, times.classify].map(milliseconds);
        Self {
            groups: if terms > 0 { Group::of_report(&dependent) } else { Vec::new() },
            dependent,
            generated_boundary_conditions,
            unmet_preferences: Unmet { equations: from_one(&analysis.unmet_equations), ..Unmet::default() },
            noise: analysis.noise.iter().map(NoiseCoefficient::new).collect(),
            other_reading: analysis.other.as_ref().map(OtherReadingFinding::new),
            proof: analysis.proof.as_ref().map(ProofFinding::new),
            exact_rank: analysis.exact.as_ref().map(|exact| ExactFinding::new(analysis, exact)),
            presolve: Some(analysis.presolve),
            ranks: None,
            timings_ms: Milliseconds {
                presolve,
                factor,
                classify,
                total: presolve + factor + classify,
                ..Milliseconds::default()
            },
            ..Self::of_ranks(1, sizes, counts, (analysis.options.effort, analysis.confidence), backend)
        }
    }

    /// Adds the sizes of the reduced form and its [`Analysis::residual`].
    #[must_use]
    pub fn with_reduction(mut self, reduction: &Reduction, residual: f64) -> Self {
        self.reduction = Some(ReductionSizes {
            slaves: reduction.slaves.len(),
            masters: reduction.masters.len(),
            growth: reduction.growth,
            residual,
            nnz: reduction.t.nnz() + reduction.g_matrix.nnz(),
            exchanges: reduction.exchanges,
            form: if reduction.is_explicit() { Form::Explicit } else { Form::Factored },
            factored: reduction
                .factored
                .iter()
                .map(|block| FactoredSizes {
                    equations: block.equations.len(),
                    slaves: block.slaves.len(),
                    masters: block.masters.len(),
                    nnz: block.nnz(),
                    predicted: block.predicted,
                })
                .collect(),
        });
        self.unmet_preferences.masters = from_one(&reduction.unmet_masters);
        self.unmet_preferences.slaves = from_one(&reduction.unmet_slaves);
        self
    }

    /// Sets the requested form of T in the report; without this call, the report names the actual form.
    #[must_use]
    pub fn with_form(mut self, form: Form) -> Self {
        self.reduction.iter_mut().for_each(|reduction| reduction.form = form);
        self
    }

    /// Adds the times of reading and reduction (zero if there was none), and the total time.
    #[must_use]
    pub fn with_timings(mut self, read: Duration, reduce: Duration, total: Duration) -> Self {
        let (read, reduce, total) = (milliseconds(read), milliseconds(reduce), milliseconds(total));
        self.timings_ms = Milliseconds { read, reduce, total, ..self.timings_ms };
        self
    }

    /// Adds descriptions of the constraints that were skipped.
    ///
    /// ```
    /// use qless::{Options, Report, Status, SystemBuilder, analyse};
    /// let mut builder = SystemBuilder::new(2);
    /// builder.equation([(0, 1.0), (1, -1.0)], 0.0);
    /// let analysis = analyse(&builder.build()?, &Options::default())?;
    /// let report = Report::new(&analysis, Report::TERMS);
    /// assert_eq!(report.status, Status::Independent);
    /// let report = report.with_left_out(vec!["line 7: RSPLINE is not read".to_owned()]);
    /// assert_eq!((report.status, report.counts.independent), (Status::Incomplete, 1));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn with_left_out(mut self, what: Vec<String>) -> Self {
        if !what.is_empty() && self.status != Status::Conflicting {
            self.status = Status::Incomplete;
        }
        self.incomplete = what;
        self
    }

    /// A report of an analysis over `ranks` MPI ranks, with empty lists and without statistics of presolve; the caller fills the lists.
    ///
    /// ```
    /// use qless::{Confidence, Effort, Kind, Report, Status, Tolerance};
    /// use qless::report::{BackendUsed, Certificate, Counts, DependentEquation, InputSizes, Term};
    /// let (input, counts) = (InputSizes::new(2, 3, 4, 0), Counts::new(1, 1, 0));
    /// let backend = BackendUsed::new("faer", 1, "faer 0.24".to_owned());
    /// let certainty = (Effort::Checked, Confidence::of(1.0, 0.0, Tolerance::Relative(1e-10), None));
    /// let mut report = Report::of_ranks(2, input, counts, certainty, backend);
    /// let because = Certificate::complete(vec![Term::equation(1, "tie 7".to_owned(), 2.0)]);
    /// report.dependent.push(DependentEquation::new(2, "tie 8".to_owned(), Kind::Redundant, 0.0, because));
    /// assert_eq!((report.rank, report.status, report.ranks), (1, Status::Redundant, Some(2)));
    /// ```
    pub fn of_ranks(
        ranks: usize,
        input: InputSizes,
        counts: Counts,
        (effort, confidence): (Effort, Confidence),
        backend: BackendUsed,
    ) -> Self {
        Self {
            schema: Self::SCHEMA,
            input,
            status: counts.status(),
            rank: counts.independent,
            counts,
            dependent: Vec::new(),
            groups: Vec::new(),
            generated_boundary_conditions: Vec::new(),
            effort,
            promise: effort.promise(),
            repairs: Vec::new(),
            confidence,
            incomplete: Vec::new(),
            exact_rank: None,
            proof: None,
            meant: None,
            reduction: None,
            unmet_preferences: Unmet::default(),
            noise: Vec::new(),
            other_reading: None,
            presolve: None,
            ranks: Some(ranks),
            backend,
            timings_ms: Milliseconds::default(),
        }
    }
}
