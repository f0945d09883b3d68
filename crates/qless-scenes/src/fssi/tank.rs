//! Ties `u_tank - sum N_i u_soil,i = 0` under the tank, and `u_n - (n_x u_x + n_y u_y) = 0` on its wall.

use super::geometry;
use super::model::{FssiMesh, FssiModel};
use crate::Component;

/// Adds the tank's equations: base ties, then fluid wall.
pub(super) fn couple(model: &mut FssiModel) {
    let mesh = model.mesh;
    for (ring, sector) in (0..mesh.rings).flat_map(|ring| (0..mesh.sectors).map(move |k| (ring, k))) {
        base(model, ring, sector);
    }
    for (ring, sector) in (0..mesh.wall).flat_map(|ring| (0..mesh.sectors).map(move |k| (ring, k))) {
        wall(model, ring, sector);
    }
}

fn base(model: &mut FssiModel, ring: usize, sector: usize) {
    let mesh = model.mesh;
    let [x, y, _] = geometry::tank(&mesh, ring, sector);
    let ((i, wx), (j, wy)) = (locate(x, mesh.columns), locate(y, mesh.columns));
    let corners = [(0, 0, (1.0 - wx) * (1.0 - wy)), (1, 0, wx * (1.0 - wy)), (0, 1, (1.0 - wx) * wy), (1, 1, wx * wy)];
    for component in Component::SPACE {
        let slave = (FssiMesh::Tank, ring * mesh.sectors + sector, component, 1.0);
        let masters = corners.map(|(di, dj, w)| (FssiMesh::Top, i + di + (j + dj) * mesh.columns, component, -w));
        let label = format!("tie tank base, node ({},{}), {}", ring + 1, sector + 1, component.letter());
        model.equation(label, std::iter::once(slave).chain(masters));
    }
}

fn wall(model: &mut FssiModel, ring: usize, sector: usize) {
    let mesh = model.mesh;
    let [nx, ny] = geometry::normal(&mesh, sector);
    let tank = (ring + mesh.rings - 1) * mesh.sectors + sector;
    let fluid = (FssiMesh::Fluid, ring * mesh.sectors + sector, Component::Normal, 1.0);
    let structure = [(FssiMesh::Tank, tank, Component::X, -nx), (FssiMesh::Tank, tank, Component::Y, -ny)];
    let label = format!("fluid wall, node ({},{}), normal", ring + 1, sector + 1);
    model.equation(label, std::iter::once(fluid).chain(structure));
}

/// Cell of the soil's surface at a distance from the first corner, and the position within the cell from 0 to 1.
fn locate(distance: f64, columns: usize) -> (usize, f64) {
    let position = distance / geometry::WIDTH * (columns - 1) as f64;
    (position as usize, position - position.floor())
}
