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
mod made;
mod meant;
mod status;

use std::time::Duration;

use crate::{Analysis, Confidence, ConstraintSystem, FactoredBlock, Form, Kind, PresolveStatistics, Reduction};
use budget::Budget;
pub use exact::{ExactDifference, ExactFinding};
pub use meant::{MeantFinding, NearEquation};
pub use status::Status;

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
    pub meant: Option<MeantFinding>,
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

/// A coefficient below 1.4e-14 of the largest of its equation, of a DOF that counts in others.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct IgnoredCoefficient {
    /// Its row, from 1.
    pub row: usize,
    /// Its DOF, from 1.
    pub dof: usize,
    /// Its value.
    pub coefficient: f64,
}

/// Sizes of a system.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct InputSizes {
    /// Equations.
    pub rows: usize,
    /// DOFs, prescribed ones included.
    pub dofs: usize,
    /// Coefficients that are not zero.
    pub nnz: usize,
    /// DOFs that are not prescribed.
    pub free: usize,
    /// DOFs that are.
    pub prescribed: usize,
}

/// Equations of each kind; they sum to all, and `independent` is the rank.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Counts {
    /// Kept equations.
    pub independent: usize,
    /// Combinations of kept equations that are consistent with them.
    pub redundant: usize,
    /// Combinations of kept equations that contradict them.
    pub conflicting: usize,
}

/// A redundant or conflicting equation.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct DependentEquation {
    /// Its row, from 1.
    pub row: usize,
    /// Its label.
    pub label: String,
    /// Redundant or conflicting.
    pub kind: Kind,
    /// `b_k - sum c_i b_i` in the units of the equation, prescribed DOFs moved into b.
    pub mismatch: f64,
    /// `because`, and `because_omitted` where it is left out.
    #[cfg_attr(feature = "serde", serde(flatten))]
    pub certificate: Certificate,
}

/// A free DOF that the equations fix.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct GeneratedCondition {
    /// The DOF, from 1.
    pub dof: usize,
    /// Its label.
    pub label: String,
    /// The only value that the equations leave it.
    pub value: f64,
    /// `because`, and `because_omitted` where it is left out.
    #[cfg_attr(feature = "serde", serde(flatten))]
    pub certificate: Certificate,
}

/// A certificate, or how much of it was left out.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Certificate {
    /// The equations combined, ascending; empty for `0 = b` as well, which needs none.
    pub because: Vec<Term>,
    /// What is not in `because`.
    #[cfg_attr(feature = "serde", serde(rename = "because_omitted", skip_serializing_if = "Omitted::is_nothing"))]
    pub omitted: Omitted,
}

/// `coefficient` times an equation.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Term {
    /// Row of a kept equation, from 1.
    pub row: usize,
    /// Its label.
    pub label: String,
    /// Its factor.
    pub coefficient: f64,
}

/// What a report left out of a certificate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Omitted {
    /// Nothing; the key is then absent.
    Nothing,
    /// All of its terms, this many.
    Terms(usize),
    /// It was not computed; serializes as null.
    NotComputed,
}

impl Omitted {
    #[cfg(feature = "serde")]
    fn is_nothing(&self) -> bool {
        *self == Self::Nothing
    }
}

#[cfg(feature = "serde")]
impl serde::Serialize for Omitted {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match *self {
            Self::Terms(count) => serializer.serialize_u64(count as u64),
            Self::Nothing | Self::NotComputed => serializer.serialize_none(),
        }
    }
}

/// The size and quality of `u_s = T u_q + G u_p + g`.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct ReductionSizes {
    /// Number of slaves u_s.
    pub slaves: usize,
    /// Number of masters u_q.
    pub masters: usize,
    /// `max |T_ij|`; of factored parts the largest entry that was found.
    pub growth: f64,
    /// How well it meets the independent equations, see [`Analysis::residual`].
    pub residual: f64,
    /// Entries of T and G.
    pub nnz: usize,
    /// How many times a slave and a master changed places to keep the growth down.
    pub exchanges: usize,
    /// The form that was asked for.
    pub form: Form,
    /// Connected parts that stay factors: their rows are not in T and G.
    pub factored: Vec<FactoredSizes>,
}

/// The size of a connected part that stays factors, see [`FactoredBlock`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct FactoredSizes {
    /// Its independent equations.
    pub equations: usize,
    /// Its slaves.
    pub slaves: usize,
    /// Its masters.
    pub masters: usize,
    /// Numbers that it holds: of L, U, C_M and C_p.
    pub nnz: usize,
    /// Numbers that its part of T would have, estimated.
    pub predicted: usize,
}

