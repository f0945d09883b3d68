//! Couplings of nodes with translations and rotations: rigid (RBE2), in the mean (RBE3), beam or shell to solid, fluid to wall.
//!
//! All are rows of `sum_j a_j u_j = d . q`, with the motion `q = (u_r, theta)` of a reference node.

mod average;
mod beam_solid;
mod equations;
mod error;
mod face_integrals;
mod fluid;
mod mean_rigid_motion;
mod node6;
mod rigid_body;
mod rigid_motion;
mod shell_solid;
mod svd;

pub use average::Average;
pub use beam_solid::BeamToSolid;
pub use error::{CouplingError, LineFault};
pub use fluid::{FluidNode, FluidNormal, FluidNormalError, FluidWall, FluidWallError};
pub use node6::{Axes, AxesError, Component, Local, Node6};
pub use rigid_body::{RigidBody, SmallRigidBody};
pub use shell_solid::{ShellToSolid, ThicknessLine};

/// What stays of the shape of the cross-section.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Section {
    /// It is rigid: `u_i = u_r + theta x r_i` at each node. Lateral contraction is held.
    Rigid,
    /// It stays plane and is free to contract: across it each node follows the rigid motion, within it their mean does.
    Plane,
    /// It is free to warp and to contract: the beam or shell moves as the mean of the face; a load on it is spread over the face.
    Mean,
}
