//! `u_slave - sum N_i u_master,i = 0` around a soil box, twice on its vertical edges: the model of Table 1.
//!
//! A box of near-field soil carries a liquid storage tank and stands in a far field with a mesh of its own.
//! The paper gives the counts of its model, not the mesh; this twin has the same numbers of equations and of
//! redundant ones at each of its seven mesh levels, and the same kinds of coupling:
//!
//! - **sides**: on each of the box's four vertical faces every node of a `columns x layers` grid is tied to the
//!   far-field mesh with bilinear weights, or coupled by mortar rows: 3 equations per node, `12 columns layers`;
//! - **edges**: the nodes on the four vertical edges belong to two faces and are coupled twice. As ties, the two
//!   are the same equation: `4 edges x layers x 3` redundant ones, and no others;
//! - **base**: `rings x sectors` nodes of the tank's ring foundation are tied to the soil's top: 3 equations each;
//! - **wall**: at `wall x sectors` nodes the fluid's normal displacement is the wall's,
//!   `u_n - (n_x u_x + n_y u_y) = 0`; the lowest ring belongs to the base as well.
//!
//! m = 12 columns layers + 3 rings sectors + wall sectors. Only DOFs that occur are numbered, in random order;
//! rows keep the order above. Lengths are metres.
//!
//! ```
//! use qless_scenes::fssi::{self, Level};
//! let scene = fssi::tie(&Level::P50.mesh(), 7)?;
//! assert_eq!(scene.system.equation_label(0), "tie side face 1, node (1,1), x");
//! assert_eq!(scene.system.matrix().row(0).len(), 2); // a corner meets the far field's corner
//! let place = scene.dofs[0];
//! assert_eq!(scene.nodes[place.node].len(), 3);
//! # Ok::<(), qless_scenes::SceneError>(())
//! ```

mod geometry;
mod integrals;
mod level;
mod mesh;
mod model;
mod mortar;
mod sides;
mod tank;

pub use level::Level;
pub use mesh::Mesh;

use crate::{Scene, SceneError, Truth};
use model::Model;

/// The model with node-to-face ties: rank `m - 12 layers`, exactly, and no doubt about it.
///
/// # Errors
/// [`SceneError`] for a mesh that [`Mesh::check`] refuses.
pub fn tie(mesh: &Mesh, seed: u64) -> Result<Scene, SceneError> {
    let mut model = Model::new(*mesh)?;
    sides::tie(&mut model);
    tank::couple(&mut model);
    let truth = Truth::independent(mesh.equations()).with_redundant(mesh.redundant());
    model.finish(seed, Truth { generated: Some(Vec::new()), ..truth })
}

/// The model with standard mortar rows on the sides: `sum_j D_ij u_near,j - sum_k M_ik u_far,k = 0`.
///
/// D_ij and M_ik are the integrals over a face of the bilinear near-field function i times near-field function
/// j and far-field function k, in square metres. Each row holds up to nine near nodes and the far nodes
/// around, no column occurs once, and elimination fills in.
///
/// The two rows of an edge node are no longer the same equation. Three cases:
///
/// - [`Mesh::is_nested`] (the far field's columns are every k-th near-field column): in each horizontal row of
///   near-field nodes a combination over both faces at an edge cancels but for rounding (1e-16): rank
///   `m - 12 layers` for every sound numerical tolerance, though the rounded coefficients have a higher exact rank;
/// - otherwise, with `far_layers < layers`: `12 (layers - far_layers)` such combinations and, above them, small
///   singular values;
/// - otherwise, as on the levels of Table 1: the exact rank is m, but `12 layers` singular values lie far below
///   all others, 1e-5 to 1e-3 of the largest. The rank at the paper's tolerance of 1e-5 is **ambiguous**; it
///   depends on the method and on the order of rows. `truth.rank_free` is `None`, `truth.ambiguous` is set.
///
/// # Errors
/// [`SceneError`] for a mesh that [`Mesh::check`] refuses.
pub fn mortar(mesh: &Mesh, seed: u64) -> Result<Scene, SceneError> {
    let mut model = Model::new(*mesh)?;
    mortar::couple(&mut model);
    tank::couple(&mut model);
    let known = Truth::independent(mesh.equations()).with_redundant(mesh.redundant());
    let truth = if mesh.is_nested() { known } else { Truth { ambiguous: true, ..Truth::default() } };
    model.finish(seed, truth)
}
