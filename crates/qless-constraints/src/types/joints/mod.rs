//! Joints of multibody systems. Each combines some of the equations in [`coincident`], [`height`] and [`orientation`].
//! All but the motors are satisfied in the reference configuration.

pub(super) mod attachment;
pub(super) mod coincident;
mod guides;
pub(super) mod height;
mod motor;
pub(super) mod orientation;
mod pins;
pub(super) mod relative;

pub use attachment::{Body, BodyPoint};
pub use guides::{Cylindrical, Parallel, Perpendicular, Planar, Prismatic};
pub use motor::{RotationMotor, TranslationMotor};
pub use pins::{Fixed, Revolute, Spherical, Universal};

use crate::scalar::vector::{Vector, unit};

/// What can be wrong with a joint.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum JointError {
    /// Both bodies are the ground.
    #[error("both bodies are the ground; at least one must move")]
    NothingMoves,
    /// The joint fixes directions, but a body has no rotations.
    #[error("the joint fixes directions, but a body is a node without rotations; give it rotations")]
    NoRotations,
    /// An axis is zero or not finite.
    #[error("an axis has no direction; give a vector that is not zero")]
    Axis,
    /// Axes that must be perpendicular are not.
    #[error(
        "the axes must be perpendicular in the reference configuration, but the cosine of their angle is {0}; give axes at a right angle"
    )]
    NotPerpendicular(f64),
}

/// Checks that at least one body can move.
fn check_moves(a: &Body, b: &Body) -> Result<(), JointError> {
    if a.dofs().is_empty() && b.dofs().is_empty() { Err(JointError::NothingMoves) } else { Ok(()) }
}

/// Checks that each body has rotations or is the ground, and that one has rotations.
fn check_turns(a: &Body, b: &Body) -> Result<(), JointError> {
    check_moves(a, b)?;
    let sound = |body: &Body| body.turns() || body.dofs().is_empty();
    if sound(a) && sound(b) { Ok(()) } else { Err(JointError::NoRotations) }
}

/// The unit vector along an axis.
fn direction(axis: Vector<f64>) -> Result<Vector<f64>, JointError> {
    unit(axis).ok_or(JointError::Axis)
}
