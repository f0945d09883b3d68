//! Numbers nodes and DOFs in order of first occurrence, then shuffles the DOFs and builds the scene.

use qless::SystemBuilder;

use super::{Mesh, geometry};
use crate::{Component, Dof, Rng, Scene, SceneError, Truth};

/// A mesh of the model, with nodes numbered from 0 within it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum FssiMesh {
    /// Near-field soil, sides: `4 (columns - 1)` nodes around the box times `layers` nodes downwards.
    Side,
    /// Near-field soil, surface: `columns x columns` nodes.
    Top,
    /// Far-field soil, sides: `4 (far_columns - 1)` nodes around the box times `far_layers` nodes downwards.
    Far,
    /// Tank: `rings` rings of the foundation and `wall - 1` rings more, each of `sectors` nodes.
    Tank,
    /// Fluid at the wall: `wall x sectors` nodes.
    Fluid,
}

const UNSEEN: u32 = u32::MAX;

/// The equations so far, with DOFs in order of first occurrence.
pub(super) struct FssiModel {
    pub(super) mesh: Mesh,
    /// Scene node of each node of each mesh; [`UNSEEN`] before it occurs.
    node: [Vec<u32>; 5],
    /// DOFs of each node of each mesh, by component; [`UNSEEN`] before they occur.
    dof: [Vec<[u32; 4]>; 5],
    nodes: Vec<[f64; 3]>,
    dofs: Vec<Dof>,
    names: Vec<String>,
    equations: Vec<(String, Vec<(usize, f64)>)>,
}

impl FssiModel {
    pub(super) fn new(mesh: Mesh) -> Result<Self, SceneError> {
        mesh.check()?;
        let sizes = [
            4 * (mesh.columns - 1) * mesh.layers,
            mesh.columns * mesh.columns,
            4 * (mesh.far_columns - 1) * mesh.far_layers,
            (mesh.rings + mesh.wall - 1) * mesh.sectors,
            mesh.wall * mesh.sectors,
        ];
        Ok(Self {
            mesh,
            node: sizes.map(|size| vec![UNSEEN; size]),
            dof: sizes.map(|size| vec![[UNSEEN; 4]; size]),
            nodes: Vec::new(),
            dofs: Vec::new(),
            names: Vec::new(),
            equations: Vec::with_capacity(mesh.equations()),
        })
    }

    /// Near-field side node: column i of a face (0..4), counted around the box, and layer.
    pub(super) fn side(&self, face: usize, i: usize, layer: usize) -> usize {
        around(self.mesh.columns, face, i) + layer * 4 * (self.mesh.columns - 1)
    }

    /// Far-field side node: column i of a face (0..4), counted around the box, and layer.
    pub(super) fn far(&self, face: usize, i: usize, layer: usize) -> usize {
        around(self.mesh.far_columns, face, i) + layer * 4 * (self.mesh.far_columns - 1)
    }

    /// Adds the equation `sum a u = 0` over `(mesh, node, component, a)` without the zero coefficients.
    pub(super) fn equation(
        &mut self,
        label: String,
        terms: impl IntoIterator<Item = (FssiMesh, usize, Component, f64)>,
    ) {
        let occurring = terms.into_iter().filter(|term| term.3 != 0.0);
        let row = occurring.map(|(mesh_id, node, component, a)| (self.dof(mesh_id, node, component), a)).collect();
        self.equations.push((label, row));
    }

    fn dof(&mut self, mesh_id: FssiMesh, node: usize, component: Component) -> usize {
        let known = self.dof[mesh_id as usize][node][component as usize];
        if known != UNSEEN {
            return known as usize;
        }
        let number = self.dofs.len();
        self.dof[mesh_id as usize][node][component as usize] = number as u32;
        let place = Dof { node: self.scene_node(mesh_id, node), component };
        self.dofs.push(place);
        let mesh = ["soil", "soil top", "far", "tank", "fluid"][mesh_id as usize];
        self.names.push(format!("{mesh} {}:{}", node + 1, component.letter()));
        number
    }

    fn scene_node(&mut self, mesh_id: FssiMesh, node: usize) -> usize {
        if self.node[mesh_id as usize][node] == UNSEEN {
            self.node[mesh_id as usize][node] = self.nodes.len() as u32;
            self.nodes.push(self.point(mesh_id, node));
        }
        self.node[mesh_id as usize][node] as usize
    }

    fn point(&self, mesh_id: FssiMesh, node: usize) -> [f64; 3] {
        let mesh = &self.mesh;
        let on_side = |columns: usize, layers| {
            let ring = 4 * (columns - 1);
            geometry::side(columns, layers, node % ring, node / ring)
        };
        let (ring, sector) = (node / mesh.sectors, node % mesh.sectors);
        match mesh_id {
            FssiMesh::Side => on_side(mesh.columns, mesh.layers),
            FssiMesh::Far => on_side(mesh.far_columns, mesh.far_layers),
            FssiMesh::Top => geometry::top(mesh, node % mesh.columns, node / mesh.columns),
            FssiMesh::Tank => geometry::tank(mesh, ring, sector),
            FssiMesh::Fluid => geometry::tank(mesh, ring + mesh.rings - 1, sector),
        }
    }

    /// Shuffles the DOF numbers and builds the system.
    pub(super) fn finish(self, seed: u64, truth: Truth) -> Result<Scene, SceneError> {
        let number = Rng::new(seed).shuffled(self.dofs.len());
        let mut builder = SystemBuilder::new(self.dofs.len());
        for (label, row) in self.equations {
            builder.labelled_equation(label, row.into_iter().map(|(dof, a)| (number[dof], a)), 0.0);
        }
        let (mut names, mut dofs) = (vec![String::new(); self.dofs.len()], self.dofs.clone());
        for ((name, dof), &new) in self.names.into_iter().zip(self.dofs).zip(&number) {
            names[new] = name;
            dofs[new] = dof;
        }
        builder.dof_labels(names);
        Ok(Scene { system: builder.build()?, truth, nodes: self.nodes, dofs })
    }
}

/// Position of column i of a face around the box; the last column of a face is the first of the next.
fn around(columns: usize, face: usize, i: usize) -> usize {
    (face * (columns - 1) + i) % (4 * (columns - 1))
}
