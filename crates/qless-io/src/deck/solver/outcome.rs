//! Kinds of cards that claim a DOF, and what a solver does where two cards claim the same one.

use crate::deck::CardName;

/// What a solver does with a fault. The first claim is that of the equation that a fault names first, the second that of the value or
/// of the other equation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Outcome {
    /// It stops.
    Refused,
    /// It drops the first claim and goes on; at most it prints a warning.
    IgnoresFirst,
    /// It drops the second claim and goes on; at most it prints a warning.
    IgnoresSecond,
    /// Both hold.
    Accepted,
    /// It may go on; what it computes is infinite, not a number, or mostly rounding.
    Unsound,
}

impl Outcome {
    /// Whether one of the two claims is dropped.
    ///
    /// ```
    /// use qless_io::deck::Outcome;
    /// assert!(Outcome::IgnoresFirst.ignores() && !Outcome::Refused.ignores());
    /// ```
    pub fn ignores(self) -> bool {
        matches!(self, Self::IgnoresFirst | Self::IgnoresSecond)
    }
}

/// What claims a DOF as the slave of an equation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CardKind {
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

impl CardKind {
    /// The kind of a card by its name, whose number does not count.
    pub fn from_name(name: &CardName) -> Self {
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
