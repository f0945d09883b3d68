//! The kinds of cards that claim a DOF, and what a solver does about two claims on the same DOF.

use crate::deck::CardName;

/// How a solver reacts to a fault. If two equations claim the same slave, the first claim is the equation `first` of
/// [`FaultKind::SlaveTwice`](crate::deck::clean::FaultKind::SlaveTwice). If a slave is prescribed, the first claim is the equation and the
/// second is the value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Outcome {
    /// The solver stops.
    Refused,
    /// The solver drops the first claim and continues, at most with a warning.
    IgnoresFirst,
    /// The solver drops the second claim and continues, at most with a warning.
    IgnoresSecond,
    /// The solver accepts both claims, and both hold.
    Accepted,
    /// The solver may continue, but its results are infinite, not a number, or mostly rounding errors.
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

/// The kinds of cards that make a DOF the slave of an equation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CardKind {
    /// The card `*EQUATION`.
    Equation,
    /// `*MPC` of any type, and the `MPC` card of Nastran.
    Mpc,
    /// The card `*TIE`.
    Tie,
    /// The cards `*KINEMATIC` and `*KINEMATIC COUPLING`.
    Kinematic,
    /// The card `*RIGID BODY`, and rigid bodies of LS-DYNA.
    RigidBody,
    /// `*DISTRIBUTING`, whose slave is the reference node.
    Distributing,
    /// The card `*DISTRIBUTING COUPLING`.
    DistributingCoupling,
    /// The cards `*CYCLIC SYMMETRY MODEL` and `*PRE-TENSION SECTION`.
    Sector,
    /// RBE2, RBE3, RBAR and all other elements whose name starts with R.
    RigidElement,
    /// The command `CP` of ANSYS.
    CoupledSet,
    /// The command `CE` of ANSYS, and all other cards.
    Other,
}

impl CardKind {
    /// The kind of the card with this name. A number in the name is ignored.
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
