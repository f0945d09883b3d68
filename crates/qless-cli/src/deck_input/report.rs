//! The keys of JSON and of the page that only decks have.

use qless::report::{Counts, DependentEquation};
use qless::{Analysis, Status};
use serde::Serialize;

use super::DeckInput;
use super::claims::Claims;

/// Keys of the report that only decks have.
#[derive(Serialize)]
pub struct DeckReport<'a> {
    solver: SolverReport,
    cases: Vec<CaseReport<'a>>,
    deck: OfCase,
}

/// The solver whose behaviour counts, and what it does in any load case.
#[derive(Serialize)]
struct SolverReport {
    name: &'static str,
    #[serde(flatten)]
    claims: Claims,
}

/// One load case.
#[derive(Serialize)]
struct CaseReport<'a> {
    name: &'a str,
    status: Status,
    rank: usize,
    counts: Counts,
    /// The first load case that constrains the same.
    #[serde(skip_serializing_if = "Option::is_none")]
    same_as: Option<&'a str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    when: Option<&'a str>,
    solver: &'a Claims,
    dependent: &'a [DependentEquation],
}

/// The load case that the report is about; what the solver does is that of all load cases looked at.
#[derive(Serialize)]
struct OfCase {
    load_case: String,
    other_load_cases: Vec<String>,
    solver_refuses: Vec<String>,
    solver_ignores: Vec<String>,
    solver_unsound: Vec<String>,
    loads_without_effect: Vec<String>,
    warnings: Vec<String>,
}

impl DeckInput {
    /// For JSON and the page.
    pub fn report(&self, analysis: &Analysis) -> DeckReport<'_> {
        let claims = self.claims();
        DeckReport {
            cases: (0..self.cases.len()).map(|k| self.case_report(k)).collect(),
            deck: self.of_case(analysis, &claims),
            solver: SolverReport { name: self.deck.solver().name(), claims },
        }
    }

    fn case_report(&self, k: usize) -> CaseReport<'_> {
        let case = &self.cases[k];
        let found = &self.found[case.found];
        let first =
            self.cases.iter().find(|other| other.found == case.found).filter(|first| first.number != case.number);
        CaseReport {
            name: self.name(case.number),
            status: found.status,
            rank: found.rank,
            counts: found.counts,
            same_as: first.map(|first| self.name(first.number)),
            when: found.when.as_deref(),
            solver: &found.solver,
            dependent: &found.dependent,
        }
    }

    fn of_case(&self, analysis: &Analysis, claims: &Claims) -> OfCase {
        let shown = self.shown();
        let others = self.found.iter().zip(0..).filter(|(found, _)| !std::ptr::eq(*found, shown));
        let other = |(found, k)| {
            let first = self.cases.iter().find(|case| case.found == k).map_or("", |case| self.name(case.number));
            let counts = found_counts(found);
            format!("{first}: {counts}")
        };
        OfCase {
            load_case: self.name(self.case).to_owned(),
            other_load_cases: others.map(other).collect(),
            solver_refuses: claims.refused.clone(),
            solver_ignores: claims.ignored.iter().map(super::claims::IgnoredClaims::words).collect(),
            solver_unsound: claims.unsound.clone(),
            loads_without_effect: self.swallowed(analysis),
            warnings: self.deck.model().warnings().iter().map(|warning| self.place(warning)).collect(),
        }
    }

    /// The name of a load case of the model.
    pub(super) fn name(&self, number: usize) -> &str {
        &self.deck.model().cases()[number].name
    }
}

fn found_counts(found: &super::Found) -> String {
    let Counts { independent, redundant, conflicting, .. } = found.counts;
    format!("{independent} independent, {redundant} redundant, {conflicting} conflicting")
}
