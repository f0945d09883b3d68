//! Rigid bodies: parts of a rigid material, and nodal rigid bodies.
//!
//! Node k of a body follows a reference point r with the rotation w: `u_k = u_r + w x (x_k - x_r)`, where x are positions. The model has a
//! node of its own for the reference point, such as `body 5` for part 5. Values that cards prescribe for a body hold at its centre of mass.
//! If the deck does not give this centre, the reference is another point. Then translations can be prescribed only if all rotations are
//! held at zero: in that case all points of the body move alike.

use rustc_hash::{FxHashMap, FxHashSet};

use super::mesh::DynaMesh;
use crate::deck::keyword::line::{KeywordFault, KeywordLine};
use crate::deck::kinematics::body::{CouplingEquation, centre_and_size};
use crate::deck::kinematics::components::Components;
use crate::deck::kinematics::rigid::RigidElement;
use crate::deck::kinematics::vector::Vector;
use crate::deck::{Dof, Model, Problem};

/// A rigid body, given by the node at its reference point.
#[derive(Clone, Copy, Debug)]
pub struct RigidReference {
    /// The node at the reference point of the body.
    pub node: u32,
    /// Whether the reference node is at the centre of mass of the body.
    is_centre: bool,
}

/// The definitions of a deck: its mesh, and its rigid bodies by the number of their part.
#[derive(Default)]
pub struct DynaDefinitions {
    pub mesh: DynaMesh,
    /// For each body that is merged into another, the reference nodes of both.
    pub merged: FxHashMap<u32, u32>,
    bodies: FxHashMap<u32, RigidReference>,
}

impl DynaDefinitions {
    /// Adds a body with these nodes. Its reference point is the centre of mass if `centre` gives it, or else the mean of the nodes.
    pub fn add_body(
        &mut self,
        part: u32,
        nodes: &[u32],
        centre: Option<Vector>,
        model: &mut Model,
    ) -> Result<(), Problem> {
        let positions: Vec<Vector> = nodes.iter().filter_map(|node| self.mesh.nodes.get(node)).copied().collect();
        let mean = if positions.is_empty() { [0.0; 3] } else { centre_and_size(positions.into_iter()).0 };
        let advice = "renumber the nodes so that some numbers above the highest are free";
        let limit = Problem::Limit { what: "the number of a node", limit: u32::MAX as usize, advice };
        let node = self.mesh.add_node(centre.unwrap_or(mean)).ok_or(limit)?;
        model.name_node(node, format!("body {part}"));
        self.bodies.insert(part, RigidReference { node, is_centre: centre.is_some() });
        Ok(())
    }

    /// Adds a body for each part whose material is rigid.
    pub fn add_parts(&mut self, model: &mut Model) -> Result<(), Problem> {
        let rigid = self.mesh.parts.iter().filter(|(_, part)| self.mesh.rigid.contains(&part.material));
        let mut parts: Vec<(u32, Option<Vector>)> = rigid.map(|(&id, part)| (id, part.centre)).collect();
        parts.sort_unstable_by_key(|(id, _)| *id);
        parts.into_iter().try_for_each(|(id, centre)| {
            let nodes = self.mesh.elements.nodes_of(&[id]).unwrap_or_default();
            self.add_body(id, &nodes, centre, model)
        })
    }

    /// The body that consists of a part.
    pub fn body(&self, part: u32) -> Option<RigidReference> {
        self.bodies.get(&part).copied()
    }

    /// The body that a field of a line names by its part.
    pub fn named(&self, line: &KeywordLine, field: usize) -> Result<RigidReference, KeywordFault> {
        let part = line.id(field)?;
        let undefined = || line.fault_at(field, Problem::Undefined { what: "rigid body", name: part.to_string() });
        self.body(part).ok_or_else(undefined)
    }

    /// Records that the centre of mass of a body is not the given one, because masses of other bodies or nodes move it.
    pub fn move_centre(&mut self, part: u32) {
        if let Some(body) = self.bodies.get_mut(&part) {
            body.is_centre = false;
        }
    }

    /// The reference nodes that are not at the centre of mass of their body.
    pub fn without_centre(&self) -> FxHashSet<u32> {
        self.bodies.values().filter(|body| !body.is_centre).map(|body| body.node).collect()
    }

    /// The equations by which nodes follow a body. Nodes of solids have no rotations.
    pub fn follow(&self, body: RigidReference, nodes: Vec<u32>) -> Result<Vec<CouplingEquation>, Problem> {
        if nodes.is_empty() {
            return Ok(Vec::new());
        }
        let own = |node| if self.mesh.elements.rotates(node) { Components::ALL } else { Components::TRANSLATIONS };
        let dependent = nodes.into_iter().map(|node| (node, own(node))).collect();
        RigidElement { independent: vec![(body.node, Components::ALL)], dependent }.equations(&self.mesh)
    }
}

impl RigidReference {
    /// The DOFs with these components at the reference node of the body.
    pub fn dofs(self, set: Components) -> impl Iterator<Item = Dof> + use<> {
        let node = self.node;
        set.iter().map(move |component| Dof { node, component })
    }
}