/// Preferences that are not met, counted from 1.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Unmet {
    /// Equations that are dependent though they were to be kept.
    pub equations: Vec<usize>,
    /// DOFs that are slaves though they must not be.
    pub masters: Vec<usize>,
    /// DOFs that are not slaves though that was preferred.
    pub slaves: Vec<usize>,
}

impl Unmet {
    /// Whether every preference is met.
    pub fn is_empty(&self) -> bool {
        self.equations.is_empty() && self.masters.is_empty() && self.slaves.is_empty()
    }
}

fn from_one(numbers: &[usize]) -> Vec<usize> {
    numbers.iter().map(|k| k + 1).collect()
}

/// What factored the blocks.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct BackendUsed {
    /// `faer`, `spqr` or `gauss`.
    pub name: &'static str,
    /// Threads at work.
    pub threads: usize,
    /// Name and version of the library behind it.
    pub version: String,
}

/// Time spent in each stage, 0 for a stage that did not run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Milliseconds {
    /// Reading and checking the input.
    pub read: f64,
    /// Scaling and presolve.
    pub presolve: f64,
    /// The backend.
    pub factor: f64,
    /// Classification and generated boundary conditions.
    pub classify: f64,
    /// T, G and g.
    pub reduce: f64,
    /// From start to end, with what is in no stage.
    pub total: f64,
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
        let mut budget = Budget::new(analysis, terms);
        let (dependent, generated_boundary_conditions) = budget.spend();
        let counts = count(&analysis.kinds);
        let (name, version) = &analysis.backend;
        Self {
            schema: Self::SCHEMA,
            input: InputSizes::of(analysis.system()),
            status: counts.status().into(),
            rank: analysis.rank(),
            counts,
            dependent,
            generated_boundary_conditions,
            confidence: analysis.confidence,
            incomplete: Vec::new(),
            exact_rank: None,
            meant: None,
            reduction: None,
            unmet_preferences: Unmet { equations: from_one(&analysis.unmet_equations), ..Unmet::default() },
            ignored_coefficients: analysis.ignored.iter().map(IgnoredCoefficient::of).collect(),
            presolve: Some(analysis.presolve),
            ranks: None,
            backend: BackendUsed { name, threads: rayon::current_num_threads(), version: version.clone() },
            timings_ms: Milliseconds::of(analysis),
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
            factored: reduction.factored.iter().map(FactoredSizes::of).collect(),
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
}

impl FactoredSizes {
    fn of(block: &FactoredBlock) -> Self {
        Self {
            equations: block.equations.len(),
            slaves: block.slaves.len(),
            masters: block.masters.len(),
            nnz: block.nnz(),
            predicted: block.predicted,
        }
    }
}

impl IgnoredCoefficient {
    fn of(ignored: &crate::Ignored) -> Self {
        Self { row: ignored.row + 1, dof: ignored.dof + 1, coefficient: ignored.coefficient }
    }
}

impl InputSizes {
    fn of(system: &ConstraintSystem) -> Self {
        Self {
            rows: system.equations(),
            dofs: system.dofs(),
            nnz: system.matrix().nnz(),
            free: system.free(),
            prescribed: system.prescribed().len(),
        }
    }
}

impl Counts {
    fn status(self) -> Kind {
        match self {
            Self { redundant: 0, conflicting: 0, .. } => Kind::Independent,
            Self { conflicting: 0, .. } => Kind::Redundant,
            Self { .. } => Kind::Conflicting,
        }
    }
}

fn count(kinds: &[Kind]) -> Counts {
    let of = |kind: Kind| kinds.iter().filter(|&&k| k == kind).count();
    Counts { independent: of(Kind::Independent), redundant: of(Kind::Redundant), conflicting: of(Kind::Conflicting) }
}

impl Milliseconds {
    fn of(analysis: &Analysis) -> Self {
        let times = &analysis.timings;
        let [presolve, factor, classify] = [times.presolve, times.factor, times.classify].map(milliseconds);
        Self { presolve, factor, classify, total: presolve + factor + classify, ..Self::default() }
    }
}

/// To the microsecond.
fn milliseconds(time: Duration) -> f64 {
    (time.as_secs_f64() * 1e6).round() / 1e3
}
