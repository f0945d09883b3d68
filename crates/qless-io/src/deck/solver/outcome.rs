//! Kinds of cards that claim a DOF, and the outcome of two claims on the same DOF.

use crate::deck::CardName;

/// A solver's reaction to a fault. If two equations claim the same slave, the first claim is the equation `first` of
/// [`FaultKind::SlaveTwice`](crate::deck::clean::FaultKind::SlaveTwice). If a slave is prescribed, the first claim is the equation and the
/// second is the value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Outcome {
    /// The solver stops.
    Refused,
    /// It drops the first claim and continues, at most with a warning.
    IgnoresFirst,
    /// It drops the second claim and continues, at most with a warning.
    IgnoresSecond,
    /// Both claims hold.
    Accepted,
    /// It may continue, but its results are infinite, not a number, or mostly rounding errors.
    Unsound,
}

impl Outcome {
    /// Whether the solver drops one of the two claims.
    ///
    /// ```
    /// use qless_io::deck::Outcome;
    /// assert!(Outcome::IgnoresFirst.ignores() && !Outcome::Refused.ignores());
    /// ```
    pub fn ignores(self) -> bool {
        matches!(self, Self::IgnoresFirst | Self::IgnoresSecond)
    }
}

/// Kind of a card that makes a DOF the slave of an equation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CardKind {
    /// `*EQUATION`.
    Equation,
    /// `*MPC` of any type, and Nastran's MPC.
    Mpc,
    /// `*TIE`.
    Tie,
    /// `*KINEMATIC` and `*KINEMATIC COUPLING`.
    Kinematic,
    /// `*RIGID BODY`, and rigid bodies of LS-DYNA.
    RigidBody,
    /// `*DISTRIBUTING`: its slave is the reference node.
    Distributing,
    /// `*DISTRIBUTING COUPLING`.
    DistributingCoupling,
    /// `*CYCLIC SYMMETRY MODEL` and `*PRE-TENSION SECTION`.
    Sector,
    /// RBE2, RBE3, RBAR and the like.
    RigidElement,
    /// ANSYS's CP.
    CoupledSet,
    /// ANSYS's CE, and any other card.
    Other,
}

impl CardKind {
    /// The kind for the name of a card, ignoring its number.
    pub fn from_name(name: &CardName) -> Self {
        let name: String = name.to_string().chars().filter(char::is_ascii_alphabetic).collect();
        match name.to_ascii_uppercase().as_str() {
            "EQUATION" => Self::Equation,
            "TIE" => Self::Tie,
            "KINEMATIC" | "KINEMATICCOUPLING" => Self::Kinematic,
            "RIGIDBODY" => Self::RigidBody,
            body if body.starts_with("CONSTRAINEDNODALRIGIDBODY") || body.starts_with("CONSTRAINEDEXTRANODES") => {
                Self::RigidBody
            }
            part if part.starts_with("PART") => Self::RigidBody,
            "DISTRIBUTING" => Self::Distributing,
            "DISTRIBUTINGCOUPLING" => Self::DistributingCoupling,
            "CYCLICSYMMETRYMODEL" | "PRETENSIONSECTION" => Self::Sector,
            "MPC" | "MPCMEANROT" => Self::Mpc,
            "CP" => Self::CoupledSet,
            rigid if rigid.starts_with('R') => Self::RigidElement,
            _ => Self::Other,
        }
    }
}
