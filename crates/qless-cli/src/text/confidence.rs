//! How sure the rank is, and what to do where it is not.

use qless::{Kind, Report, Tolerance};

use super::name;
use super::number::rough;
use super::told::Told;

/// Relative sizes below this are doubtful.
const NEAR: f64 = 3e-6;

/// One line, and where the rank is ambiguous up to two more with advice.
pub fn lines(told: &Told, report: &Report) -> Vec<String> {
    let (kept, dropped) = (report.confidence.sigma_kept, report.confidence.sigma_dropped);
    let sizes = format!("relative sizes down to {} kept, {} dropped", rough(kept), dropped_text(report, dropped));
    let rank = report.rank;
    if !report.confidence.ambiguous {
        return vec![format!("Rank {rank}, sure: {sizes}.")];
    }
    let mut lines = vec![format!("Rank {rank}, AMBIGUOUS: {sizes}.")];
    match told.tolerance {
        Tolerance::Paper => lines.push("  Without --paper-tolerance the answer does not depend on units.".to_owned()),
        _ => lines.extend(advice(told, kept, dropped)),
    }
    lines
}

fn dropped_text(report: &Report, dropped: f64) -> String {
    match (report.dependent.len(), dropped) {
        (0, _) => "nothing".to_owned(),
        (_, 0.0) => "only rounding".to_owned(),
        _ => format!("up to {}", rough(dropped)),
    }
}

/// For each reason to doubt what it is and which tolerance would decide otherwise; the two weightiest.
fn advice(told: &Told, kept: f64, dropped: f64) -> Vec<String> {
    let reasons = [nearly_dependent(kept), remainder(told, dropped), small_mismatch(told)];
    let mut lines: Vec<String> = reasons.into_iter().flatten().take(2).collect();
    if lines.is_empty() {
        lines.push("  A right-hand side differs by very little: check that no digits were lost.".to_owned());
    }
    lines
}

fn nearly_dependent(kept: f64) -> Option<String> {
    let looser = rough((10.0 * kept).max(1e-9));
    let line = format!("  Some kept equations nearly repeat others. If only rounding parts them: --tolerance {looser}");
    (kept < NEAR).then_some(line)
}

fn remainder(told: &Told, dropped: f64) -> Option<String> {
    let equation = told.dependent.iter().max_by(|a, b| a.dropped.total_cmp(&b.dropped))?;
    let name = name::equation(told.equations, equation.row);
    // A tolerance below this would take rounding for independence.
    let advice = if dropped > 1e-13 {
        format!("If that is meant: --tolerance {}", rough(dropped / 10.0))
    } else {
        "Check that no digits were lost.".to_owned()
    };
    (dropped > 0.0).then(|| format!("  {name} is not quite its combination. {advice}"))
}

fn small_mismatch(told: &Told) -> Option<String> {
    let small = |size: f64| size > 0.0 && size < NEAR;
    let equation = told.dependent.iter().find(|equation| small(equation.relative_mismatch))?;
    let name = name::equation(told.equations, equation.row);
    let size = equation.relative_mismatch;
    let (meant, tolerance) =
        if equation.kind == Kind::Conflicting { ("rounding", 10.0 * size) } else { ("meant", size / 10.0) };
    let (size, tolerance) = (rough(size), rough(tolerance));
    Some(format!("  {name} is off by {size} of its parts only. If that is {meant}: --tolerance {tolerance}"))
}
