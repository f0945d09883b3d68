//! `qless.report/2`: a diagnosis as one plain value; with the feature `serde` it serializes to the JSON object that scripts read.
//!
//! Rows and DOFs count from 1 here, as in Matrix Market files. `because` lists kept equations whose combination with
//! the given coefficients is the dependent equation on the free DOFs (or the fixed DOF itself):
//! `row_k = sum_i coefficient_i row_i`.
//!
//! Certificates can be long: that of the equation which closes a ring of a million names all the others. A report
//! therefore spends a limited number of terms, first on conflicts, then on generated boundary conditions (at most
//! half of what is left), then on redundant equations. Where a certificate is left out, `because` is empty and
//! `because_omitted` holds its number of terms, or null if it was not computed.

mod budget;
mod exact;
mod findings;
mod near_dependence;
mod sizes;

use std::time::Duration;

use crate::diagnosis::PresolveStatistics;
use crate::{Analysis, Confidence, Form, Kind, Reduction};
use budget::Budget;
use sizes::{from_one, milliseconds};

pub use exact::{ExactDifference, ExactFinding};
pub use findings::{Certificate, DependentEquation, GeneratedCondition, IgnoredCoefficient, Omitted, Term};
pub use near_dependence::{NearDependenceFinding, NearEquation};
pub use sizes::{BackendUsed, Counts, FactoredSizes, InputSizes, Milliseconds, ReductionSizes, Unmet};

/// The worst that is said of any equation, or that not all of them are known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "lowercase"))]
#[non_exhaustive]
pub enum Status {
    /// All equations are independent.
    Independent,
    /// Some are combinations of others, and consistent with them.
    Redundant,
    /// Some contradict others: so they do whatever was left out.
    Conflicting,
    /// No conflict was found, but something that constrains was left out, with which there may be one.
    Incomplete,
}

/// The diagnosis of a system, 1-based, with labels; numbers that are not finite serialize as null.
///
/// ```
/// use qless::{Options, Report, SystemBuilder, analyse};
/// let mut builder = SystemBuilder::new(2);
/// builder.labelled_equation("tie 7", [(0, 1.0), (1, -1.0)], 0.0);
/// builder.labelled_equation("tie 8", [(0, 2.0), (1, -2.0)], 0.0);
/// let system = builder.build()?;
/// let analysis = analyse(&system, &Options::default())?;
/// let report = Report::new(&analysis, Report::TERMS);
/// assert_eq!((report.rank, report.counts.redundant), (1, 1));
/// let last = &report.dependent[0];
/// let term = &last.certificate.because[0];
/// assert_eq!((last.row, term.label.as_str(), term.coefficient), (2, "tie 7", 2.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Report {
    /// [`Report::SCHEMA`].
    pub schema: &'static str,
    /// Sizes of what was diagnosed.
    pub input: InputSizes,
    /// Conflicting if any equation is, else incomplete if anything was left out, else redundant if any equation is, else independent.
    pub status: Status,
    /// Rank of the free part of C.
    pub rank: usize,
    /// Equations of each kind.
    pub counts: Counts,
    /// Redundant and conflicting equations, ascending.
    pub dependent: Vec<DependentEquation>,
    /// Free DOFs that the equations fix, ascending.
    pub generated_boundary_conditions: Vec<GeneratedCondition>,
    /// How sure the rank is.
    pub confidence: Confidence,
    /// What constrains and was left out of C; left out where there is nothing. All else holds of what was read.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Vec::is_empty"))]
    pub incomplete: Vec<String>,
    /// The rank in exact arithmetic, where it was taken.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub exact_rank: Option<ExactFinding>,
    /// The rank as probably meant, where that is less than as typed.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub meant: Option<NearDependenceFinding>,
    /// The reduced form, where it was computed.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub reduction: Option<ReductionSizes>,
    /// Preferences that the equations do not allow; left out where all are met.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Unmet::is_empty"))]
    pub unmet_preferences: Unmet,
    /// Coefficients that are rounding of their equations, from which nothing was concluded; left out where there are none.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Vec::is_empty"))]
    pub ignored_coefficients: Vec<IgnoredCoefficient>,
    /// What needed no factorization, where that is known.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub presolve: Option<PresolveStatistics>,
    /// Ranks that analysed it together, if there were several.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub ranks: Option<usize>,
    /// What factored the rest.
    pub backend: BackendUsed,
    /// Time spent, in milliseconds.
    pub timings_ms: Milliseconds,
}

