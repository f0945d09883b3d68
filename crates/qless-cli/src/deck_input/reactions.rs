//! What the solver does with single equations and DOFs.

use qless::Options;
use qless_io::deck::clean::{FaultKind, Finding, findings, loss};
use qless_io::deck::{Dof, Model, Outcome};

use super::DeckInput;
use super::claims::contradicting_values;

/// A fault in the load case that is shown, and the solver's reaction.
pub struct Reaction {
    /// Equations with the fault, as rows of the system from 0.
    pub rows: Vec<usize>,
    /// DOFs with the fault, as columns of the system from 0.
    pub dofs: Vec<usize>,
    /// The fault and the reaction: `1:1 is the slave of line 4 *EQUATION, and prescribed in line 2 *BOUNDARY: ccx stops`.
    pub words: String,
}

impl DeckInput {
    /// The faults of the load case that is shown, each with the reaction of the solver: it accepts the fault, drops a claim, stops, or may
    /// compute wrong results.
    pub fn reactions(&self, options: &Options) -> Vec<Reaction> {
        let (model, solver) = (self.deck.model(), self.deck.solver());
        let case = &model.cases()[self.case];
        let found = findings(model, case, solver);
        let loss = loss(model, case, &found, solver, options);
        let in_force: Vec<usize> = model.in_force(case).collect();
        let reaction = |finding: &Finding| {
            let lost = finding.outcome.ignores().then(|| loss.contains(finding));
            let words = finding.describe(model, solver) + lost.map_or("", implication);
            let (equations, dofs) = concerned(finding);
            let rows = equations.iter().filter_map(|i| in_force.binary_search(i).ok()).collect();
            Reaction { rows, dofs: columns(model, &dofs), words }
        };
        let mut reactions: Vec<Reaction> = found.iter().map(reaction).collect();
        // The system has a row for each contradicting value, after the equations.
        reactions.extend(contradicting_values(case).zip(in_force.len()..).map(|((first, second), row)| {
            let (one, other) = (model.place(first.origin), model.place(second.origin));
            let reaction = match solver.prescribed_twice() {
                Outcome::IgnoresFirst => format!("drops the value of {one}{}", implication(true)),
                Outcome::IgnoresSecond => format!("drops the value of {other}{}", implication(true)),
                _ => "stops".to_owned(),
            };
            let dof = model.dof_name(first.dof);
            let words = format!("{dof} is prescribed in {one}, and with another value in {other}: {solver} {reaction}");
            Reaction { rows: vec![row], dofs: columns(model, &[first.dof]), words }
        }));
        reactions
    }
}

fn implication(is_lost: bool) -> &'static str {
    if is_lost { ", although what it keeps does not imply it" } else { "; what it keeps implies it" }
}

/// The equations, from 0, and the DOFs of a fault.
fn concerned(finding: &Finding) -> (Vec<usize>, Vec<Dof>) {
    let fault = finding.fault;
    match fault.kind {
        FaultKind::SlaveTwice { first } | FaultKind::CoupledTwice { first } => {
            (vec![first, fault.equation], vec![fault.slave])
        }
        FaultKind::MasterTwice { master } => (vec![fault.equation], vec![fault.slave, master]),
        _ => (vec![fault.equation], vec![fault.slave]),
    }
}

fn columns(model: &Model, dofs: &[Dof]) -> Vec<usize> {
    dofs.iter().filter_map(|&dof| model.column(dof)).map(|column| column as usize).collect()
}
