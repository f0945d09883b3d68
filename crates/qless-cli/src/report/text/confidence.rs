//! Confidence in the rank, and advice if the rank is ambiguous.

use std::cmp::Ordering;

use qless::diagnosis::NearDependent;
use qless::exact::Reading;
use qless::explanation::Member;
use qless::report::ExactFinding;
use qless::{CertificateTerm, Doubt, Effort, Kind, Report, Tolerance};

use super::EquationList;
use super::combination;
use super::dependent::tolerance;
use crate::diagnose::Diagnosis;
use crate::wording::{self, EquationLookup, count, rough};

/// Largest relative difference between a dropped equation and its combination that may be rounding. A tolerance below this number would
/// count rounding as data.
const ROUNDING: f64 = 1e-13;
/// A mismatch is doubtful if its relative size is between these limits: it may be rounding, or meant.
const DOUBTFUL: [f64; 2] = [1e-12, 1e-6];

/// The rank and how certain it is. If the rank is ambiguous, advice follows.
pub fn rank(list: &EquationList, report: &Report) -> Vec<String> {
    let rank = report.rank;
    let digit = ordinal(report.confidence.digits_kept());
    if report.effort == Effort::Quick {
        return vec![format!("Rank {rank}, NOT CHECKED: it may be wrong. --effort checked checks it.")];
    }
    if !report.confidence.ambiguous {
        let line = match rank {
            0 => "Rank 0.".to_owned(),
            _ => format!("Rank {rank}. It stands unless coefficients are wrong in their {digit} digit."),
        };
        return [line].into_iter().chain(dropped(report)).collect();
    }
    let mut lines = vec![format!("Rank {rank}, AMBIGUOUS.")];
    match list.tolerance {
        Tolerance::Paper => lines.push("  Without --paper-tolerance the answer does not depend on units.".to_owned()),
        _ => lines.extend(advice(list, report)),
    }
    lines
}

/// The first digit that a relative change of `10^-digits` can affect: "1st", "2nd".
fn ordinal(digits: f64) -> String {
    if digits.is_infinite() {
        return "last".to_owned();
    }
    let digit = digits.floor() as u32 + 1;
    let ending = match digit % 10 {
        1 if digit != 11 => "st",
        2 if digit != 12 => "nd",
        3 if digit != 13 => "rd",
        _ => "th",
    };
    format!("{digit}{ending}")
}

/// The line about dropped equations for a rank without doubt: the left side of each differs from its combination by rounding at most, and
/// the right-hand side too unless it conflicts.
fn dropped(report: &Report) -> Option<String> {
    let what = match (report.counts.redundant, report.counts.conflicting) {
        (0, 0) => return None,
        (_, 0) => "What was dropped agrees",
        _ => "Left sides of what was dropped agree",
    };
    Some(format!("{what} to rounding."))
}

/// At most two reasons for doubt, each with advice. If equations have no proof, a line with their number replaces the reasons. If exact
/// arithmetic has another result, one more line says so.
fn advice(list: &EquationList, report: &Report) -> Vec<String> {
    let reasons = [nearly_dependent(report), remainder(list), other_reading(report), small_mismatch(list)];
    let mut lines: Vec<String> = reasons.into_iter().flatten().take(2).collect();
    if report.confidence.doubt == Some(Doubt::Unproved) {
        lines = unproved(list, report).into_iter().collect();
    } else if report.confidence.doubt == Some(Doubt::Exact) {
        lines.push("  Exact arithmetic has another result:".to_owned());
    } else if lines.is_empty() {
        lines.push(match report.confidence.doubt {
            Some(Doubt::Elimination) => {
                "  The rank could not be verified within the memory allowed: more memory settles it.".to_owned()
            }
            _ => "  Right-hand sides may differ by rounding only. --effort exact says what the numbers say.".to_owned(),
        });
    }
    lines
}

/// How many equations have no proof, and the first of them.
fn unproved(list: &EquationList, report: &Report) -> Option<String> {
    let unproved = &report.proof.as_ref()?.unproved;
    let name = wording::equation(list.equations, unproved.first()? - 1);
    let have = if unproved.len() == 1 { "has" } else { "have" };
    let many = count(unproved.len(), "equation");
    Some(format!("  {many} {have} no proof, first {name}. --effort exact may settle it."))
}

fn nearly_dependent(report: &Report) -> Option<String> {
    let looser = rough((10.0 * report.confidence.distance).max(1e-9));
    let digit = ordinal(report.confidence.digits_kept());
    let line = format!("  Kept equations differ in the {digit} digit only. If that is rounding: --tolerance {looser}");
    (report.confidence.doubt == Some(Doubt::Near)).then_some(line)
}

