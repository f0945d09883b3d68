//! The behaviour of a solver if two cards claim one DOF.

use qless_io::deck::clean::{EquationFault, Finding, findings};
use qless_io::deck::{Deck, LoadCase, Model, Outcome, Prescribed};
use serde::Serialize;

/// Pairs of cards, in words, by what becomes of them.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Claims {
    /// The solver stops.
    pub refused: Vec<String>,
    /// The solver drops one of the two without a word.
    pub ignored: Vec<IgnoredClaims>,
    /// The solver may go on, with results that are not to be relied on.
    pub unsound: Vec<String>,
    /// Both hold.
    pub accepted: Vec<String>,
}

/// A claim that is dropped without a word.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct IgnoredClaims {
    /// The card that has no effect on the DOF.
    pub dropped: String,
    /// The two claims.
    pub claims: String,
}

impl Claims {
    /// Those of a load case.
    pub fn of(deck: &Deck, case: &LoadCase) -> Self {
        let (model, solver) = (deck.model(), deck.solver());
        let mut claims = Self::default();
        for finding in findings(model, case, solver) {
            claims.add(finding.outcome, finding.fault.describe(model), |_| dropped(&finding, model));
        }
        for (first, second) in values(case) {
            let place = |given: &Prescribed| model.place(given.origin);
            let words = format!("{} is prescribed in {}, and otherwise in {}", first.dof, place(first), place(second));
            claims.add(solver.prescribed_twice(), words, |is_first| place(if is_first { first } else { second }));
        }
        let stops = model.refusals().iter().map(|refusal| format!("{}: {}", model.place_of(refusal), refusal.text));
        claims.refused.extend(stops);
        claims
    }

    fn add(&mut self, outcome: Outcome, claims: String, dropped: impl Fn(bool) -> String) {
        match outcome {
            Outcome::Refused => self.refused.push(claims),
            Outcome::Accepted => self.accepted.push(claims),
            Outcome::Unsound => self.unsound.push(claims),
            Outcome::IgnoresFirst => self.ignored.push(IgnoredClaims { dropped: dropped(true), claims }),
            Outcome::IgnoresSecond => self.ignored.push(IgnoredClaims { dropped: dropped(false), claims }),
        }
    }

    /// Adds those of another load case that are not in it yet.
    pub fn unite(&mut self, other: &Self) {
        add(&mut self.refused, &other.refused);
        add(&mut self.ignored, &other.ignored);
        add(&mut self.unsound, &other.unsound);
        add(&mut self.accepted, &other.accepted);
    }

    /// `2 refused, 1 dropped`, of what is not accepted.
    pub fn summary(&self) -> Option<String> {
        let counts =
            [(self.refused.len(), "refused"), (self.ignored.len(), "dropped"), (self.unsound.len(), "unsound")];
        let some = counts.iter().filter(|(count, _)| *count > 0).map(|(count, what)| format!("{count} {what}"));
        Some(some.collect::<Vec<_>>().join(", ")).filter(|text| !text.is_empty())
    }
}

impl IgnoredClaims {
    /// `line 19 *BOUNDARY: 1:3 is the slave of ...`.
    pub fn words(&self) -> String {
        format!("{}: {}", self.dropped, self.claims)
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

/// The card that a solver drops for a fault.
fn dropped(finding: &Finding, model: &Model) -> String {
    let equation = |i: usize| model.equation(i).map_or_else(String::new, |equation| model.place(equation.origin));
    match (finding.dropped(), finding.fault) {
        (Some(i), _) => equation(i),
        (None, EquationFault::SlavePrescribed { by, .. }) => model.place(by),
        (None, fault) => equation(fault.equation()),
    }
}

/// Values of one DOF that contradict each other.
fn values(case: &LoadCase) -> impl Iterator<Item = (&Prescribed, &Prescribed)> {
    case.clashes.iter().filter_map(|second| {
        let first = case.prescribed.binary_search_by_key(&second.dof, |given| given.dof).ok()?;
        Some((&case.prescribed[first], second))
    })
}
