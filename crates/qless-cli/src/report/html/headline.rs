//! The top of the page: what is wrong with the equations and in the solver, in the colour of the worst finding.

use qless::{Report, Status};
use serde::Serialize;

use crate::deck_input::DeckInput;
use crate::diagnose::Diagnosis;
use crate::report::text;
use crate::wording::count;

/// Sentences, the worst finding first, and a colour.
#[derive(Serialize)]
pub struct Headline {
    colour: Colour,
    sentences: Vec<String>,
}

#[derive(Clone, Copy, Serialize)]
#[serde(rename_all = "lowercase")]
enum Colour {
    /// Nothing was found.
    Good,
    /// Redundant equations, claims that are dropped without effect, an ambiguous rank, or constraints that were left out.
    Doubtful,
    /// Equations conflict, or the solver stops or solves another problem.
    Bad,
}

impl Headline {
    pub fn new(diagnosis: &Diagnosis, report: &Report) -> Self {
        let deck = diagnosis.deck.as_ref();
        let mut sentences = deck.map_or_else(Vec::new, of_solver);
        let is_conflicting = report.counts.conflicting > 0;
        let is_bad = is_conflicting || !sentences.is_empty();
        let verdict = text::verdict_on_equations(report, deck.is_some());
        sentences.insert(if is_conflicting { 0 } else { sentences.len() }, verdict);
        let is_ambiguous = report.confidence.ambiguous || deck.is_some_and(DeckInput::is_ambiguous);
        if is_ambiguous && !report.confidence.ambiguous {
            sentences.push("The rank of another load case is ambiguous.".to_owned());
        }
        let drops = deck.is_some_and(|deck| deck.claims().dropped() > 0);
        let colour = match report.status {
            _ if is_bad => Colour::Bad,
            Status::Independent if !is_ambiguous && !drops => Colour::Good,
            _ => Colour::Doubtful,
        };
        Self { colour, sentences }
    }
}

/// Sentences about reactions that keep the solver from the solution of the deck, in any load case.
fn of_solver(deck: &DeckInput) -> Vec<String> {
    let (solver, claims) = (deck.deck.solver(), deck.claims());
    let reasons = |list: &[String]| count(list.len(), "reason");
    let free = |freed: usize| match freed {
        0 => "no motion comes".to_owned(),
        1 => "1 motion comes".to_owned(),
        n => format!("{n} motions come"),
    };
    let sentences = [
        (claims.refused.len(), format!("{solver} refuses the deck, for {}.", reasons(&claims.refused))),
        (
            claims.lost.len(),
            format!(
                "{solver} drops {} that the rest does not imply; {} free.",
                count(claims.lost.len(), "claim"),
                free(claims.freed.len())
            ),
        ),
        (
            claims.unsound.len(),
            format!("{solver} may continue, but its results are unreliable, for {}.", reasons(&claims.unsound)),
        ),
    ];
    sentences.into_iter().filter(|(found, _)| *found > 0).map(|(_, sentence)| sentence).collect()
}
