//! Couplings of nodes with translations and rotations: rigid (RBE2), in the mean (RBE3), beam or shell to solid, fluid to wall.
//!
//! All are rows of `sum_j a_j u_j = d . q`, with the motion `q = (u_r, theta)` of a reference node.

pub(crate) mod area;
pub(crate) mod arm;
mod axes;
mod beam_solid;
mod error;
pub(crate) mod fit;
mod fluid_wall;
pub(crate) mod jacobi;
pub(crate) mod node6;
pub(crate) mod owners;
pub(crate) mod rows;
mod section;
mod seen;
mod shell_solid;
mod thickness;

pub use axes::{Axes, AxesError};
pub use beam_solid::BeamToSolid;
pub use error::{CouplingError, LineFault};
pub use fluid_wall::{FluidNode, FluidWall, FluidWallError};
pub use node6::{Component, Local, Node6};
pub use section::Section;
pub use shell_solid::{ShellToSolid, ThicknessLine};
