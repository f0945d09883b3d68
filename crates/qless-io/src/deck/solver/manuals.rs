//! Behaviour of solvers according to their manuals. Of these, only MYSTRAN was also run.
//!
//! | solver | source | rule |
//! | --- | --- | --- |
//! | Abaqus/Standard | Analysis User's Guide: "Linear constraint equations", "Kinematic coupling constraints", "Coupling constraints", "Overconstraint checks" | an eliminated DOF must not be used by another constraint |
//! | MSC and Simcenter Nastran | Quick Reference Guide | sets of DOFs are mutually exclusive: a dependent DOF that is dependent again or constrained is fatal (message 2101A) |
//! | MYSTRAN | `tests/mystran.rs` runs it on every pair of cards | as MSC Nastran |
//! | OptiStruct | Reference Guide | rigid elements may choose other dependent DOFs (`PARAM,AUTOMSET` defaults to `YES`) |
//! | ANSYS | Modeling and Meshing Guide: "Coupling and Constraint Equations" | a constraint equation eliminates its first DOF that is in no other equation, in no coupled set and not prescribed; a coupled DOF must be in one set only and not prescribed |

use rustc_hash::FxHashMap;

use super::{CardKind, Outcome};
use crate::deck::{LoadCase, Model};

/// Two cards with the same slave.
///
/// The preprocessor keeps one of two ties, drops a tie between nodes of rigid bodies, and joins rigid bodies that
/// share nodes. No other constraint may use an eliminated DOF.
pub fn abaqus_twice(first: CardKind, second: CardKind) -> Outcome {
    match (first, second) {
        (CardKind::Tie | CardKind::RigidBody, CardKind::Tie) => Outcome::IgnoresSecond,
        (CardKind::Tie, CardKind::RigidBody) => Outcome::IgnoresFirst,
        (CardKind::RigidBody, CardKind::RigidBody) | (CardKind::Distributing, _) | (_, CardKind::Distributing) => {
            Outcome::Accepted
        }
        _ => Outcome::Refused,
    }
}

/// A prescribed slave: an eliminated DOF must not be prescribed. A distributing coupling does not eliminate its
/// reference node.
pub fn abaqus_prescribed(kind: CardKind) -> Outcome {
    if matches!(kind, CardKind::Distributing | CardKind::DistributingCoupling) {
        Outcome::Accepted
    } else {
        Outcome::Refused
    }
}

/// OptiStruct, by the kinds of cards concerned.
pub fn optistruct(kinds: &[CardKind]) -> Outcome {
    if kinds.contains(&CardKind::RigidElement) { Outcome::Accepted } else { Outcome::Refused }
}

/// Number of equations in which each column occurs.
pub struct ColumnUses(FxHashMap<u32, u32>);

impl ColumnUses {
    /// Counts the equations that are not left out, and the values that these load cases prescribe.
    pub fn count(model: &Model, cases: &[LoadCase], left_out: &[bool]) -> Self {
        let mut uses = FxHashMap::default();
        for i in (0..model.equations()).filter(|&i| !left_out[i]) {
            let mut columns = model.nth(i).columns.to_vec();
            columns.sort_unstable();
            columns.dedup();
            columns.into_iter().for_each(|j| *uses.entry(j).or_default() += 1);
        }
        // A prescribed DOF counts as shared.
        for given in cases.iter().flat_map(|case| &case.prescribed) {
            if let Some(j) = model.column(given.dof) {
                *uses.entry(j).or_default() += 2;
            }
        }
        Self(uses)
    }

    /// Whether an equation has a DOF that occurs nowhere else.
    fn has_own(&self, model: &Model, equation: usize) -> bool {
        let equation = model.nth(equation);
        let mut terms = equation.columns.iter().zip(equation.coefficients);
        terms.any(|(j, a)| *a != 0.0 && self.0.get(j) == Some(&1))
    }
}

/// The outcome for equations with a fault.
pub fn ansys_outcome(model: &Model, uses: &ColumnUses, equations: &[(usize, CardKind)]) -> Outcome {
    let is_solvable = |&(i, kind): &(usize, CardKind)| kind != CardKind::CoupledSet && uses.has_own(model, i);
    if equations.iter().all(is_solvable) { Outcome::Accepted } else { Outcome::Refused }
}
