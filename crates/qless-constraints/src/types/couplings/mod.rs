//! Couplings of nodes with translations and rotations: rigid bodies (RBE2), weighted averages (RBE3), beams or shells
//! on solids, fluids at walls.
//!
//! Except for fluids, every linear equation has the form `sum_j a_j u_j = d . q`, with six coefficients d of the motion `q = (u_r, theta)`
//! of a reference node.

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

/// How a cross-section may deform.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Section {
    /// The section is rigid: `u_i = u_r + theta x r_i` at each node. Lateral contraction is prevented.
    Rigid,
    /// The section stays plane, but may contract: its nodes follow the rigid motion out of the plane, and only on
    /// average within the plane.
    Plane,
    /// The section may warp and contract. The beam or shell follows the mean motion of the face, and its load is
    /// distributed over the face.
    Mean,
}
