//! Repairs of conflicts in words. The text report, which has less room, counts the other ways only.

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

    /// `cure: change 4:1 from 0.5 to 0 (4 other ways cure too; 3 more were not verified)`.
    pub fn short(&self) -> String {
        let others = others(self.ways.len(), self.more).map(|others| format!(" ({others})"));
        format!("cure: {}{}", self.ways[0], others.unwrap_or_default())
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

/// `4 other ways cure too; 3 more were not verified`: the ways beside the first of the `listed` ones. None if there are no others.
pub fn others(listed: usize, unverified: usize) -> Option<String> {
    let cure = match listed.saturating_sub(1) {
        0 => None,
        1 => Some("1 other way cures too".to_owned()),
        n => Some(format!("{n} other ways cure too")),
    };
    let unknown = match unverified {
        0 => None,
        1 => Some("1 more was not verified".to_owned()),
        n => Some(format!("{n} more were not verified")),
    };
    let both: Vec<String> = cure.into_iter().chain(unknown).collect();
    (!both.is_empty()).then(|| both.join("; "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ways_that_were_not_verified_are_counted() {
        for (listed, unverified, expected) in [
            (1, 0, None),
            (2, 0, Some("1 other way cures too")),
            (1, 1, Some("1 more was not verified")),
            (16, 84, Some("15 other ways cure too; 84 more were not verified")),
        ] {
            assert_eq!(others(listed, unverified).as_deref(), expected);
        }
    }
}
