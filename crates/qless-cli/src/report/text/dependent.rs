//! Dependent equations with their certificates, as many as fit; the others by their row numbers.

use qless::report::Group;
use qless::{Kind, Report, Tolerance};

use super::COLUMNS;
use super::combination::{self, CombinationAlone};
use super::next::quoted;
use super::{DependentRow, EquationList};
use crate::wording::EquationLookup;
use crate::wording::layout::{flow, width};
use crate::wording::{label, number};

/// The equations of one kind in at most `most` lines. Computes only the certificates that are shown.
pub fn section(list: &EquationList, kind: Kind, most: usize) -> Vec<String> {
    let of_kind: Vec<_> = list.dependent.iter().filter(|dependent| dependent.kind == kind).collect();
    if of_kind.is_empty() {
        return Vec::new();
    }
    let mut lines = vec![heading(kind).to_owned()];
    // Equations without free DOFs get one line for each reason: many of them would hide the others.
    let of_kind = if kind == Kind::Redundant { group(list, of_kind, &mut lines) } else { of_kind };
    let groups = origins(list, &of_kind);
    let mut shown = 0;
    for (k, group) in groups.iter().enumerate() {
        let for_the_rest = usize::from(k + 1 < groups.len());
        let mut entry = entry(list, group[0], most.saturating_sub(lines.len() + for_the_rest));
        entry.extend(alike(list, group));
        if shown > 0 && lines.len() + entry.len() + for_the_rest > most {
            let others: Vec<&DependentRow> = groups[k..].iter().flatten().copied().collect();
            lines.push(rest(list, &others));
            break;
        }
        lines.extend(entry);
        shown += group.len();
    }
    lines
}

/// Groups the equations by origin, in the order of their first rows. A few equations are not grouped.
fn origins<'a>(list: &EquationList, of_kind: &[&'a DependentRow]) -> Vec<Vec<&'a DependentRow>> {
    if of_kind.len() <= SINGLE {
        return of_kind.iter().map(|&dependent| vec![dependent]).collect();
    }
    let found = |d: &&DependentRow| (d.row, d.kind, list.equations.label(d.row), Vec::new());
    let groups = Group::of(&of_kind.iter().map(found).collect::<Vec<_>>());
    let of_row = |row: &usize| of_kind.binary_search_by_key(row, |d| d.row).ok().map(|at| of_kind[at]);
    groups.iter().map(|group| group.rows.iter().filter_map(of_row).collect()).collect()
}

/// A line about equations like the one shown: `      so are 29 more: rows 12-40`.
fn alike(list: &EquationList, group: &[&DependentRow]) -> Option<String> {
    let others = group.get(1..).filter(|others| !others.is_empty())?;
    let (number, verb) = (others.len(), if others.len() == 1 { "is" } else { "are" });
    let found = |d: &&DependentRow| (d.row, d.kind, list.equations.label(d.row), Vec::new());
    let label_of_all = Group::of(&group.iter().map(found).collect::<Vec<_>>()).pop().map(|all| all.label);
    let what =
        label_of_all.filter(|text| text != "row #").map_or_else(String::new, |text| format!(" \"{}\"", label(&text)));
    Some(rows(&format!("      so {verb} {number} more{what}: row{}", if number == 1 { "" } else { "s" }), others))
}

/// A kind with at most this many equations is not grouped: each equation is shown.
const SINGLE: usize = 2;

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

/// Largest number of lines for the explanation of a conflict, and of a redundancy. Repairing a conflict needs all members, so it gets more
/// lines.
const CONFLICT_LINES: usize = 4;
const REDUNDANCY_LINES: usize = 2;

fn entry(list: &EquationList, dependent: &DependentRow, most: usize) -> Vec<String> {
    let Some(explanation) = (list.explain)(dependent.row) else { return Vec::new() };
    let members = &explanation.members;
    let is_conflict = dependent.kind == Kind::Conflicting;
    let wanted = if is_conflict { CONFLICT_LINES } else { REDUNDANCY_LINES };
    let lookup = (list.equations, list.system);
    let mut lines = combination::lines(lookup, dependent.row, members, wanted.min(most.saturating_sub(1)).max(1));
    lines.extend(remainder(explanation.error, list.tolerance).map(|line| format!("      {line}")));
    if is_conflict {
        lines.push(match list.system {
            Some(system) => format!("      {}", explanation.arithmetic(system, dependent.row)),
            None => mismatch(list.equations, dependent, members.is_empty()),
        });
    }
    lines
}

/// A line about what a combination leaves, if that is more than the tolerance.
pub fn remainder(error: f64, allowed: Tolerance) -> Option<String> {
    let line = || {
        format!(
            "at its worst DOF this combination leaves {} of the terms there: rounding, if those are tiny",
            number(error)
        )
    };
    (error > tolerance(allowed)).then(line)
}

/// A certificate whose error is above this value is reported; smaller errors are within the tolerance of the rank.
pub fn tolerance(tolerance: Tolerance) -> f64 {
    if let Tolerance::Relative(value) = tolerance { value } else { 1e-5 }
}

/// The line about the given and the required right-hand side. It replaces the sum of the explanation's right-hand sides, for which the
/// whole system would be needed.
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

/// A line about equations that are not shown: `  and 480 more (why: qless explain a.inp 'row 12'): rows 12, 15, 19-22, ...`.
fn rest(list: &EquationList, others: &[&DependentRow]) -> String {
    let (count, first, input) = (others.len(), others[0].row + 1, quoted(list.input));
    let plural = if count == 1 { "" } else { "s" };
    rows(&format!("  and {count} more (why: qless explain {input} 'row {first}'): row{plural}"), others)
}

/// The text `first` and row numbers in one line: `first 12, 15, 19-22, ...`.
fn rows(first: &str, dependent: &[&DependentRow]) -> String {
    const TAIL: &str = ", ...";
    let rows: Vec<usize> = dependent.iter().map(|d| d.row + 1).collect();
    let pieces = ranges(&rows);
    // A line with a long label is wider, so that some rows fit.
    let columns = COLUMNS.max(width(first) + 30);
    let flowed = flow(first, "", &pieces, (1, columns), TAIL.len());
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
    let who =
        if report.counts.conflicting > 0 { "the equations that do not conflict leave" } else { "the equations leave" };
    let mut lines = vec![format!("Generated boundary conditions: {who} {what} one value only.")];
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
