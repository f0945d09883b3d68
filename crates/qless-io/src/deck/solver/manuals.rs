//! How solvers behave according to their manuals. Of these solvers, only MYSTRAN was also run.
//!
//! - Abaqus/Standard (Analysis User's Guide: "Linear constraint equations", "Kinematic coupling constraints", "Coupling constraints",
//!   "Overconstraint checks"): no other constraint may use an eliminated DOF.
//! - MSC and Simcenter Nastran (Quick Reference Guide): sets of DOFs are mutually exclusive. A dependent DOF that is dependent again or
//!   constrained is a fatal error (message 2101A).
//! - MYSTRAN: as MSC Nastran; `tests/nastran/mystran.rs` runs it on every pair of cards.
//! - OptiStruct (Reference Guide): it may choose other dependent DOFs for rigid elements, because `PARAM,AUTOMSET` defaults to `YES`. With
//!   `NO`, a second claim is a fatal error, as in Nastran.
//! - ANSYS (Modeling and Meshing Guide: "Coupling and Constraint Equations"): a constraint equation eliminates its first DOF that is in no
//!   other equation, in no coupled set and not prescribed. A coupled DOF must be in one set only. The verification decks of ANSYS go
//!   further: they chain `CERIG`, and prescribe a DOF of a coupled set. Both count as accepted.
//! - LS-DYNA (Keyword User's Manual, `*CONSTRAINED_INTERPOLATION`; modelling guidelines of the vendor): a dependent node must not be
//!   constrained elsewhere. Supports of nodes of rigid bodies become constraints of the body.
//! - Radioss (source of OpenRadioss, `kinset.F` and `kinchk.F` of the starter): it warns of kinematic conditions that may be incompatible, and
//!   continues.

use rustc_hash::{FxHashMap, FxHashSet};

use super::{CardKind, Outcome};
use crate::deck::{LoadCase, Model};

/// What Abaqus does if two cards have the same slave.
///
/// The preprocessor keeps one of two ties, drops a tie between nodes of rigid bodies, and joins rigid bodies that
/// share nodes. No other constraint may use an eliminated DOF; `*DISTRIBUTING` eliminates none.
pub fn abaqus_twice(first: CardKind, second: CardKind) -> Outcome {
    match (first, second) {
        (CardKind::Tie | CardKind::RigidBody, CardKind::Tie) => Outcome::IgnoresSecond,
        (CardKind::Tie, CardKind::RigidBody) => Outcome::IgnoresFirst,
        (CardKind::RigidBody, CardKind::RigidBody)
        | (CardKind::Distributing | CardKind::DistributingCoupling, _)
        | (_, CardKind::Distributing | CardKind::DistributingCoupling) => Outcome::Accepted,
        _ => Outcome::Refused,
    }
}

/// What Abaqus does if a slave is prescribed. A DOF that a card eliminates must not be prescribed. A distributing coupling does not
/// eliminate the DOFs of its reference node.
pub fn abaqus_prescribed(kind: CardKind) -> Outcome {
    if matches!(kind, CardKind::Distributing | CardKind::DistributingCoupling) {
        Outcome::Accepted
    } else {
        Outcome::Refused
    }
}

/// What LS-DYNA does if a slave is prescribed. A support of a node of a rigid body holds the body. The manual forbids that another card
/// constrains the dependent node of an interpolation, but does not say what the solver then does. It says nothing about other cards.
pub fn lsdyna_prescribed(kind: CardKind) -> Outcome {
    if kind == CardKind::RigidBody { Outcome::Accepted } else { Outcome::Unsound }
}

/// What OptiStruct does about a fault of cards of these kinds. It chooses other dependent DOFs of rigid elements, unless the deck forbids it.
pub fn optistruct(kinds: &[CardKind], model: &Model) -> Outcome {
    let chooses = kinds.contains(&CardKind::RigidElement) && !model.traits.keeps_dependent;
    if chooses { Outcome::Accepted } else { Outcome::Refused }
}

/// Which equations ANSYS can eliminate.
pub struct Eliminations {
    is_eliminated: Vec<bool>,
    /// For each card, such as that of a coupled set, the columns of its equations that are prescribed.
    prescribed: FxHashMap<u32, FxHashSet<u32>>,
}

impl Eliminations {
    /// Looks for a DOF that each equation can eliminate: a free DOF that is in no coupled set and in no other equation. When an equation
    /// has found its DOF, it no longer counts for the others, so chains of equations can be eliminated one after the other. Equations in
    /// `left_out` do not count.
    pub fn find(model: &Model, cases: &[LoadCase], left_out: &[bool]) -> Self {
        let given = model.prescribed_in(cases);
        let mut found = Self { is_eliminated: vec![false; model.equations()], prescribed: FxHashMap::default() };
        let mut users: FxHashMap<u32, FxHashSet<usize>> = FxHashMap::default();
        for i in (0..model.equations()).filter(|&i| !left_out[i]) {
            let equation = model.nth(i);
            for (&j, _) in equation.columns.iter().zip(equation.coefficients).filter(|(_, a)| **a != 0.0) {
                users.entry(j).or_default().insert(i);
            }
            let set = equation.columns.iter().filter(|j| given.contains_key(j)).copied();
            found.prescribed.entry(equation.origin.card).or_default().extend(set);
        }
        let is_set = |i: &usize| model.cards.nth(model.nth(*i).origin.card).name.is_numbered("CP");
        users.retain(|j, users| !given.contains_key(j) && !users.iter().any(is_set));
        let mut own: Vec<usize> = users.values().filter_map(only).collect();
        while let Some(i) = own.pop() {
            found.is_eliminated[i] = true;
            for j in model.nth(i).columns {
                let Some(users) = users.get_mut(j) else { continue };
                users.remove(&i);
                own.extend(only(users));
            }
        }
        found
    }

    /// What ANSYS does about a fault of these equations. It accepts them if each can eliminate a DOF, and stops otherwise.
    pub fn outcome(&self, equations: &[usize]) -> Outcome {
        accepted_if(equations.iter().all(|&i| self.is_eliminated[i]))
    }

    /// What ANSYS does about a coupled set with prescribed DOFs. It accepts a single prescribed DOF, which gives the others their value.
    pub fn of_set(&self, card: u32) -> Outcome {
        accepted_if(self.prescribed.get(&card).is_none_or(|columns| columns.len() < 2))
    }
}

/// The only element of a set; `None` unless there is exactly one.
fn only(set: &FxHashSet<usize>) -> Option<usize> {
    set.iter().next().copied().filter(|_| set.len() == 1)
}

fn accepted_if(holds: bool) -> Outcome {
    if holds { Outcome::Accepted } else { Outcome::Refused }
}