fn remainder(list: &EquationList) -> Option<String> {
    let equation = list.dependent.iter().max_by(|a, b| a.dropped.total_cmp(&b.dropped))?;
    let (name, dropped) = (wording::equation(list.equations, equation.row), equation.dropped);
    // A tolerance below the rounding errors would make dependent equations independent, so it is not advised. A remainder above the
    // tolerance is rounding of larger terms, which no tolerance decides.
    let advice = if dropped / 10.0 > tolerance(list.tolerance) {
        "--effort exact says what the numbers say.".to_owned()
    } else if dropped > ROUNDING {
        format!("If that is meant: --tolerance {}", rough(dropped / 10.0))
    } else {
        "Check that no digits were lost.".to_owned()
    };
    (dropped > f64::EPSILON).then(|| format!("  {name} is not quite its combination. {advice}"))
}

/// The line about numbers that may be rounding. It has the rank and the number of conflicts for the reading that the analysis did not use
/// (as zeros or as given), and the option that decides.
fn other_reading(report: &Report) -> Option<String> {
    let other = report.other_reading.as_ref()?;
    let terms = count(other.coefficients.len(), "coefficient");
    let how = if other.as_zero { "zero" } else { "given" };
    let conflicts = count(other.conflicting, "conflict");
    Some(format!(
        "  {terms} may be rounding; as {how}: rank {}, {conflicts}. --noise none or 1.5e-14 decides.",
        other.rank
    ))
}

fn small_mismatch(list: &EquationList) -> Option<String> {
    let small = |size: f64| size > DOUBTFUL[0] && size < DOUBTFUL[1];
    let equation = list.dependent.iter().find(|equation| small(equation.relative_mismatch))?;
    let name = wording::equation(list.equations, equation.row);
    let size = equation.relative_mismatch;
    let (meant, tolerance) =
        if equation.kind == Kind::Conflicting { ("rounding", 10.0 * size) } else { ("meant", size / 10.0) };
    let (size, tolerance) = (rough(size), rough(tolerance));
    Some(format!("  {name} is off by only {size} of its terms. If that is {meant}: --tolerance {tolerance}"))
}

/// Lines about near-dependence: both ranks, and the equation that is closest to dependent.
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
        let member = |term: &CertificateTerm| Member::Equation { row: term.row, coefficient: term.coefficient };
        let members: Vec<Member> = because.iter().map(member).collect();
        let lookup: (&dyn EquationLookup, _) = (&diagnosis.system, Some(&diagnosis.system));
        let mut combination = combination::lines(lookup, *row, &members, 2);
        combination.truncate(1);
        let head = 2 + wording::equation(&diagnosis.system, *row).len();
        let nearly = |line: String| line[..head].to_owned() + &line[head..].replacen(" = ", " ~ ", 1) + &agree;
        lines.extend(combination.into_iter().map(nearly));
    }
    lines
}

/// The result of `--effort exact`: one line if it agrees with the analysis and the rank is not ambiguous, otherwise up to four.
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

/// The conclusion from the rank of the analysis and the exact rank.
fn meaning(report: &Report, exact: &ExactFinding) -> Option<String> {
    let rank = exact.rank;
    let is_in_doubt = report.confidence.ambiguous && report.confidence.doubt != Some(Doubt::Exact);
    match (is_in_doubt, same_ranks(exact), rank.cmp(&report.rank)) {
        (true, true, _) => Some(format!("That confirms rank {rank}, for numbers meant {}.", as_read(exact))),
        (true, false, _) => {
            Some(format!("That settles the doubt, for numbers meant {}: the rank is {rank}.", as_read(exact)))
        }
        (false, true, _) | (_, _, Ordering::Equal) => None,
        (_, _, Ordering::Greater) => {
            Some("In exact arithmetic more equations are independent; rounding of the input can cause this.".to_owned())
        }
        (_, _, Ordering::Less) => {
            Some("In exact arithmetic more equations are dependent than in floating point.".to_owned())
        }
    }
}

/// A line if only one of the two analyses, in floating point and exact, finds a solution.
fn solution(report: &Report, exact: &ExactFinding) -> Option<String> {
    let text = match (exact.solvable, report.counts.conflicting == 0) {
        (true, false) => "As typed the equations have a solution: no conflict is exact.",
        (false, true) => "As typed the equations have no solution: they conflict by less than the tolerance.",
        _ => return None,
    };
    Some(text.to_owned())
}

/// The part in which the analyses in floating point and in exact arithmetic differ.
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

/// A line about coefficients that count as zero, if any.
pub fn noise(diagnosis: &Diagnosis, report: &Report) -> Option<String> {
    let first = report.noise.first()?;
    let equation = wording::equation(&diagnosis.system, first.row - 1);
    let dof = diagnosis.system.dof_label(first.dof - 1);
    let (size, dof) = (rough(first.coefficient), wording::label(&dof));
    Some(match report.noise.len() {
        1 => format!("One coefficient is no more than rounding and counts as zero: {size} of {dof} in {equation}."),
        count => format!(
            "{count} coefficients are no more than rounding and count as zero, first {size} of {dof} in {equation}."
        ),
    })
}
