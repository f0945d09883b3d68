//! `--deny`: findings that end the program with exit code 1, beside conflicts.

use qless::{Kind, analyse};
use qless_io::deck::clean::findings;

use super::Diagnosis;
use crate::args::Deny;
use crate::deck_input::DeckInput;
use crate::wording::count;

impl Diagnosis<'_> {
    /// The findings that `--deny` names, in words.
    pub fn denied(&self) -> Vec<String> {
        let mut denied = self.args.deny.clone();
        denied.sort_unstable();
        denied.dedup();
        denied.into_iter().filter_map(|what| self.found(what)).collect()
    }

    fn found(&self, what: Deny) -> Option<String> {
        let claims = self.deck.as_ref().map(DeckInput::claims).unwrap_or_default();
        let some = |number: usize, what: &str| (number > 0).then(|| count(number, what));
        match what {
            Deny::Redundant => {
                let redundant = self.analysis.dependent().iter().filter(|found| found.kind == Kind::Redundant).count();
                some(redundant, "redundant equation")
            }
            Deny::Refused => some(claims.refused.len(), "claim that the solver refuses"),
            Deny::Dropped => some(claims.ignored.len(), "claim that the solver drops"),
            Deny::Lost => (!claims.ignored.is_empty() && self.is_lost()).then(|| "a claim that is lost".to_owned()),
            Deny::Ambiguous => {
                let is_ambiguous =
                    self.analysis.confidence().ambiguous || self.deck.as_ref().is_some_and(DeckInput::is_ambiguous);
                is_ambiguous.then(|| "an ambiguous rank".to_owned())
            }
            Deny::Incomplete => {
                let left_out = self.deck.as_ref().map_or(0, |deck| deck.deck.model().left_out().count());
                some(left_out, "constraint card that was left out")
            }
        }
    }

    /// Whether a dropped claim does not follow from the equations that the solver keeps, in any load case that was analysed. A dropped
    /// prescribed value counts as lost, and so does a claim if the analysis fails.
    fn is_lost(&self) -> bool {
        let Some(deck) = &self.deck else { return false };
        let model = deck.deck.model();
        deck.numbers().any(|number| {
            let case = &model.cases()[number];
            let dropped: Vec<Option<usize>> = findings(model, case, deck.deck.solver())
                .iter()
                .filter(|finding| finding.outcome.ignores())
                .map(qless_io::deck::clean::Finding::dropped)
                .collect();
            let rows: Vec<usize> = model.in_force(case).collect();
            let dropped_rows = |row: usize| dropped.contains(&Some(rows[row]));
            let kept: Vec<usize> = (0..rows.len()).filter(|&row| !dropped_rows(row)).collect();
            let mut options = self.options.clone();
            options.preferences.equations = kept;
            let analysis = model.system(case).ok().and_then(|system| analyse(&system, &options).ok());
            let follows = |row: usize| analysis.as_ref().is_some_and(|found| found.kinds()[row] == Kind::Redundant);
            dropped.contains(&None) || (0..rows.len()).any(|row| dropped_rows(row) && !follows(row))
        })
    }
}
