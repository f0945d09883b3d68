//! The report for people: what is wrong, why, how sure that is, and what to do; at most 24 lines of [`COLUMNS`].
//!
//! The verdict comes first, in words. What does not fit is counted, and `--format json` holds all of it.

mod combination;
mod confidence;
mod dependent;
mod exact;
mod factored;
mod fit;
mod generated;
mod ignored;
mod meant;
pub mod name;
mod next;
mod number;
mod section;
pub mod told;
mod unmet;
mod verdict;
mod work;

use std::path::Path;

use qless::{Kind, Report};

use crate::diagnose::Diagnosis;
pub use section::Section;
use told::{Finding, Told};

/// No line is longer.
const COLUMNS: usize = 100;
/// No report has more, unless there is very much beside the equations to say.
const LINES: usize = 24;

/// What the command did after the diagnosis.
pub enum Outcome<'a> {
    /// Nothing: it was `check`.
    Checked,
    /// `reduce` wrote nothing because of what was found.
    Refused,
    /// `reduce` wrote its files to this folder.
    Written(&'a Path),
    /// `clean` wrote a deck, in which so many equations were left out and so many written anew.
    Cleaned {
        /// The deck.
        output: &'a Path,
        /// Equations taken out because they are redundant.
        removed: usize,
        /// Equations that took the place of others.
        written: usize,
    },
}

/// What was found, in one sentence.
pub fn verdict(report: &Report, is_deck: bool) -> String {
    verdict::line(report, is_deck)
}

/// What exact arithmetic says, if it was asked.
pub fn exact(diagnosis: &Diagnosis, report: &Report) -> Vec<String> {
    exact::lines(diagnosis, report)
}

/// The report, ending in a line break.
pub fn render(diagnosis: &Diagnosis, report: &Report, outcome: &Outcome) -> String {
    let because = |row| diagnosis.analysis.because(row).unwrap_or_default();
    let told = Told {
        input: &diagnosis.args.input,
        deck: diagnosis.deck.as_ref(),
        tolerance: diagnosis.options.tolerance,
        equations: &diagnosis.system,
        dependent: diagnosis.analysis.dependent().iter().map(Finding::from).collect(),
        because: &because,
    };
    let sections = diagnosis.deck.as_ref().map_or_else(Vec::new, |deck| deck.sections(&diagnosis.analysis));
    let mut doubts = meant::lines(diagnosis, report);
    doubts.extend(exact::lines(diagnosis, report));
    doubts.extend(ignored::line(diagnosis, report));
    whole(&told, report, outcome, &sections, doubts)
}

/// With what only some analyses have: sections of a deck, and doubts beside the rank.
pub fn whole(told: &Told, report: &Report, outcome: &Outcome, sections: &[Section], doubts: Vec<String>) -> String {
    let first = [verdict::line(report, told.deck.is_some()), verdict::input(report)];
    let last = rest(told, report, outcome, doubts);
    let generated = generated::section(report);
    let room = LINES.saturating_sub(first.len() + generated.len() + last.len());
    let (least, wanted) = section::needs(sections);
    let equations = dependent(told, report, room.saturating_sub(wanted).max(room.saturating_sub(least).min(5)));
    let sections = section::lines(sections, room.saturating_sub(equations.len()));
    let lines = first.into_iter().chain(equations).chain(generated).chain(sections).chain(last);
    lines.map(|line| fit::shorten(line.trim_end(), COLUMNS) + "\n").collect()
}

/// Dependent equations in at most so many lines, or the heading and one of each kind.
fn dependent(told: &Told, report: &Report, most: usize) -> Vec<String> {
    let both = report.counts.conflicting > 0 && report.counts.redundant > 0;
    let (conflicting, redundant) = if both { (7, 4) } else { (10, 9) };
    let mut lines =
        dependent::section(told, Kind::Conflicting, conflicting.min(if both { most / 2 } else { most }).max(3));
    lines.extend(dependent::section(told, Kind::Redundant, redundant.min(most.saturating_sub(lines.len())).max(3)));
    lines
}

/// How sure it is, how it was done, and what to do.
fn rest(told: &Told, report: &Report, outcome: &Outcome, doubts: Vec<String>) -> Vec<String> {
    let mut lines = Vec::new();
    if report.input.rows > 0 {
        lines.extend(confidence::lines(told, report));
        lines.extend(doubts);
        lines.push(work::presolve(report));
        lines.extend(work::backend(report));
    }
    lines.extend(unmet::lines(report));
    lines.extend(factored::lines(report));
    lines.push(work::time(report));
    lines.extend(next::lines(told, report, outcome));
    lines
}
