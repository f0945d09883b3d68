//! The model of Table 1: a soil box tied to its surroundings, `u_slave - sum N_i u_master,i = 0`, twice on its vertical edges.
//!
//! A box of near-field soil carries a liquid storage tank and is embedded in a far field with a mesh of its own. The paper
//! gives the sizes of its model but not the mesh. This twin has the same numbers of equations and of redundant equations at
//! each of the seven mesh levels, and the same kinds of coupling:
//!
//! - **sides**: on each of the box's four vertical faces every node of a `columns x layers` grid is tied to the
//!   far-field mesh with bilinear weights, or coupled by mortar rows: 3 equations per node, `12 columns layers`;
//! - **edges**: the nodes on the four vertical edges belong to two faces and are coupled twice. The two ties of a node are
//!   equal: `4 edges x layers x 3` redundant equations, and no others;
//! - **base**: `rings x sectors` nodes of the tank's ring foundation are tied to the soil's surface: 3 equations each;
//! - **wall**: at `wall x sectors` nodes the normal displacement of the fluid is that of the wall,
//!   `u_n - (n_x u_x + n_y u_y) = 0`; the lowest ring also belongs to the base.
//!
//! m = 12 columns layers + 3 rings sectors + wall sectors. Only DOFs that occur are numbered, in random order; equations
//! have the order above. Lengths are in metres.
//!
//! ```
//! use qless_scenes::fssi::{self, Level};
//! let scene = fssi::tie(&Level::P50.mesh(), 7)?;
//! assert_eq!(scene.system.equation_label(0), "tie side face 1, node (1,1), x");
//! assert_eq!(scene.system.matrix().row(0).len(), 2); // the corners of both meshes coincide
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

/// The model with node-to-face ties. The rank is exactly `m - 12 layers` and not ambiguous.
///
/// # Errors
/// [`SceneError`] for a mesh that [`Mesh::check`] refuses.
pub fn tie(mesh: &Mesh, seed: u64) -> Result<Scene, SceneError> {
    let mut model = FssiModel::new(*mesh)?;
    sides::tie(&mut model);
    tank::couple(&mut model);
    let truth = Truth::independent(mesh.equations()).with_redundant(mesh.redundant());
    model.finish(seed, truth.without_generated(true))
}

/// The model with standard mortar rows on the sides: `sum_j D_ij u_near,j - sum_k M_ik u_far,k = 0`.
///
/// D_ij and M_ik are integrals over a face, in square metres: near-field function i times near-field function j, or times
/// far-field function k. Each row has up to nine near nodes and the far nodes around them. No DOF occurs in one equation
/// only, and elimination fills in.
///
/// The two rows of an edge node differ, and the rank depends on the mesh of the far field:
///
/// | mesh | redundant ([`Mesh::redundant_mortar`]) | singular values |
/// | --- | --- | --- |
/// | [`Level::mesh`]: far field coarser both ways | 12 (layers - far layers) | 1e-16, then more than 1e-4 of the largest |
/// | [`Mesh::nested`]: far-field columns coincide with near-field ones | 12 layers | 1e-16, then 5e-2 |
/// | [`Mesh::deep`]: far field finer over depth | 0 | 12 layers between 1e-5 and 1e-3, then 5e-2 |
///
/// Rows of the two faces of an edge have a combination that cancels in two cases. On a nested mesh, the projection of the far-field
/// functions to the near field is exact, and at the edge all of them vanish except the edge's own. On another mesh, the combination
/// cancels if its weights over the depth are orthogonal to all far-field functions. This holds in real arithmetic only: the
/// rounded integrals leave 1e-16, so the exact rank of the stored doubles ([`crate::oracle`]) is higher. On the first two meshes dense
/// SVD and dense pivoted QR give the numbers above with a gap of 1e12 (measured on the 50 % and 80 % levels and the nested 50 % level).
/// Dropping small pivots without column pivoting (Heath) finds only some of the redundant equations or none, and different numbers on C
/// and on C^T. On the third mesh the rank depends on the tolerance, and `truth.ambiguous` is set.
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
