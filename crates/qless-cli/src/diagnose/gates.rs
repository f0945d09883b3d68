//! `--deny`: findings that end the program with exit code 1, beside conflicts.

use clap::ValueEnum;
use qless::Kind;

use super::Diagnosis;
use crate::args::Deny;
use crate::deck_input::DeckInput;
use crate::wording::count;

impl Diagnosis<'_> {
    /// The findings that `--deny` names, in words.
    pub fn denied(&self) -> Vec<String> {
        let mut denied = self.report_args.deny.clone();
        denied.sort_unstable();
        denied.dedup();
        denied.into_iter().filter_map(|what| self.found(what)).collect()
    }

    /// All findings in words, conflicts first; empty if there is nothing to mend. What the solver drops without effect needs no mending.
    pub fn findings(&self) -> Vec<String> {
        let conflicts = self.analysis.dependent().iter().filter(|found| found.kind == Kind::Conflicting).count();
        let conflicts = (conflicts > 0).then(|| count(conflicts, "conflicting equation"));
        let others = Deny::value_variants().iter().filter(|what| **what != Deny::Dropped);
        conflicts.into_iter().chain(others.filter_map(|&what| self.found(what))).collect()
    }

    fn found(&self, what: Deny) -> Option<String> {
        let claims = self.deck.as_ref().map(DeckInput::claims).unwrap_or_default();
        let some = |number: usize, what: &str| (number > 0).then(|| count(number, what));
        match what {
            Deny::Redundant => {
                let redundant = self.analysis.dependent().iter().filter(|found| found.kind == Kind::Redundant).count();
                some(redundant, "redundant equation")
            }
            Deny::Refused => some(claims.refused.len(), "refused claim"),
            Deny::Dropped => some(claims.dropped(), "dropped claim"),
            Deny::Lost => some(claims.lost.len(), "lost claim"),
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
}
