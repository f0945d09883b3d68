//! Mortar rows `sum_j D_ij u_near,j - sum_k M_ik u_far,k = 0` on the side faces.
//!
//! Both meshes of a face are tensor products, and so are their bilinear functions and integrals: `D = D_x D_z`, `M = M_x M_z`.

use super::geometry;
use super::integrals::{HatIntegrals, products};
use super::model::{FssiMesh, FssiModel};
use crate::Component;

/// Integrals along one direction, of near-field functions times near-field and times far-field functions.
struct MortarLine {
    near: HatIntegrals,
    far: HatIntegrals,
}

impl MortarLine {
    fn new(near: usize, far: usize, length: f64) -> Self {
        let scaled = |mut band: HatIntegrals| {
            band.iter_mut().flatten().for_each(|entry| entry.1 *= length);
            band
        };
        Self { near: scaled(products(near, near)), far: scaled(products(near, far)) }
    }
}

/// Adds 3 equations per node of each face.
pub(super) fn couple(model: &mut FssiModel) {
    let mesh = model.mesh;
    let (width, height) = geometry::cell(&mesh);
    let across = MortarLine::new(mesh.columns, mesh.far_columns, width);
    let down = MortarLine::new(mesh.layers, mesh.far_layers, height);
    for face in 0..4 {
        for (layer, i) in (0..mesh.layers).flat_map(|layer| (0..mesh.columns).map(move |i| (layer, i))) {
            let near =
                tensor(&across.near[i], &down.near[layer]).map(|(k, l, v)| (FssiMesh::Side, model.side(face, k, l), v));
            let far =
                tensor(&across.far[i], &down.far[layer]).map(|(k, l, v)| (FssiMesh::Far, model.far(face, k, l), -v));
            let terms: Vec<_> = near.chain(far).collect();
            for component in Component::SPACE {
                let label =
                    format!("mortar side face {}, node ({},{}), {}", face + 1, i + 1, layer + 1, component.letter());
                model.equation(label, terms.iter().map(|&(mesh_id, node, v)| (mesh_id, node, component, v)));
            }
        }
    }
}

/// All products of two rows: `(column across, column down, value)`.
fn tensor<'a>(across: &'a [(usize, f64)], down: &'a [(usize, f64)]) -> impl Iterator<Item = (usize, usize, f64)> + 'a {
    down.iter().flat_map(move |&(l, vz)| across.iter().map(move |&(k, vx)| (k, l, vx * vz)))
}
