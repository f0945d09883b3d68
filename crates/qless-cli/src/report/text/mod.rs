//! The report as text of at most 24 lines, and two more if a conflict needs them. It has the verdict, dependent equations with
//! certificates, confidence and advice.
//!
//! Items that do not fit are counted; `--format json` has all of them.

mod combination;
mod confidence;
mod dependent;
mod next;
mod summary;

use std::path::Path;

use qless::explanation::{Explanation, Member};
use qless::{ConstraintSystem, Kind, Report, Tolerance};

use super::CommandOutcome;
use crate::deck_input::DeckInput;
use crate::diagnose::Diagnosis;
use crate::wording::EquationLookup;
use crate::wording::layout::{LayoutSection, section_lines, section_needs};
pub use dependent::remainder;
pub use summary::verdict_on_equations;

/// Largest width, in columns, of lists of rows, members and DOFs; sentences are not limited.
const COLUMNS: usize = 100;
/// Largest number of lines of a report, unless the sections of a deck need more.
const LINES: usize = 24;

/// A redundant or conflicting equation.
#[derive(Clone, Copy)]
pub struct DependentRow {
    pub row: usize,
    pub kind: Kind,
    pub mismatch: f64,
    pub relative_mismatch: f64,
    pub dropped: f64,
}

/// A model and its dependent equations, which one process or several ranks analysed.
pub struct EquationList<'a> {
    pub input: &'a Path,
    pub deck: Option<&'a DeckInput>,
    pub tolerance: Tolerance,
    pub equations: &'a dyn EquationLookup,
    pub dependent: Vec<DependentRow>,
    /// Number of loads on DOFs that the equations fix.
    pub idle_loads: usize,
    /// The system, if this process holds all of it.
    pub system: Option<&'a ConstraintSystem>,
    pub explain: &'a dyn Fn(usize) -> Option<Explanation>,
}

impl From<&qless::Dependent> for DependentRow {
    fn from(found: &qless::Dependent) -> Self {
        let &qless::Dependent { row, kind, mismatch, relative_mismatch, dropped, .. } = found;
        Self { row, kind, mismatch, relative_mismatch, dropped }
    }
}

/// A member of an explanation: `row 3 "tie A/B"`, or `[4:1 = 0.5, line 17 *BOUNDARY]`.
pub fn member_name(system: &ConstraintSystem, member: Member) -> String {
    combination::name((system, Some(system)), member)
}

/// The report of one process.
pub fn render(diagnosis: &Diagnosis, report: &Report, outcome: &CommandOutcome) -> String {
    let explain = |row| diagnosis.analysis.explain(row).ok().flatten();
    let sections = diagnosis.deck.as_ref().map_or_else(Vec::new, |deck| deck.sections(&diagnosis.analysis));
    whole(&list(diagnosis, &explain), report, outcome, &sections, doubts(diagnosis, report))
}

/// The last lines of the text report, without their indentation: certainty, presolve, backend and time, and what to do next.
pub fn last_lines(diagnosis: &Diagnosis, report: &Report, outcome: &CommandOutcome) -> [Vec<String>; 2] {
    let list = list(diagnosis, &|_| None);
    let plain = |lines: Vec<String>| lines.iter().map(|line| line.trim().to_owned()).collect();
    let facts = std::iter::once(summary::input(report)).chain(facts(&list, report, doubts(diagnosis, report)));
    [plain(facts.collect()), plain(next::lines(&list, report, outcome))]
}

fn list<'a>(diagnosis: &'a Diagnosis, explain: &'a dyn Fn(usize) -> Option<Explanation>) -> EquationList<'a> {
    EquationList {
        input: &diagnosis.args.input,
        deck: diagnosis.deck.as_ref(),
        tolerance: diagnosis.options.tolerance,
        equations: &diagnosis.system,
        idle_loads: diagnosis.deck.as_ref().map_or(0, |deck| deck.loads_on_fixed_dofs(&diagnosis.analysis).len()),
        dependent: diagnosis.analysis.dependent().iter().map(DependentRow::from).collect(),
        system: Some(&diagnosis.system),
        explain,
    }
}

/// Lines about doubts in the rank; there may be none.
fn doubts(diagnosis: &Diagnosis, report: &Report) -> Vec<String> {
    let mut doubts = confidence::near_dependence(diagnosis, report);
    doubts.extend(confidence::exact_rank(diagnosis, report));
    doubts.extend(confidence::noise(diagnosis, report));
    doubts
}

/// The report with sections of a deck and lines about doubts, which may be empty.
pub fn whole(
    list: &EquationList,
    report: &Report,
    outcome: &CommandOutcome,
    sections: &[LayoutSection],
    doubts: Vec<String>,
) -> String {
    let first = [summary::verdict(report, list.deck), summary::input(report)];
    let mut last = facts(list, report, doubts);
    last.extend(next::lines(list, report, outcome));
    let generated = dependent::generated_conditions(report);
    let room = LINES.saturating_sub(first.len() + generated.len() + last.len());
    let (least, wanted) = section_needs(sections);
    let equations = dependent(list, report, room.saturating_sub(wanted).max(room.saturating_sub(least).min(5)));
    let sections = section_lines(sections, room.saturating_sub(equations.len()));
    let lines = first.into_iter().chain(equations).chain(generated).chain(sections).chain(last);
    lines.map(|line| line.trim_end().to_owned() + "\n").collect()
}

/// Dependent equations in about `most` lines; one conflict is always explained in full.
fn dependent(list: &EquationList, report: &Report, most: usize) -> Vec<String> {
    let both = report.counts.conflicting > 0 && report.counts.redundant > 0;
    // One explained conflict takes six lines: the heading, four lines of members, and its arithmetic. One more line counts the others.
    let (conflicting, redundant) = if both { (6, 3) } else { (10.min(most).max(7), 9) };
    let mut lines = dependent::section(list, Kind::Conflicting, conflicting);
    lines.extend(dependent::section(list, Kind::Redundant, redundant.min(most.saturating_sub(lines.len())).max(3)));
    lines
}

/// Lines about confidence, backend and time.
fn facts(list: &EquationList, report: &Report, doubts: Vec<String>) -> Vec<String> {
    let mut lines = Vec::new();
    if report.input.rows > 0 {
        lines.extend(confidence::rank(list, report));
        lines.push(summary::effort(report));
        lines.extend(summary::proof(report));
        lines.extend(doubts);
        lines.push(summary::presolve(report));
        lines.extend(summary::backend(report));
    }
    lines.extend(summary::unmet_preferences(report));
    lines.extend(summary::factored_blocks(report));
    lines.push(summary::time(report));
    lines
}
