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
mod mesh;
mod model;
mod mortar;
mod sides;
mod tank;

pub use mesh::{Level, Mesh};

use crate::{Scene, SceneError, Truth};
use model::FssiModel;

/// The model with node-to-face ties: rank `m - 12 layers`, exactly, and no doubt about it.
///
/// # Errors
/// [`SceneError`] for a mesh that [`Mesh::check`] refuses.
pub fn tie(mesh: &Mesh, seed: u64) -> Result<Scene, SceneError> {
    let mut model = FssiModel::new(*mesh)?;
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
/// The two rows of an edge node are not the same equation, and the rank depends on the far field's mesh:
///
/// | mesh | redundant ([`Mesh::redundant_mortar`]) | singular values |
/// | --- | --- | --- |
/// | [`Level::mesh`]: far field coarser both ways | 12 (layers - far layers) | 1e-16, then more than 1e-4 of the largest |
/// | [`Mesh::nested`]: far-field columns meet near-field ones | 12 layers | 1e-16, then 5e-2 |
/// | [`Mesh::deep`]: far field finer over depth | 0 | 12 layers between 1e-5 and 1e-3, then 5e-2 |
///
/// Where an edge's far-field functions, projected to the near field, vanish along the faces or over the depth, a
/// combination of rows of both faces cancels. It does so in real arithmetic: the rounded integrals leave
/// 1e-16, which the exact rank of the stored doubles counts as independent, so [`crate::oracle`] does not
/// apply. On the first two meshes dense SVD and dense pivoted QR give the numbers above with a gap of 1e12
/// (measured on the 50 % and 80 % levels and the nested 50 % one), while dropping small pivots without column
/// pivoting (Heath) can find only some of them or none, and a different number on C and on C^T. On the
/// third the rank is a matter of tolerance, and `truth.ambiguous` is set.
///
/// # Errors
/// [`SceneError`] for a mesh that [`Mesh::check`] refuses.
pub fn mortar(mesh: &Mesh, seed: u64) -> Result<Scene, SceneError> {
    let mut model = FssiModel::new(*mesh)?;
    mortar::couple(&mut model);
    tank::couple(&mut model);
    let deep = !mesh.is_nested() && mesh.far_layers >= mesh.layers;
    let truth = Truth::independent(mesh.equations()).with_redundant(mesh.redundant_mortar());
    model.finish(seed, Truth { ambiguous: deep, ..truth })
}
