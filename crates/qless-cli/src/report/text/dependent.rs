//! Dependent equations with their certificates, as many as fit; the others by their row numbers.

use qless::{Kind, Report};

use super::COLUMNS;
use super::combination::{self, CombinationAlone};
use super::{DependentRow, EquationList};
use crate::wording::EquationLookup;
use crate::wording::layout::flow;
use crate::wording::{label, number};

/// The equations of one kind in at most `most` lines. Computes only the certificates that are shown.
pub fn section(list: &EquationList, kind: Kind, most: usize) -> Vec<String> {
    let of_kind: Vec<_> = list.dependent.iter().filter(|dependent| dependent.kind == kind).collect();
    if of_kind.is_empty() {
        return Vec::new();
    }
    let mut lines = vec![heading(kind).to_owned()];
    // Many equations without free DOFs would hide the others.
    let of_kind = if kind == Kind::Redundant { group(list, of_kind, &mut lines) } else { of_kind };
    for (k, dependent) in of_kind.iter().enumerate() {
        let entry = entry(list, dependent);
        let for_the_rest = usize::from(k + 1 < of_kind.len());
        if lines.len() + entry.len() + for_the_rest > most {
            lines.push(rest(&of_kind[k..], k));
            break;
        }
        lines.extend(entry);
    }
    lines
}

/// Collects equations that are dependent without others into one line for each reason, if there are several; returns the others.
fn group<'a>(list: &EquationList, of_kind: Vec<&'a DependentRow>, lines: &mut Vec<String>) -> Vec<&'a DependentRow> {
    let mut remaining = of_kind;
    for reason in [CombinationAlone::Empty, CombinationAlone::Prescribed] {
        let has_reason = |d: &&DependentRow| CombinationAlone::classify(list.equations, d.row) == reason;
        let (alike, others): (Vec<_>, Vec<_>) = remaining.iter().copied().partition(has_reason);
        if alike.len() > 1 {
            lines.push(rows(&format!("  {}:", reason.several()), &alike));
            remaining = others;
        }
    }
    remaining
}

fn heading(kind: Kind) -> &'static str {
    match kind {
        Kind::Conflicting => "Conflicting: a combination of other equations, but with another right-hand side.",
        _ => "Redundant: a combination of other equations, which already say the same.",
    }
}

fn entry(list: &EquationList, dependent: &DependentRow) -> Vec<String> {
    let because = (list.because)(dependent.row);
    let mut lines = combination::lines(list.equations, dependent.row, &because);
    let error = (list.because_error)(dependent.row);
    if error > 0.0 {
        lines.push(format!("      these coefficients leave up to {} of their terms in a DOF", number(error)));
    }
    if dependent.kind == Kind::Conflicting {
        lines.push(mismatch(list.equations, dependent, because.is_empty()));
    }
    lines
}

/// The right-hand side as given, and the value that would be consistent.
fn mismatch(equations: &dyn EquationLookup, dependent: &DependentRow, is_alone: bool) -> String {
    let facts = equations.facts(dependent.row);
    let found = facts.rhs;
    let needed = found - dependent.mismatch;
    let who = match (is_alone, facts.prescribed > 0) {
        (true, false) => "it can only be",
        (true, true) => "the prescribed values require",
        (false, false) => "the others require",
        (false, true) => "the others and the prescribed values require",
    };
    let off = number(dependent.mismatch);
    format!("      right-hand side {}, but {who} {} (mismatch {off})", number(found), number(needed))
}

/// `  and 480 more (why: --format json): rows 12, 15, 19-22, ...`.
fn rest(dependent: &[&DependentRow], shown: usize) -> String {
    let (count, plural) = (dependent.len(), if dependent.len() == 1 { "" } else { "s" });
    let more = if shown == 0 { "" } else { " more" };
    rows(&format!("  and {count}{more} (why: --format json): row{plural}"), dependent)
}

/// `first 12, 15, 19-22, ...` in one line.
fn rows(first: &str, dependent: &[&DependentRow]) -> String {
    const TAIL: &str = ", ...";
    let rows: Vec<usize> = dependent.iter().map(|d| d.row + 1).collect();
    let pieces = ranges(&rows);
    let flowed = flow(first, "", &pieces, (1, COLUMNS), TAIL.len());
    let left_out = flowed.used < pieces.len();
    let line = flowed.finish("").concat();
    if left_out { line.trim_end_matches(',').to_owned() + TAIL } else { line }
}

/// Runs of rows, ` 3,` or ` 5-9,`, the last one without a comma; at most as many as fit into a line.
fn ranges(rows: &[usize]) -> Vec<String> {
    let mut pieces = Vec::new();
    let mut rest = rows;
    while let Some(&first) = rest.first().filter(|_| pieces.len() < COLUMNS) {
        let run = rest.iter().zip(first..).take_while(|&(&row, expected)| row == expected).count();
        let comma = if run < rest.len() { "," } else { "" };
        pieces.push(match run {
            1 => format!(" {first}{comma}"),
            _ => format!(" {first}-{}{comma}", first + run - 1),
        });
        rest = &rest[run..];
    }
    pieces
}

/// Fixed DOFs, `u3 = 0.5`: a heading and one line, or nothing.
pub fn generated_conditions(report: &Report) -> Vec<String> {
    let all = &report.generated_boundary_conditions;
    if all.is_empty() {
        return Vec::new();
    }
    let comma = |k: usize| if k + 1 < all.len() { "," } else { "" };
    let shown = all.iter().take(COLUMNS).enumerate();
    let pieces: Vec<String> =
        shown.map(|(k, fixed)| format!(" {} = {}{}", label(&fixed.label), number(fixed.value), comma(k))).collect();
    let tail = format!(" ... ({} in all)", all.len());
    let flowed = flow(" ", "", &pieces, (1, COLUMNS), tail.len());
    let tail = if flowed.used < all.len() { tail } else { String::new() };
    let what = if all.len() == 1 { "a free DOF" } else { "free DOFs" };
    let mut lines = vec![format!("Generated boundary conditions: the equations leave {what} one value only.")];
    lines.extend(flowed.finish(&tail));
    lines
}

#[cfg(test)]
mod tests {
    use super::ranges;

    #[test]
    fn runs_of_rows_are_written_short() {
        assert_eq!(ranges(&[2, 5, 6, 7, 9, 10]).concat(), " 2, 5-7, 9-10");
    }
}
