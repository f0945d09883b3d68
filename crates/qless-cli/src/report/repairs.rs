//! Repairs of conflicts in words, for all reports but the text, which has less room.

use qless::Report;
use qless::report::{ChangeFinding, RepairFinding};
use serde::Serialize;

use crate::wording::{change, printable};

/// The repairs of conflicts that share numbers. Each repair is a list of changes, which alone cures all these conflicts.
#[derive(Serialize)]
pub struct RepairWords {
    /// The conflicting rows, from 1. Each repair in `ways` cures all of them.
    pub rows: Vec<usize>,
    /// The repairs in words, the most plausible one first.
    pub ways: Vec<String>,
    /// Number of further repairs, which are not listed and were not verified.
    pub more: usize,
}

impl RepairWords {
    /// The repairs of all conflicts in a report for which a repair is known.
    pub fn all(report: &Report) -> Vec<Self> {
        report.repairs.iter().filter_map(Self::new).collect()
    }

    /// The repairs of one group of conflicts in words; `None` if no repair is known.
    pub fn new(repair: &RepairFinding) -> Option<Self> {
        let of_way = |way: &Vec<ChangeFinding>| {
            let changes: Vec<String> = way.iter().map(|one| change(one, printable::line)).collect();
            changes.join("; and ")
        };
        let ways: Vec<String> = repair.ways.iter().map(of_way).collect();
        let more = repair.count.saturating_sub(ways.len());
        (!ways.is_empty()).then(|| Self { rows: repair.conflicts.clone(), more, ways })
    }

    /// The first repair in words, and the number of others: `cure: change 4:1 from 0.5 to 0 (4 other ways cure too)`.
    pub fn short(&self) -> String {
        let others = match self.ways.len() - 1 {
            0 => String::new(),
            1 => " (1 other way cures too)".to_owned(),
            n => format!(" ({n} other ways cure too)"),
        };
        format!("cure: {}{others}", self.ways[0])
    }

    /// The heading above the repairs of `row`: `Each of these 5 ways cures it, and rows 52, 79:`.
    pub fn heading(&self, row: usize) -> String {
        /// Largest number of rows that are named.
        const NAMED: usize = 12;
        let these = match self.ways.len() {
            1 => "This cures it".to_owned(),
            n => format!("Each of these {n} ways cures it"),
        };
        let others: Vec<String> = self.rows.iter().filter(|&&other| other != row).map(usize::to_string).collect();
        match others.len() {
            0 => format!("{these}:"),
            1 => format!("{these}, and row {}:", others[0]),
            2..=NAMED => format!("{these}, and rows {}:", others.join(", ")),
            n => format!("{these}, and {n} other conflicts:"),
        }
    }
}
