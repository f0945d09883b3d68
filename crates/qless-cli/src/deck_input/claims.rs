//! Claims of two cards on one DOF, and the reaction of the solver.

use qless_io::deck::clean::{FaultKind, Finding, findings};
use qless_io::deck::{Deck, LoadCase, Model, Outcome, Prescribed};
use serde::Serialize;

/// Descriptions of claims on one DOF and of other faults, grouped by the reaction of the solver.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Claims {
    /// The solver stops.
    pub refused: Vec<String>,
    /// The solver drops one of the two claims without a message.
    pub ignored: Vec<IgnoredClaims>,
    /// The solver may continue, but its results are unreliable.
    pub unsound: Vec<String>,
    /// Both claims hold.
    pub accepted: Vec<String>,
}

/// A claim that the solver drops without a message.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct IgnoredClaims {
    /// The card of the dropped claim.
    pub dropped: String,
    /// The two claims.
    pub claims: String,
}

impl Claims {
    /// The claims in a load case.
    pub fn new(deck: &Deck, case: &LoadCase) -> Self {
        let (model, solver) = (deck.model(), deck.solver());
        let mut claims = Self::default();
        for finding in findings(model, case, solver) {
            claims.add(finding.outcome, finding.fault.describe(model), |_| dropped(&finding, model));
        }
        for (first, second) in contradicting_values(case) {
            let place = |given: &Prescribed| model.place(given.origin);
            let words =
                format!("{} is prescribed in {}, and with another value in {}", first.dof, place(first), place(second));
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

    /// Adds the claims of another load case that are not yet included.
    pub fn merge(&mut self, other: &Self) {
        add(&mut self.refused, &other.refused);
        add(&mut self.ignored, &other.ignored);
        add(&mut self.unsound, &other.unsound);
        add(&mut self.accepted, &other.accepted);
    }

    /// Counts of the claims that are not accepted: `2 refused, 1 dropped`.
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
    // Load cases usually have the same claims.
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
    match (finding.dropped(), finding.fault.kind) {
        (Some(i), _) => equation(i),
        (None, FaultKind::SlavePrescribed { by, .. }) => model.place(by),
        (None, _) => equation(finding.fault.equation),
    }
}

/// Pairs of different prescribed values for one DOF.
fn contradicting_values(case: &LoadCase) -> impl Iterator<Item = (&Prescribed, &Prescribed)> {
    case.clashes.iter().filter_map(|second| {
        let first = case.prescribed.binary_search_by_key(&second.dof, |given| given.dof).ok()?;
        Some((&case.prescribed[first], second))
    })
}
