//! What a solver does where two cards claim one DOF.

use qless_io::deck::clean::{Fault, faults_in};
use qless_io::deck::{Deck, LoadCase, Model, Outcome};
use serde::Serialize;

/// Pairs of cards, in words, by what becomes of them.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Claims {
    /// The solver stops.
    pub refused: Vec<String>,
    /// The solver drops one of the two without a word.
    pub ignored: Vec<Ignored>,
    /// Both hold.
    pub accepted: Vec<String>,
}

/// A claim that is dropped without a word.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Ignored {
    /// The card that has no effect on the DOF, where it is one.
    pub dropped: Option<String>,
    /// The two claims.
    pub claims: String,
}

impl Claims {
    /// Those of a load case.
    pub fn of(deck: &Deck, case: &LoadCase) -> Self {
        let model = deck.model();
        let mut claims = Self::default();
        for fault in faults_in(model, case) {
            let words = fault.describe(model);
            match deck.solver().outcome(&fault, model) {
                Outcome::Refused => claims.refused.push(words),
                Outcome::Accepted => claims.accepted.push(words),
                Outcome::IgnoresFirst => {
                    claims.ignored.push(Ignored { dropped: place(&fault, model, true), claims: words })
                }
                Outcome::IgnoresSecond => {
                    claims.ignored.push(Ignored { dropped: place(&fault, model, false), claims: words });
                }
            }
        }
        claims
    }

    /// Adds those of another load case that are not in it yet.
    pub fn unite(&mut self, other: &Self) {
        add(&mut self.refused, &other.refused);
        add(&mut self.ignored, &other.ignored);
        add(&mut self.accepted, &other.accepted);
    }

    /// `2 refused, 1 dropped`, of what is not accepted.
    pub fn summary(&self) -> Option<String> {
        let counts = [(self.refused.len(), "refused"), (self.ignored.len(), "dropped")];
        let some = counts.iter().filter(|(count, _)| *count > 0).map(|(count, what)| format!("{count} {what}"));
        Some(some.collect::<Vec<_>>().join(", ")).filter(|text| !text.is_empty())
    }
}

impl Ignored {
    /// `line 19 *BOUNDARY: 1:3 is the slave of ...`.
    pub fn words(&self) -> String {
        match &self.dropped {
            Some(dropped) => format!("{dropped}: {}", self.claims),
            None => self.claims.clone(),
        }
    }
}

fn add<T: Clone + PartialEq>(all: &mut Vec<T>, more: &[T]) {
    // Load cases repeat each other mostly whole.
    if all.is_empty() {
        all.extend_from_slice(more);
    } else if all.as_slice() != more {
        let fresh: Vec<T> = more.iter().filter(|item| !all.contains(item)).cloned().collect();
        all.extend(fresh);
    }
}

/// The first or the second of the two cards, in the order in which a fault names them.
fn place(fault: &Fault, model: &Model, first: bool) -> Option<String> {
    let of_equation = |i: usize| model.equation(i).map(|equation| model.place(equation.origin));
    match *fault {
        Fault::SlavePrescribed { equation, .. } if first => of_equation(equation),
        Fault::SlavePrescribed { by, .. } => Some(model.place(by)),
        Fault::SlaveTwice { first: earlier, .. } if first => of_equation(earlier),
        Fault::SlaveTwice { equation, .. } => of_equation(equation),
        _ => None,
    }
}
