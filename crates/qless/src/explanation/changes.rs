//! Numbers of the input that can be changed, and other values for them.

use super::Member;

/// A number of the input that can be changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum Number {
    /// The prescribed value of this DOF, 0-based.
    Prescribed(usize),
    /// The right-hand side of this equation, 0-based.
    RightHandSide(usize),
}

/// Another value for a number of the input.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Change {
    /// The number that changes.
    pub number: Number,
    /// The present value of the number.
    pub from: f64,
    /// The value that cures the conflicts, with as few digits as possible: zero, 12 digits, or 17.
    pub to: f64,
}

impl From<Member> for Number {
    /// The number that a member contributes.
    fn from(member: Member) -> Self {
        match member {
            Member::Equation { row, .. } => Self::RightHandSide(row),
            Member::Prescribed { dof, .. } => Self::Prescribed(dof),
        }
    }
}
