//! `x = sum_k N_k(xi, eta) x_k` on faces of a mesh of the square `[0, 1]^2`, and the face in which a point lies.

mod face;
mod grid;
mod locate;
mod zip;

pub(super) use face::PatchFace;
pub use grid::Faces;
pub(super) use grid::Grid;
pub(super) use locate::Locator;
pub(super) use zip::zip;
