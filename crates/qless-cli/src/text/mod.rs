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
pub mod told;
mod unmet;
mod verdict;
mod work;

use std::path::Path;

use qless::{Kind, Report};

use crate::diagnose::Diagnosis;
use told::{Finding, Told};

/// No line is longer.
const COLUMNS: usize = 100;

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
pub fn verdict(report: &Report) -> String {
    verdict::line(report)
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
    let of_deck = diagnosis.deck.iter().flat_map(|deck| deck.lines(diagnosis)).collect();
    let mut doubts = meant::lines(diagnosis, report);
    doubts.extend(exact::lines(diagnosis, report));
    doubts.extend(ignored::line(diagnosis, report));
    whole(&told, report, outcome, [of_deck, doubts])
}

/// With lines that only some analyses have: of a deck, and beside the rank.
pub fn whole(told: &Told, report: &Report, outcome: &Outcome, [of_deck, doubts]: [Vec<String>; 2]) -> String {
    let both = report.counts.conflicting > 0 && report.counts.redundant > 0;
    let mut lines = vec![verdict::line(report), verdict::input(report)];
    lines.extend(dependent::section(told, Kind::Conflicting, if both { 7 } else { 10 }));
    lines.extend(dependent::section(told, Kind::Redundant, if both { 4 } else { 9 }));
    lines.extend(generated::section(report));
    lines.extend(of_deck);
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
    lines.iter().map(|line| fit::shorten(line.trim_end(), COLUMNS) + "\n").collect()
}
