//! Solvers of Nastran's language.
//!
//! MSC and Simcenter Nastran, from the Quick Reference Guide: sets of DOFs are mutually exclusive, so that a dependent DOF that is
//! dependent again or constrained is fatal (message 2101A). MYSTRAN does the same; `tests/mystran.rs` runs it on every pair. OptiStruct,
//! from its Reference Guide, lets rigid elements choose other dependent DOFs (`PARAM,AUTOMSET` is `YES` where it is not given). Neither
//! Nastran nor OptiStruct has been run.

use crate::deck::Outcome;

use super::kind::Kind;

/// MSC and Simcenter Nastran, MYSTRAN.
pub fn exclusive() -> Outcome {
    Outcome::Refused
}

/// OptiStruct, with the kinds of the equations concerned.
pub fn optistruct(kinds: &[Kind]) -> Outcome {
    if kinds.contains(&Kind::RigidElement) { Outcome::Accepted } else { Outcome::Refused }
}
