//! `*RIGID BODY` and `*KINEMATIC`: `u_k = u_r + w x (x_k - x_r)` at the reference configuration.

use super::card::Card;
use super::definitions::Definitions;
use super::fields::number;
use super::frames::Local;
use super::geometric::{Place, Row};
use crate::deck::kinematics::axes::BASIC_AXES;
use crate::deck::kinematics::row::Poses;
use crate::deck::kinematics::vector::{Vector, cross, minus};
use crate::deck::{DeckError, Dof, Model, Problem, Solver};

/// The node whose motion a body follows, and the first of the three components that are the body's rotation.
#[derive(Clone, Copy)]
pub struct Reference {
    pub node: u32,
    pub rotation: Dof,
}

/// The rotation that CalculiX makes for a `*RIGID BODY` without `ROT NODE`: no other card reaches it, components 4 to 6 included.
const UNREACHED: u8 = 21;

impl Reference {
    /// A reference whose components 4 to 6 are the rotation.
    pub fn turning(node: u32) -> Self {
        Self { node, rotation: Dof { node, component: 4 } }
    }

    /// The motion of a point along a direction e: `e . u_k - e . u_r - (r x e) . w = 0`.
    pub fn follows(&self, definitions: &Definitions, node: u32, direction: Vector) -> Result<Row, Problem> {
        let reference = definitions.pose(self.node)?;
        let arm = minus(definitions.position(node)?, reference.position);
        let mut row = Row::along(definitions, &[(node, direction), (self.node, direction.map(|x| -x))], 0.0)?;
        let pose = definitions.pose(node)?;
        let own = row.terms[0].0.component;
        let scale = crate::deck::kinematics::vector::dot(pose.axes[usize::from(own) - 1], direction);
        let moment = cross(arm, direction);
        for (k, axis) in reference.axes.iter().enumerate() {
            let value = -crate::deck::kinematics::body::product(axis, &moment) / scale;
            if value != 0.0 {
                row.terms.push((self.rotation_dof(k), value));
            }
        }
        Ok(row)
    }

    fn rotation_dof(&self, k: usize) -> Dof {
        Dof { component: self.rotation.component + k as u8, ..self.rotation }
    }

    /// A node's rotation is the body's.
    pub fn turns(&self, node: u32, k: usize) -> Row {
        let own = Dof { node, component: k as u8 + 4 };
        Row { terms: vec![(own, 1.0), (self.rotation_dof(k), -1.0)], rhs: 0.0 }
    }
}

/// `*RIGID BODY, NSET= or ELSET=, REF NODE=, ROT NODE=`.
pub fn read(card: &Card, solver: Solver, model: &mut Model, definitions: &Definitions) -> Result<(), DeckError> {
    let place = Place::of(card, model, "*RIGID BODY");
    let rows = rows(card, solver, definitions);
    place.push(model, rows)?;
    if definitions.is_nonlinear {
        place.fix(model);
    } else if card.parameter("ROTNODE").is_none() {
        if let Ok(reference) = reference(card, solver) {
            own_rotation(&place, reference, model, definitions);
        }
    }
    model.warn(card.file, card.line, "*RIGID BODY is linearised at the reference configuration");
    Ok(())
}

/// The solver makes the rotation of a reference: one along the basic axes can be that of a new node.
pub fn own_rotation(place: &Place, reference: Reference, model: &mut Model, definitions: &Definitions) {
    let node = reference.node;
    let is_plain = definitions.pose(node).is_ok_and(|pose| pose.axes == BASIC_AXES);
    if is_plain && !definitions.is_nonlinear && !definitions.rotates(node) {
        model.own_rotations.insert(reference.rotation);
    } else {
        place.fix(model);
    }
}

fn reference(card: &Card, solver: Solver) -> Result<Reference, Problem> {
    let node = |name| card.parameter(name).map(|text| number(text.as_bytes(), "a node")).transpose();
    let reference = node("REFNODE")?.ok_or(Problem::NoParameter { name: "REF NODE" })?;
    let own = Dof { node: reference, component: if solver == Solver::Ccx { UNREACHED } else { 4 } };
    let rotation = node("ROTNODE")?.map_or(own, |node| Dof { node, component: 1 });
    Ok(Reference { node: reference, rotation })
}

fn rows(card: &Card, solver: Solver, definitions: &Definitions) -> Result<Vec<Row>, Problem> {
    let reference = reference(card, solver)?;
    let nodes = match (card.parameter("NSET"), card.parameter("ELSET")) {
        (Some(set), _) => definitions.nodes(set)?.to_vec(),
        (None, Some(set)) => definitions.nodes_of(set)?,
        (None, None) => return Err(Problem::NoParameter { name: "NSET" }),
    };
    let others = nodes.into_iter().filter(|&node| node != reference.node && node != reference.rotation.node);
    kinematic(definitions, reference, others, &[1, 2, 3], None)
}

/// The rows of nodes that follow a reference in these components, along the axes of `local` or their own.
pub fn kinematic(
    definitions: &Definitions,
    reference: Reference,
    nodes: impl Iterator<Item = u32>,
    components: &[u8],
    local: Option<&Local>,
) -> Result<Vec<Row>, Problem> {
    let mut rows = Vec::new();
    for node in nodes {
        let pose = definitions.pose(node)?;
        let axes = local.map_or(pose.axes, |local| local.axes_at(pose.position));
        for &component in components {
            let k = usize::from(component) - 1;
            match k {
                0..3 => rows.push(reference.follows(definitions, node, axes[k])?),
                _ if definitions.rotates(node) => rows.push(reference.turns(node, k - 3)),
                _ => {}
            }
        }
    }
    Ok(rows)
}
