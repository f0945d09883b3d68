//! The sections of the text report that only decks have.

use std::collections::HashMap;

use qless::Analysis;
use qless_io::deck::{Dof, Load, Solver};

use super::DeckInput;
use super::claims::{Claims, DroppedClaim};
use crate::wording::count;
use crate::wording::layout::LayoutSection;

impl DeckInput {
    /// The sections of the report, the most important one first.
    pub fn sections(&self, analysis: &Analysis) -> Vec<LayoutSection> {
        let (solver, shown) = (self.deck.solver(), self.shown());
        let words = |claims: &[DroppedClaim]| {
            grouped(claims.iter().map(|claim| (claim.dropped.as_str(), claim.claims.as_str())))
        };
        let sections = [
            LayoutSection::new("Constraints that were left out:", self.left_out()),
            self.table(),
            LayoutSection::new(
                format!("{solver} refuses the deck for these reasons:"),
                grouped(shown.claims.refused.iter().map(|claim| ("", claim.as_str()))),
            ),
            LayoutSection::new(lost_heading(solver, &shown.claims), words(&shown.claims.lost)),
            LayoutSection::new(
                format!("{solver} drops these claims without effect: they follow from what it keeps:"),
                words(&shown.claims.implied),
            ),
            LayoutSection::new(
                format!("{solver} may continue with these, but its results are then unreliable:"),
                grouped(shown.claims.unsound.iter().map(|claim| ("", claim.as_str()))),
            ),
            LayoutSection::new(
                "Loads without effect, on DOFs that the equations fix:",
                self.loads_on_fixed_dofs(analysis),
            ),
        ];
        sections.into_iter().flatten().collect()
    }

    /// One line for each group of load cases with the same constraints, the reported one first.
    fn table(&self) -> Option<LayoutSection> {
        let shown = self.shown();
        let when = shown.when.as_ref().map_or(String::new(), |when| format!(", {when}"));
        let mut order: Vec<usize> = (0..self.results.len()).collect();
        order.sort_by_key(|&k| !std::ptr::eq(&raw const self.results[k], shown));
        let rows = order.into_iter().map(|k| self.row(k)).collect();
        let name = self.name(self.case);
        match (self.cases.len(), self.deck.model().cases().len()) {
            (1, 1) if shown.when.is_some() => LayoutSection::new(format!("Load case {name}{when}."), vec![self.row(0)]),
            (1, 1) => None,
            (1, all) => LayoutSection::new(format!("Load case: {name} of {all}{when}."), rows),
            (count, _) => LayoutSection::new(format!("Load cases: {count}, shown is {name}{when}."), rows),
        }
    }

    /// A line for the load cases that share result k: `step 1 and 4 alike: rank 12, 0 redundant, 0 conflicting; 2 refused`.
    fn row(&self, k: usize) -> String {
        let alike: Vec<&str> =
            self.cases.iter().filter(|case| case.result == k).map(|case| self.name(case.number)).collect();
        let names = match alike[..] {
            [] => String::new(),
            [one] => one.to_owned(),
            [one, other] => format!("{one} and {other}"),
            [one, ..] => format!("{one} and {} alike", alike.len() - 1),
        };
        let result = &self.results[k];
        let solver = result.claims.summary().map_or(String::new(), |text| format!("; {}: {text}", self.deck.solver()));
        format!("{names}: {}{solver}", result.summary())
    }

    /// Loads on DOFs that the equations fix.
    pub fn loads_on_fixed_dofs(&self, analysis: &Analysis) -> Vec<String> {
        let model = self.deck.model();
        let is_fixed = |dof: Dof| {
            let column = model.column(dof).map(|j| j as usize);
            column.is_some_and(|j| analysis.generated().binary_search_by_key(&j, |fixed| fixed.0).is_ok())
        };
        let name = |load: &Load| format!("{} in {}", load.dof, model.place(load.origin));
        model.cases()[self.case].loads.iter().filter(|load| is_fixed(load.dof)).map(name).collect()
    }
}

/// Largest number of DOFs that a line about several names; JSON has all of them.
const NAMED: usize = 6;

/// Claims that differ in the DOF only.
struct ClaimGroup<'a> {
    /// The card that is dropped; empty if none is.
    dropped: &'a str,
    /// The words after the DOF.
    rest: &'a str,
    /// The DOFs.
    names: Vec<String>,
    /// The words of the first claim.
    first: &'a str,
}

impl ClaimGroup<'_> {
    /// `28:1, 28:2 and 25 more: each is the slave of line 171 *TIE, and of line 176 *RIGID BODY`; a single claim in its own words.
    fn words(&self) -> String {
        let Self { dropped, rest, names, first } = self;
        let more = names.len().saturating_sub(NAMED);
        let more = if more > 0 { format!(" and {more} more") } else { String::new() };
        let shown = names[..names.len().min(NAMED)].join(", ");
        let words = match names.len() {
            1 => (*first).to_owned(),
            _ if *rest == CIRCLE => {
                format!("{shown}{more} depend on one another in a circle: their equations do not determine them")
            }
            _ => format!("{shown}{more}: each {rest}"),
        };
        if dropped.is_empty() { words } else { format!("{dropped}: {words}") }
    }
}

/// Claims, each with the card that is dropped or without one, in words. Those that differ in the DOF only become one line.
fn grouped<'a>(claims: impl Iterator<Item = (&'a str, &'a str)>) -> Vec<String> {
    let mut groups: Vec<ClaimGroup> = Vec::new();
    let mut place = HashMap::new();
    for (dropped, claim) in claims {
        let (name, rest) = split(claim);
        let k = *place.entry((dropped, rest)).or_insert(groups.len());
        if k == groups.len() {
            groups.push(ClaimGroup { dropped, rest, names: Vec::new(), first: claim });
        }
        groups[k].names.push(name);
    }
    groups.iter().map(ClaimGroup::words).collect()
}

/// The end of the words about a slave of a circle.
const CIRCLE: &str = "depends on itself through other slaves, and inserting their equations does not determine it";

/// The DOF of a claim, for a circle with its equation, and the rest of the words.
fn split(claim: &str) -> (String, &str) {
    if let Some(start) = claim.strip_suffix(CIRCLE) {
        let (dof, place) = start.trim_end_matches(", ").split_once(", the slave of ").unwrap_or((start, ""));
        return (format!("{dof} ({place})"), CIRCLE);
    }
    match claim.split_once(' ') {
        Some((dof, rest)) if rest.starts_with("is ") => (dof.to_owned(), rest),
        _ => (String::new(), claim),
    }
}

/// Largest number of free motions that are named; JSON has all of them.
const FREED_SHOWN: usize = 8;

/// The heading of lost claims: `LOST: ccx drops 12 claims that the rest does not imply; 2 motions come free, 101:1, 104:3:`.
fn lost_heading(solver: Solver, claims: &Claims) -> String {
    let motions = match &claims.freed[..] {
        [] => "no motion comes free".to_owned(),
        [one] => format!("1 motion comes free, {one} or what it was tied to"),
        all if all.len() <= FREED_SHOWN => {
            format!("{} motions come free, {} or what they were tied to", all.len(), all.join(", "))
        }
        all => {
            let shown = all[..FREED_SHOWN].join(", ");
            format!("{} motions come free, {shown} and others, or what they were tied to", all.len())
        }
    };
    format!("LOST: {solver} drops {} that the rest does not imply; {motions}:", count(claims.lost.len(), "claim"))
}
