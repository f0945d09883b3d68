//! The results for one system and one set of options against the SVD and the residual.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};

use qless::{Analysis, Kind, Options, SystemBuilder, Tolerance, analyse};
use qless_scenes::oracle::{consistent, rank_free};

use super::residual;
use super::svd_reference::{Case, Truth};

/// Largest residual of a returned reduction, in balanced units of DOFs: reductions are computed in units near those of the user.
const RESIDUAL: f64 = 1e-7;
/// Time limit for one system.
const LONG: Duration = Duration::from_secs(10);

/// A violated law.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Law {
    /// An error, a panic or no end.
    Ends,
    /// A reduction exists where the SVD is clear.
    Gate,
    /// The returned reduction satisfies the equations.
    Residual,
    /// The rank is that of the SVD.
    Rank,
    /// No doubt where the SVD has none.
    Alarm,
    /// A conflict without doubt is one in exact arithmetic.
    Conflict,
    /// Generated boundary conditions follow from the equations where the SVD is clear.
    Generated,
}

pub type Fault = (Law, String);

pub fn tolerance(options: &Options) -> f64 {
    let Tolerance::Relative(tolerance) = options.tolerance else { panic!("relative here") };
    tolerance
}

/// A short text with the options that differ from the default.
pub fn text(options: &Options) -> String {
    let Options { backend, presolve, growth, tolerance, .. } = options;
    format!("{backend:?}, presolve {presolve}, growth {growth}, {tolerance:?}")
}

/// All violated laws of one system.
pub fn faults(case: &Case, truth: &Truth, options: &Options) -> Vec<Fault> {
    let what = format!("{} [{}]", case.name, text(options));
    let start = Instant::now();
    let mut faults = match catch_unwind(AssertUnwindSafe(|| judge(case, truth, options))) {
        Ok(faults) => faults,
        Err(_) => vec![(Law::Ends, "it panics".into())],
    };
    if start.elapsed() > LONG {
        faults.push((Law::Ends, format!("it takes {:?}", start.elapsed())));
    }
    faults.into_iter().map(|(law, fault)| (law, format!("{law:?}: {what}: {fault}"))).collect()
}

fn judge(case: &Case, truth: &Truth, options: &Options) -> Vec<Fault> {
    let analysis = match analyse(&case.system, options) {
        Ok(analysis) => analysis,
        Err(error) => return vec![(Law::Ends, error.to_string())],
    };
    let mut out = Vec::new();
    out.extend(gate(case, truth, &analysis));
    out.extend(rank(case, truth, &analysis).map(|fault| (Law::Rank, fault)));
    out.extend(conflict(case, truth, &analysis).map(|fault| (Law::Conflict, fault)));
    out.extend(generated(case, truth, &analysis).map(|fault| (Law::Generated, fault)));
    // A coefficient that is left of a zero makes a row independent in exact arithmetic: there doubt is no false alarm.
    let is_exact = || rank_free(&case.system).expect("within reach") == analysis.rank();
    if analysis.confidence().ambiguous && truth.is_clear() && !case.near && is_clear_as_given(case) && is_exact() {
        out.push((Law::Alarm, format!("in doubt at sigma {:.1e}: {:?}", truth.sigma(), analysis.confidence())));
    }
    out
}

fn gate(case: &Case, truth: &Truth, analysis: &Analysis) -> Option<Fault> {
    let ambiguous = analysis.confidence().ambiguous;
    match analysis.reduction() {
        Err(error) if truth.is_clear() => {
            Some((Law::Gate, format!("sigma {:.1e}, ambiguous {ambiguous}: {error}", truth.sigma())))
        }
        Err(_) => None,
        Ok(reduction) => {
            let worst = |seed| residual::worst(&case.system, &case.units, analysis, &reduction, seed);
            let (most, row, part) =
                [1, 2].map(worst).into_iter().fold((0.0, 0, "T"), |a, b| if b.0 > a.0 { b } else { a });
            let reported = analysis.residual(&reduction).expect("its own DOFs");
            let text = format!("{most:.1e} in row {row} by {part}, reported {reported:.1e}, ambiguous {ambiguous}");
            (most > RESIDUAL || reported.is_nan() || reported > RESIDUAL).then_some((Law::Residual, text))
        }
    }
}

/// If doubt is reported and justified, the rank may differ.
fn rank(case: &Case, truth: &Truth, analysis: &Analysis) -> Option<String> {
    let (found, ambiguous) = (analysis.rank(), analysis.confidence().ambiguous);
    let must_hold = if ambiguous { truth.is_clear() } else { truth.has_gap() };
    let around = truth.values.iter().skip(truth.rank.saturating_sub(2)).take(4);
    let around: Vec<String> = around.map(|sigma| format!("{sigma:.1e}")).collect();
    // Small singular values of triangular equations say nothing: there the exact rank counts, or that above rounding.
    let is_exact = || rank_free(&case.system).expect("within reach") == found || truth.has_gap_at(found);
    (must_hold && found != truth.rank && !is_exact())
        .then(|| format!("rank {found}, {} by SVD {around:?}, ambiguous {ambiguous}", truth.rank))
}

/// Equations with an exact solution do not conflict, unless there is doubt.
fn conflict(case: &Case, truth: &Truth, analysis: &Analysis) -> Option<String> {
    let ambiguous = analysis.confidence().ambiguous;
    let found = analysis.dependent().iter().find(|d| d.kind == Kind::Conflicting).filter(|_| !ambiguous)?;
    consistent(&case.system).expect("within reach").then(|| {
        let sigma = truth.sigma();
        format!(
            "row {} conflicts by {:.1e}, but there is a solution; sigma {sigma:.1e}",
            found.row, found.relative_mismatch
        )
    })
}

/// Every tolerance is relative to the rows in the given units of the DOFs. Columns are scaled only if whole columns
/// are small.
fn is_clear_as_given(case: &Case) -> bool {
    Truth::new(&case.system, tolerance(&Options::default())).is_clear()
}

/// With `u_j = value` as further equations the rank is the same.
fn generated(case: &Case, truth: &Truth, analysis: &Analysis) -> Option<String> {
    if analysis.generated().is_empty() || !truth.is_clear() || !is_clear_as_given(case) {
        return None;
    }
    let system = &case.base;
    let mut builder = SystemBuilder::new(system.dofs());
    (0..system.equations()).for_each(|i| _ = builder.equation(system.matrix().row(i), system.rhs()[i]));
    analysis.generated().iter().for_each(|&(j, _)| _ = builder.equation([(j, 1.0)], 0.0));
    system.prescribed().iter().for_each(|&(j, value)| builder.prescribe(j, value));
    let more_equations = builder.build().expect("valid");
    let more = Truth::new(&more_equations, 1e-9).rank.saturating_sub(truth.rank);
    // The SVD misses ranks of triangular equations whose DOFs grow.
    let is_more = || {
        let [more, own] = [&more_equations, system].map(|system| rank_free(system).expect("within reach"));
        more > own
    };
    (more > 0 && is_more())
        .then(|| format!("{more} of {} generated boundary conditions are none", analysis.generated().len()))
}
