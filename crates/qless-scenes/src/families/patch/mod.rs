//! Meshes of the square `[0, 1]^2`, interpolation `x = sum_k N_k(xi, eta) x_k` on their faces, and a search for the face at a point.

mod face;
mod grid;
mod locate;

pub(super) use face::PatchFace;
pub use grid::Faces;
pub(super) use grid::{Grid, zip};
pub(super) use locate::Locator;
