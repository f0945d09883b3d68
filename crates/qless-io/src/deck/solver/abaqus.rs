//! Abaqus/Standard, from its manuals: "Linear constraint equations", "Kinematic coupling constraints", "Coupling constraints" and
//! "Overconstraint checks" of the Analysis User's Guide. It has not been run.

use crate::deck::Outcome;

use super::kind::Kind;

/// Two cards with the same slave.
///
/// The preprocessor keeps one of two ties, drops a tie between nodes of rigid bodies, and joins rigid bodies that share nodes by
/// their reference nodes. An eliminated DOF must not be used again by any other constraint.
pub fn twice(first: Kind, second: Kind) -> Outcome {
    match (first, second) {
        (Kind::Tie | Kind::RigidBody, Kind::Tie) => Outcome::IgnoresSecond,
        (Kind::Tie, Kind::RigidBody) => Outcome::IgnoresFirst,
        (Kind::RigidBody, Kind::RigidBody) | (Kind::Distributing, _) | (_, Kind::Distributing) => Outcome::Accepted,
        _ => Outcome::Refused,
    }
}

/// A slave that is prescribed: an eliminated DOF must not be. The reference node of a distributing coupling is not eliminated.
pub fn prescribed(kind: Kind) -> Outcome {
    if matches!(kind, Kind::Distributing | Kind::DistributingCoupling) { Outcome::Accepted } else { Outcome::Refused }
}