impl Report {
    /// The version of the form; it changes when a reader of the old form would fail.
    pub const SCHEMA: &'static str = "qless.report/2";

    /// Terms of certificates that a JSON report spends unless told otherwise.
    pub const TERMS: usize = 1_000_000;

    /// Reports an analysis, with certificates of at most `terms` terms in total.
    ///
    /// No certificate is computed after the limit is reached, so `terms` bounds the time as well; one for a generated
    /// boundary condition counts for the factorization that it may take. Reading and reduction are not in it yet:
    /// see [`Report::with_reduction`] and [`Report::with_timings`].
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
        let ignored = analysis.ignored.iter();
        Self {
            dependent,
            generated_boundary_conditions,
            unmet_preferences: Unmet { equations: from_one(&analysis.unmet_equations), ..Unmet::default() },
            ignored_coefficients: ignored
                .map(|i| IgnoredCoefficient { row: i.row + 1, dof: i.dof + 1, coefficient: i.coefficient })
                .collect(),
            presolve: Some(analysis.presolve),
            ranks: None,
            timings_ms: Milliseconds {
                presolve,
                factor,
                classify,
                total: presolve + factor + classify,
                ..Milliseconds::default()
            },
            ..Self::of_ranks(1, sizes, counts, analysis.confidence, backend)
        }
    }

    /// Adds what is to be said of the reduced form; `residual` is that of [`Analysis::residual`].
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

    /// Says in which form the reduction was asked for; else it is the form that it has.
    #[must_use]
    pub fn with_form(mut self, form: Form) -> Self {
        self.reduction.iter_mut().for_each(|reduction| reduction.form = form);
        self
    }

    /// Adds the times that only the caller knows: reading, reduction (zero if there was none) and all together.
    #[must_use]
    pub fn with_timings(mut self, read: Duration, reduce: Duration, total: Duration) -> Self {
        let (read, reduce, total) = (milliseconds(read), milliseconds(reduce), milliseconds(total));
        self.timings_ms = Milliseconds { read, reduce, total, ..self.timings_ms };
        self
    }

    /// Says what constrains and was left out of the system.
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

    /// A report of an analysis that `ranks` ranks made together, without lists: its fields are public. What presolve did is not known.
    ///
    /// ```
    /// use qless::{Confidence, Kind, Report, Status};
    /// use qless::report::{BackendUsed, Certificate, Counts, DependentEquation, InputSizes, Term};
    /// let (input, counts) = (InputSizes::new(2, 3, 4, 0), Counts::new(1, 1, 0));
    /// let backend = BackendUsed::new("faer", 1, "faer 0.24".to_owned());
    /// let mut report = Report::of_ranks(2, input, counts, Confidence::of(1.0, 0.0, false), backend);
    /// let because = Certificate::complete(vec![Term::new(1, "tie 7".to_owned(), 2.0)]);
    /// report.dependent.push(DependentEquation::new(2, "tie 8".to_owned(), Kind::Redundant, 0.0, because));
    /// assert_eq!((report.rank, report.status, report.ranks), (1, Status::Redundant, Some(2)));
    /// ```
    pub fn of_ranks(
        ranks: usize,
        input: InputSizes,
        counts: Counts,
        confidence: Confidence,
        backend: BackendUsed,
    ) -> Self {
        Self {
            schema: Self::SCHEMA,
            input,
            status: counts.status(),
            rank: counts.independent,
            counts,
            dependent: Vec::new(),
            generated_boundary_conditions: Vec::new(),
            confidence,
            incomplete: Vec::new(),
            exact_rank: None,
            meant: None,
            reduction: None,
            unmet_preferences: Unmet::default(),
            ignored_coefficients: Vec::new(),
            presolve: None,
            ranks: Some(ranks),
            backend,
            timings_ms: Milliseconds::default(),
        }
    }
}
