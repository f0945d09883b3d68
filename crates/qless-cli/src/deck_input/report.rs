//! The keys that only decks have, in JSON and on the HTML page.

use qless::report::{Counts, DependentEquation};
use qless::{Analysis, Status};
use serde::Serialize;

use super::claims::{Claims, DroppedClaim};
use super::{CaseResult, DeckInput};

/// Keys of the report that only decks have.
#[derive(Serialize)]
pub struct DeckReport<'a> {
    solver: SolverReport,
    cases: Vec<CaseReport<'a>>,
    deck: ShownCase,
}

/// The solver, and its reactions in any of the load cases.
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
    /// Name of the first load case that has the same constraints as this one; none if this one is the first.
    #[serde(skip_serializing_if = "Option::is_none")]
    same_as: Option<&'a str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    when: Option<&'a str>,
    solver: &'a Claims,
    dependent: &'a [DependentEquation],
}

/// The load case to report, with the reactions of the solver in all load cases that were analysed.
#[derive(Serialize)]
struct ShownCase {
    load_case: String,
    other_load_cases: Vec<String>,
    solver_refuses: Vec<String>,
    solver_implied: Vec<String>,
    solver_lost: Vec<String>,
    solver_unsound: Vec<String>,
    loads_without_effect: Vec<String>,
    warnings: Vec<String>,
}

impl DeckInput {
    pub fn report(&self, analysis: &Analysis) -> DeckReport<'_> {
        let claims = self.claims();
        DeckReport {
            cases: (0..self.cases.len()).map(|k| self.case_report(k)).collect(),
            deck: self.shown_case(analysis, &claims),
            solver: SolverReport { name: self.deck.solver().name(), claims },
        }
    }

    fn case_report(&self, k: usize) -> CaseReport<'_> {
        let case = &self.cases[k];
        let result = &self.results[case.result];
        let first =
            self.cases.iter().find(|other| other.result == case.result).filter(|first| first.number != case.number);
        CaseReport {
            name: self.name(case.number),
            status: result.status,
            rank: result.rank,
            counts: result.counts,
            same_as: first.map(|first| self.name(first.number)),
            when: result.when.as_deref(),
            solver: &result.claims,
            dependent: &result.dependent,
        }
    }

    fn shown_case(&self, analysis: &Analysis, claims: &Claims) -> ShownCase {
        let shown = self.shown();
        let others = self.results.iter().zip(0..).filter(|(result, _)| !std::ptr::eq(*result, shown));
        let other = |(result, k): (&CaseResult, usize)| {
            let first = self.cases.iter().find(|case| case.result == k).map_or("", |case| self.name(case.number));
            let Counts { independent, redundant, conflicting, .. } = result.counts;
            format!("{first}: {independent} independent, {redundant} redundant, {conflicting} conflicting")
        };
        ShownCase {
            load_case: self.name(self.case).to_owned(),
            other_load_cases: others.map(other).collect(),
            solver_refuses: claims.refused.clone(),
            solver_implied: claims.implied.iter().map(DroppedClaim::words).collect(),
            solver_lost: claims.lost.iter().map(DroppedClaim::words).collect(),
            solver_unsound: claims.unsound.clone(),
            loads_without_effect: self.loads_on_fixed_dofs(analysis),
            warnings: self.deck.model().warnings().iter().map(|warning| self.place(warning)).collect(),
        }
    }

    /// The name of a load case of the model.
    pub(super) fn name(&self, number: usize) -> &str {
        &self.deck.model().cases()[number].name
    }
}
