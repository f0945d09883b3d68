//! What exact arithmetic on the numbers as typed says, beside the analysis.

use std::cmp::Ordering;

use qless::Report;
use qless::report::ExactFinding;

use super::name;
use crate::diagnose::Diagnosis;

/// Nothing without `--exact`; one line where both agree and nothing is in doubt, up to four where they do not.
pub fn lines(diagnosis: &Diagnosis, report: &Report) -> Vec<String> {
    let Some(exact) = &report.exact_rank else { return Vec::new() };
    let mut lines = vec![rank(report, exact)];
    lines.extend(meaning(report, exact).map(|line| format!("  {line}")));
    lines.extend(solution(report, exact).map(|line| format!("  {line}")));
    lines.extend(place(diagnosis, exact).map(|line| format!("  {line}")));
    lines
}

fn rank(report: &Report, exact: &ExactFinding) -> String {
    let floating = match (report.rank == exact.rank, same_ranks(exact)) {
        (true, true) => ", as in floating point.".to_owned(),
        (true, false) => ", as in floating point, but not part by part.".to_owned(),
        (false, _) => format!(" (floating point says {}).", report.rank),
    };
    format!("Exact arithmetic on the numbers as typed: rank {} of {}{floating}", exact.rank, report.input.rows)
}

fn same_ranks(exact: &ExactFinding) -> bool {
    exact.differences.iter().all(|part| part.rank == part.analysis_rank)
}

/// What follows from the two ranks.
fn meaning(report: &Report, exact: &ExactFinding) -> Option<String> {
    let rank = exact.rank;
    match (report.confidence.ambiguous, same_ranks(exact), rank.cmp(&report.rank)) {
        (true, true, _) => Some(format!("That confirms rank {rank}, for numbers meant as typed.")),
        (true, false, _) => Some(format!("That settles the doubt, for numbers meant as typed: the rank is {rank}.")),
        (false, true, _) | (_, _, Ordering::Equal) => None,
        (_, _, Ordering::Greater) => Some(
            "To the last digit more equations are independent; rounded numbers can be that by accident.".to_owned(),
        ),
        (_, _, Ordering::Less) => {
            Some("To the last digit equations repeat others that floating point tells apart.".to_owned())
        }
    }
}

/// Where only one of the two finds a solution.
fn solution(report: &Report, exact: &ExactFinding) -> Option<String> {
    let text = match (exact.solvable, report.counts.conflicting == 0) {
        (true, false) => "As typed the equations have a solution: no conflict is exact.",
        (false, true) => "As typed the equations have no solution: they conflict by less than the tolerance.",
        _ => return None,
    };
    Some(text.to_owned())
}

/// Where to look.
fn place(diagnosis: &Diagnosis, exact: &ExactFinding) -> Option<String> {
    let first = exact.differences.first()?;
    let name = name::equation(&diagnosis.system, first.row - 1);
    Some(match exact.differences.len() {
        1 => format!("The two differ in the connected part of {name} ({}).", name::count(first.equations, "equation")),
        parts => format!("The two differ in {parts} connected parts, first in that of {name}."),
    })
}
