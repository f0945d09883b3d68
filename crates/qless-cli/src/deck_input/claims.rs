//! Claims of two cards on one DOF, and the reaction of the solver.

use qless::Options;
use qless_io::deck::clean::{FaultKind, Finding, findings, loss};
use qless_io::deck::{Deck, LoadCase, Model, Outcome, Prescribed};
use serde::Serialize;

/// Descriptions of claims on one DOF and of other faults, grouped by the reaction of the solver.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Claims {
    /// Claims at which the solver stops.
    pub refused: Vec<String>,
    /// Claims that the solver drops, and that follow from what it keeps.
    pub implied: Vec<DroppedClaim>,
    /// Claims that the solver drops, and that do not follow from what it keeps.
    pub lost: Vec<DroppedClaim>,
    /// For each motion that the lost claims would prevent, one DOF that moves.
    pub freed: Vec<String>,
    /// Claims with which the solver may continue, but with unreliable results.
    pub unsound: Vec<String>,
    /// Pairs of claims on one DOF that the solver accepts.
    pub accepted: Vec<String>,
}

/// A claim that the solver drops, at most with a warning.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DroppedClaim {
    /// The card of the dropped claim.
    pub dropped: String,
    /// Both claims on the DOF, in words.
    pub claims: String,
}

impl Claims {
    /// Finds the claims in a load case, and the reaction of the solver.
    pub fn new(deck: &Deck, case: &LoadCase, options: &Options) -> Self {
        let (model, solver) = (deck.model(), deck.solver());
        let found = findings(model, case, solver);
        let loss = loss(model, case, &found, solver, options);
        let freed = loss.freed.iter().map(|&dof| model.dof_name(dof)).collect();
        let mut claims = Self { freed, ..Self::default() };
        for finding in &found {
            let place = |_| dropped(finding, model);
            claims.add(finding.outcome, finding.fault.describe(model), loss.contains(finding), place);
        }
        for (first, second) in contradicting_values(case) {
            let place = |given: &Prescribed| model.place(given.origin);
            let words =
                format!("{} is prescribed in {}, and with another value in {}", first.dof, place(first), place(second));
            claims.add(solver.prescribed_twice(), words, true, |is_first| place(if is_first { first } else { second }));
        }
        let stops = model.refusals().iter().map(|refusal| format!("{}: {}", model.place_of(refusal), refusal.text));
        claims.refused.extend(stops);
        claims
    }

    fn add(&mut self, outcome: Outcome, claims: String, is_lost: bool, dropped: impl Fn(bool) -> String) {
        let list = if is_lost { &mut self.lost } else { &mut self.implied };
        match outcome {
            Outcome::Refused => self.refused.push(claims),
            Outcome::Accepted => self.accepted.push(claims),
            Outcome::Unsound => self.unsound.push(claims),
            Outcome::IgnoresFirst => list.push(DroppedClaim { dropped: dropped(true), claims }),
            Outcome::IgnoresSecond => list.push(DroppedClaim { dropped: dropped(false), claims }),
        }
    }

    /// Adds the claims of another load case that are not yet included.
    pub fn merge(&mut self, other: &Self) {
        add(&mut self.refused, &other.refused);
        add(&mut self.implied, &other.implied);
        add(&mut self.lost, &other.lost);
        add(&mut self.freed, &other.freed);
        add(&mut self.unsound, &other.unsound);
        add(&mut self.accepted, &other.accepted);
    }

    /// Number of claims that the solver drops.
    pub fn dropped(&self) -> usize {
        self.implied.len() + self.lost.len()
    }

    /// Counts of the claims that are not accepted, such as `2 refused, 1 lost`.
    pub fn summary(&self) -> Option<String> {
        let Self { refused, implied, lost, unsound, .. } = self;
        let counts =
            [(refused.len(), "refused"), (lost.len(), "lost"), (implied.len(), "dropped"), (unsound.len(), "unsound")];
        let some = counts.iter().filter(|(count, _)| *count > 0).map(|(count, what)| format!("{count} {what}"));
        Some(some.collect::<Vec<_>>().join(", ")).filter(|text| !text.is_empty())
    }
}

impl DroppedClaim {
    /// The dropped claim and both claims in words: `line 19 *BOUNDARY: 1:3 is the slave of ...`.
    pub fn words(&self) -> String {
        format!("{}: {}", self.dropped, self.claims)
    }
}

fn add<T: Clone + PartialEq>(all: &mut Vec<T>, more: &[T]) {
    // Load cases usually have the same claims. Equal lists are found by one comparison, without a search for each item.
    if all.is_empty() {
        all.extend_from_slice(more);
    } else if all.as_slice() != more {
        let fresh: Vec<T> = more.iter().filter(|item| !all.contains(item)).cloned().collect();
        all.extend(fresh);
    }
}

/// Line and card of the claim that the solver drops because of a fault.
fn dropped(finding: &Finding, model: &Model) -> String {
    let equation = |i: usize| model.equation(i).map_or_else(String::new, |equation| model.place(equation.origin));
    match (finding.dropped(), finding.fault.kind) {
        (Some(i), _) => equation(i),
        (None, FaultKind::SlavePrescribed { by, .. }) => model.place(by),
        (None, _) => equation(finding.fault.equation),
    }
}

/// Pairs of different prescribed values for one DOF.
pub(super) fn contradicting_values(case: &LoadCase) -> impl Iterator<Item = (&Prescribed, &Prescribed)> {
    case.clashes.iter().filter_map(|second| {
        let first = case.prescribed.binary_search_by_key(&second.dof, |given| given.dof).ok()?;
        Some((&case.prescribed[first], second))
    })
}
