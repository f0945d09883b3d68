//! The kinds of cards that claim a DOF.

use crate::deck::CardName;

/// What claims a DOF as the slave of an equation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// `*EQUATION`.
    Equation,
    /// `*MPC`, of whatever type, and MPC.
    Mpc,
    /// `*TIE`.
    Tie,
    /// `*KINEMATIC` and `*KINEMATIC COUPLING`.
    Kinematic,
    /// `*RIGID BODY`.
    RigidBody,
    /// `*DISTRIBUTING`: its slave is the reference node.
    Distributing,
    /// `*DISTRIBUTING COUPLING`.
    DistributingCoupling,
    /// `*CYCLIC SYMMETRY MODEL` and `*PRE-TENSION SECTION`.
    Sector,
    /// RBE2, RBE3, RBAR and others.
    RigidElement,
    /// CP.
    CoupledSet,
    /// CE, and any other card.
    Other,
}

impl Kind {
    /// The kind of a card by its name, whose number does not count.
    pub fn of(name: &CardName) -> Self {
        let name: String = name.to_string().chars().filter(char::is_ascii_alphabetic).collect();
        match name.to_ascii_uppercase().as_str() {
            "EQUATION" => Self::Equation,
            "TIE" => Self::Tie,
            "KINEMATIC" | "KINEMATICCOUPLING" => Self::Kinematic,
            "RIGIDBODY" => Self::RigidBody,
            "DISTRIBUTING" => Self::Distributing,
            "DISTRIBUTINGCOUPLING" => Self::DistributingCoupling,
            "CYCLICSYMMETRYMODEL" | "PRETENSIONSECTION" => Self::Sector,
            "MPC" => Self::Mpc,
            "CP" => Self::CoupledSet,
            rigid if rigid.starts_with('R') => Self::RigidElement,
            _ => Self::Other,
        }
    }
}
