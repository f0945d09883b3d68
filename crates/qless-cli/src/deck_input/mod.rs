//! A deck as input: every load case analysed, what its solver makes of cards that claim one DOF, and what was left out.

mod choice;
mod claims;
mod found;
mod report;
mod sections;

use std::collections::BTreeSet;

use qless::{Analysis, ConstraintSystem};
use qless_io::deck::{Deck, LoadCase};

pub use choice::LoadCaseChoice;
use claims::Claims;
use found::{Examined, Found, examine};
pub use report::DeckReport;

use crate::failure::{CliFailure, say};

/// Warnings shown at most; JSON has all of them.
const SHOWN: usize = 5;

/// A deck, and the load case that the report is about.
pub struct DeckInput {
    pub deck: Deck,
    /// The load case with the worst diagnosis, the first of them; what the solver makes of it breaks ties.
    pub case: usize,
    /// The load cases that were looked at, in the deck's order.
    cases: Vec<DeckLoadCase>,
    /// The results of load cases that constrain differently.
    found: Vec<Found>,
}

/// A load case that was looked at.
struct DeckLoadCase {
    /// Its number in the model, from 0.
    number: usize,
    /// Index of its result, which load cases that constrain the same share.
    found: usize,
}

/// Analyses the system of a load case.
pub type Run<'a> = &'a dyn Fn(&ConstraintSystem, (&Deck, &LoadCase)) -> Result<Analysis, CliFailure>;

impl DeckInput {
    /// Analyses the load cases that were chosen and keeps the worst; certificates of all of them have at most `terms` terms.
    pub fn analyse(
        deck: Deck,
        choice: &LoadCaseChoice,
        terms: usize,
        run: Run,
    ) -> Result<(ConstraintSystem, Analysis, Self), CliFailure> {
        let chosen = choice.of(deck.model()).map_err(|error| CliFailure::of_deck(&deck, &error))?;
        let terms = terms / chosen.len().max(1);
        let mut worst: Option<(usize, usize, Examined)> = None;
        let (mut cases, mut found): (Vec<DeckLoadCase>, Vec<Found>) = (Vec::new(), Vec::new());
        for number in chosen {
            let case = &deck.model().cases()[number];
            let same = cases.iter().find(|known| deck.model().cases()[known.number].constrains_as(case));
            if let Some(same) = same.map(|known| known.found) {
                cases.push(DeckLoadCase { number, found: same });
                continue;
            }
            let examined = examine(&deck, case, run)?;
            cases.push(DeckLoadCase { number, found: found.len() });
            found.push(Found::of(&deck, case, &examined, terms));
            let of = |k: usize| found[k].badness();
            if worst.as_ref().is_none_or(|(_, before, _)| of(found.len() - 1) > of(*before)) {
                worst = Some((number, found.len() - 1, examined));
            }
        }
        let Some((case, _, Examined { system, analysis, .. })) = worst else {
            return Err(CliFailure::of_deck(&deck, &"the deck has no load case"));
        };
        Ok((system, analysis, Self { deck, case, cases, found }))
    }

    /// The result of the load case that the report is about.
    fn shown(&self) -> &Found {
        let case = self.cases.iter().find(|case| case.number == self.case);
        &self.found[case.map_or(0, |case| case.found)]
    }

    /// The claims of all load cases.
    pub fn claims(&self) -> Claims {
        let mut claims = Claims::default();
        self.found.iter().for_each(|found| claims.unite(&found.solver));
        claims
    }

    /// Whether the solver stops or goes wrong in any load case.
    pub fn needs_cleaning(&self) -> bool {
        self.found.iter().any(|found| !found.solver.refused.is_empty() || !found.solver.unsound.is_empty())
    }

    /// Claims that the solver drops in any load case; none where it does not run the deck at all.
    pub fn dropped(&self) -> usize {
        if self.found.iter().any(|found| !found.solver.refused.is_empty()) {
            return 0;
        }
        let all: BTreeSet<&str> =
            self.found.iter().flat_map(|f| &f.solver.ignored).map(|i| i.claims.as_str()).collect();
        all.len()
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

    /// `deck.inp:14: ...`.
    fn place(&self, warning: &qless_io::deck::Warning) -> String {
        let file = self.deck.model().files()[warning.file as usize].display();
        match warning.line {
            0 => format!("{file}: {}", warning.text),
            line => format!("{file}:{line}: {}", warning.text),
        }
    }
}
