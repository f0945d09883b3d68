//! Confidence in the rank, and advice if the rank is ambiguous.

use std::cmp::Ordering;

use qless::diagnosis::NearDependent;
use qless::exact::Reading;
use qless::report::ExactFinding;
use qless::{Kind, Report, Tolerance};

use super::EquationList;
use super::combination;
use crate::diagnose::Diagnosis;
use crate::wording::{self, count, rough};

/// Relative sizes below this are doubtful.
const NEAR: f64 = 3e-6;

/// The line of the rank; if it is ambiguous, up to two lines of advice follow.
pub fn rank(list: &EquationList, report: &Report) -> Vec<String> {
    let (kept, dropped) = (report.confidence.sigma_kept, report.confidence.sigma_dropped);
    let sizes = format!("relative sizes down to {} kept, {} dropped", rough(kept), dropped_text(report, dropped));
    let rank = report.rank;
    if !report.confidence.ambiguous {
        return vec![format!("Rank {rank}, sure: {sizes}.")];
    }
    let mut lines = vec![format!("Rank {rank}, AMBIGUOUS: {sizes}.")];
    match list.tolerance {
        Tolerance::Paper => lines.push("  Without --paper-tolerance the answer does not depend on units.".to_owned()),
        _ => lines.extend(advice(list, kept, dropped)),
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

/// At most two reasons for doubt, each with the tolerance that would decide otherwise.
fn advice(list: &EquationList, kept: f64, dropped: f64) -> Vec<String> {
    let reasons = [nearly_dependent(kept), remainder(list, dropped), small_mismatch(list)];
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

fn remainder(list: &EquationList, dropped: f64) -> Option<String> {
    let equation = list.dependent.iter().max_by(|a, b| a.dropped.total_cmp(&b.dropped))?;
    let name = wording::equation(list.equations, equation.row);
    // With a smaller tolerance, rounding errors would make equations independent.
    let advice = if dropped > 1e-13 {
        format!("If that is meant: --tolerance {}", rough(dropped / 10.0))
    } else {
        "Check that no digits were lost.".to_owned()
    };
    (dropped > 0.0).then(|| format!("  {name} is not quite its combination. {advice}"))
}

fn small_mismatch(list: &EquationList) -> Option<String> {
    let small = |size: f64| size > 0.0 && size < NEAR;
    let equation = list.dependent.iter().find(|equation| small(equation.relative_mismatch))?;
    let name = wording::equation(list.equations, equation.row);
    let size = equation.relative_mismatch;
    let (meant, tolerance) =
        if equation.kind == Kind::Conflicting { ("rounding", 10.0 * size) } else { ("meant", size / 10.0) };
    let (size, tolerance) = (rough(size), rough(tolerance));
    Some(format!("  {name} is off by {size} of its parts only. If that is {meant}: --tolerance {tolerance}"))
}

/// With near-dependence: both ranks, and the equation that is closest to dependent.
pub fn near_dependence(diagnosis: &Diagnosis, report: &Report) -> Vec<String> {
    let Some(near) = &diagnosis.near_dependence else { return Vec::new() };
    let digits = count(near.digits() as usize, "digit");
    let mut lines = vec![
        format!("As typed the rank is {}; if equations that agree to {digits} are meant as the same,", report.rank),
        format!("it is {}: {} would then repeat others.", near.rank, count(near.equations.len(), "equation")),
    ];
    let best = |a: &&NearDependent, b: &&NearDependent| (a.digits, b.row).cmp(&(b.digits, a.row));
    if let Some(NearDependent { row, digits, because, .. }) = near.equations.iter().max_by(best) {
        let agree = format!(" to {} of each coefficient", count(*digits as usize, "digit"));
        let mut combination = combination::lines(&diagnosis.system, *row, because);
        combination.truncate(1);
        let head = 2 + wording::equation(&diagnosis.system, *row).len();
        let nearly = |line: String| line[..head].to_owned() + &line[head..].replacen(" = ", " ~ ", 1) + &agree;
        lines.extend(combination.into_iter().map(nearly));
    }
    lines
}

/// The result of `--exact`: one line if it agrees with the analysis and the rank is not ambiguous, otherwise up to four.
pub fn exact_rank(diagnosis: &Diagnosis, report: &Report) -> Vec<String> {
    let Some(exact) = &report.exact_rank else { return Vec::new() };
    let mut lines = vec![rank_line(report, exact)];
    lines.extend(meaning(report, exact).map(|line| format!("  {line}")));
    lines.extend(solution(report, exact).map(|line| format!("  {line}")));
    lines.extend(place(diagnosis, exact).map(|line| format!("  {line}")));
    lines
}

fn rank_line(report: &Report, exact: &ExactFinding) -> String {
    let floating = match (report.rank == exact.rank, same_ranks(exact)) {
        (true, true) => ", as in floating point.".to_owned(),
        (true, false) => ", as in floating point, but not part by part.".to_owned(),
        (false, _) => format!(" (floating point says {}).", report.rank),
    };
    let how = as_read(exact);
    format!("Exact arithmetic on the numbers {how}: rank {} of {}{floating}", exact.rank, report.input.rows)
}

fn as_read(exact: &ExactFinding) -> &'static str {
    match exact.reading {
        Reading::Typed => "as typed",
        Reading::Stored => "as stored",
    }
}

fn same_ranks(exact: &ExactFinding) -> bool {
    exact.differences.iter().all(|part| part.rank == part.analysis_rank)
}

/// The conclusion from the two ranks.
fn meaning(report: &Report, exact: &ExactFinding) -> Option<String> {
    let rank = exact.rank;
    match (report.confidence.ambiguous, same_ranks(exact), rank.cmp(&report.rank)) {
        (true, true, _) => Some(format!("That confirms rank {rank}, for numbers meant {}.", as_read(exact))),
        (true, false, _) => {
            Some(format!("That settles the doubt, for numbers meant {}: the rank is {rank}.", as_read(exact)))
        }
        (false, true, _) | (_, _, Ordering::Equal) => None,
        (_, _, Ordering::Greater) => Some(
            "To the last digit more equations are independent; rounded numbers can be that by accident.".to_owned(),
        ),
        (_, _, Ordering::Less) => {
            Some("To the last digit equations repeat others that floating point tells apart.".to_owned())
        }
    }
}

/// A line if only one of the two analyses finds a solution.
fn solution(report: &Report, exact: &ExactFinding) -> Option<String> {
    let text = match (exact.solvable, report.counts.conflicting == 0) {
        (true, false) => "As typed the equations have a solution: no conflict is exact.",
        (false, true) => "As typed the equations have no solution: they conflict by less than the tolerance.",
        _ => return None,
    };
    Some(text.to_owned())
}

/// The part in which the two analyses differ.
fn place(diagnosis: &Diagnosis, exact: &ExactFinding) -> Option<String> {
    let first = exact.differences.first()?;
    let name = wording::equation(&diagnosis.system, first.row - 1);
    Some(match exact.differences.len() {
        1 => {
            format!("The two differ in the connected part of {name} ({}).", wording::count(first.equations, "equation"))
        }
        parts => format!("The two differ in {parts} connected parts, first in that of {name}."),
    })
}

/// A line about coefficients of the size of rounding errors, if any.
pub fn ignored_coefficients(diagnosis: &Diagnosis, report: &Report) -> Option<String> {
    let first = report.ignored_coefficients.first()?;
    let equation = wording::equation(&diagnosis.system, first.row - 1);
    let dof = diagnosis.system.dof_label(first.dof - 1);
    let (size, dof) = (rough(first.coefficient), wording::label(&dof));
    Some(match report.ignored_coefficients.len() {
        1 => format!("One coefficient is no more than rounding and decided nothing: {size} of {dof} in {equation}."),
        count => format!(
            "{count} coefficients are no more than rounding and decided nothing, first {size} of {dof} in {equation}."
        ),
    })
}
