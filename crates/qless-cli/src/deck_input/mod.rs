//! A deck as input: analyses the chosen load cases, predicts the reactions of the solver, and lists constraints that were left out.

mod case_result;
mod choice;
mod claims;
mod reactions;
mod report;
mod sections;

use std::collections::BTreeSet;

use qless::{Analysis, ConstraintSystem, Options};
use qless_io::deck::{Deck, LoadCase};

use case_result::{CaseAnalysis, CaseResult, analyse_case};
pub use choice::LoadCaseChoice;
use claims::Claims;
pub use reactions::Reaction;
pub use report::DeckReport;

use crate::failure::{CliFailure, say};

/// Largest number of warnings shown; JSON has all of them.
const SHOWN: usize = 5;

/// A deck and the results of its load cases.
pub struct DeckInput {
    pub deck: Deck,
    /// Index of the load case to report: the first of those with the most severe result.
    pub case: usize,
    /// The load cases that were analysed, in the deck's order.
    cases: Vec<DeckLoadCase>,
    /// Results of the load cases. Load cases with the same constraints share one result.
    results: Vec<CaseResult>,
}

/// A load case that was analysed.
struct DeckLoadCase {
    /// Index of the load case in the model.
    number: usize,
    /// Index of the result in `results`.
    result: usize,
}

/// Analyses the system of a load case.
pub type AnalyseCase<'a> = &'a dyn Fn(&ConstraintSystem, (&Deck, &LoadCase)) -> Result<Analysis, CliFailure>;

impl DeckInput {
    /// Analyses the chosen load cases; returns the system and the analysis of the most severe one. All certificates together have at
    /// most `terms` terms.
    pub fn analyse(
        deck: Deck,
        choice: &LoadCaseChoice,
        options: &Options,
        terms: usize,
        analyse: AnalyseCase,
    ) -> Result<(ConstraintSystem, Analysis, Self), CliFailure> {
        let chosen = choice.select(deck.model()).map_err(|error| CliFailure::from_deck(&deck, &error))?;
        let terms = terms / chosen.len().max(1);
        let mut worst: Option<(usize, [usize; 6], CaseAnalysis)> = None;
        let (mut cases, mut results): (Vec<DeckLoadCase>, Vec<CaseResult>) = (Vec::new(), Vec::new());
        for number in chosen {
            let case = &deck.model().cases()[number];
            let same = cases.iter().find(|known| deck.model().cases()[known.number].constrains_as(case));
            if let Some(result) = same.map(|known| known.result) {
                cases.push(DeckLoadCase { number, result });
                continue;
            }
            let analysed = analyse_case(&deck, case, analyse)?;
            let result = CaseResult::new(&deck, case, &analysed, options, terms);
            if worst.as_ref().is_none_or(|(_, severity, _)| result.severity() > *severity) {
                worst = Some((number, result.severity(), analysed));
            }
            cases.push(DeckLoadCase { number, result: results.len() });
            results.push(result);
        }
        let Some((case, _, CaseAnalysis { system, analysis, .. })) = worst else {
            return Err(CliFailure::from_deck(&deck, &"the deck has no load case"));
        };
        Ok((system, analysis, Self { deck, case, cases, results }))
    }

    /// The result of the load case to report.
    fn shown(&self) -> &CaseResult {
        let case = self.cases.iter().find(|case| case.number == self.case);
        &self.results[case.map_or(0, |case| case.result)]
    }

    /// The claims of all load cases.
    pub fn claims(&self) -> Claims {
        let mut claims = Claims::default();
        self.results.iter().for_each(|result| claims.merge(&result.claims));
        claims
    }

    /// Whether the rank is ambiguous in any load case.
    pub fn is_ambiguous(&self) -> bool {
        self.results.iter().any(|result| result.is_ambiguous)
    }

    /// Whether the solver stops, loses claims or computes unreliable results in any load case.
    pub fn needs_cleaning(&self) -> bool {
        let claims = self.claims();
        !claims.refused.is_empty() || !claims.lost.is_empty() || !claims.unsound.is_empty()
    }

    /// Number of claims that the solver loses in any load case; 0 if the solver refuses the deck.
    pub fn lost(&self) -> usize {
        if self.results.iter().any(|result| !result.claims.refused.is_empty()) {
            return 0;
        }
        let lost = self.results.iter().flat_map(|result| &result.claims.lost);
        lost.map(|lost| lost.claims.as_str()).collect::<BTreeSet<&str>>().len()
    }

    /// Constraints that were not read, each with its place in the deck.
    pub fn left_out(&self) -> Vec<String> {
        self.deck.model().left_out().map(|warning| self.place(warning)).collect()
    }

    /// Writes warnings to standard error; the report lists the constraints that were left out.
    pub fn warn(&self) {
        let warnings: Vec<_> = self.deck.model().warnings().iter().filter(|warning| !warning.leaves_out).collect();
        warnings.iter().take(SHOWN).for_each(|warning| say(format_args!("warning: {}", self.place(warning))));
        if warnings.len() > SHOWN {
            say(format_args!("warning: and {} more (all of them: --format json)", warnings.len() - SHOWN));
        }
    }

    /// A warning with its place: `deck.inp:14: ...`.
    fn place(&self, warning: &qless_io::deck::Warning) -> String {
        let file = self.deck.model().files()[warning.file as usize].display();
        match warning.line {
            0 => format!("{file}: {}", warning.text),
            line => format!("{file}:{line}: {}", warning.text),
        }
    }
}
