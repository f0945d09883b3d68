//! Reads `*CONTACT_TIED_NODES_TO_SURFACE` and `*CONTACT_TIED_SURFACE_TO_SURFACE`. The translations u_s of each slave node follow the
//! nearest point of a master segment, `u_s = sum N_i u_i`: N_i are the shape functions of the segment at this point, and u_i the
//! translations of its nodes. The solver moves the slave node to this point.
//!
//! ```text
//! line 1   SSID, MSID, SSTYP, MSTYP, SBOXID, MBOXID     types: 0 segment set, 2 part set, 3 part, 4 node set
//! line 2   friction
//! line 3   SFS, SFM, SST, MST
//! ```

use rustc_hash::FxHashMap;

use super::GroupMeaning;
use crate::deck::kinematics::body::{CouplingEquation, Poses};
use crate::deck::kinematics::project::{FaceGrid, MasterFace};
use crate::deck::lsdyna::model::bodies::DynaDefinitions;
use crate::deck::lsdyna::model::mesh::{DynaElement, DynaMesh, ElementKind, Gap, SetKind};
use crate::deck::lsdyna::syntax::fields::DynaLine;
use crate::deck::{Dof, Problem};

/// A node is tied if its distance from the segment is at most `max(OF_DIAGONAL * d, OF_THICKNESS * t)`. Here d is the shorter diagonal of
/// the segment, and t the sum of the thicknesses SST and MST (Keyword Manual, remarks on tied contact).
const OF_DIAGONAL: f64 = 0.05;
const OF_THICKNESS: f64 = 0.6;

/// The equations that tie the slave nodes of a contact to its master segments.
pub fn tie(lines: &[DynaLine], all: &mut DynaDefinitions) -> Result<GroupMeaning, Gap> {
    let (line, mesh) = (&lines[0], &all.mesh);
    if line.id(4)? != 0 || line.id(5)? != 0 {
        return Err(Gap::Unread("ties only what is in a box (SBOXID, MBOXID)".into()));
    }
    let thickness = match lines.get(2) {
        Some(line) => line.number(2)?.unwrap_or(0.0).abs() + line.number(3)?.unwrap_or(0.0).abs(),
        None => 0.0,
    };
    let position = |node| mesh.pose(node).map(|pose| pose.position);
    let faces = MasterFace::all(masters(line, mesh)?, false, position).map_err(|problem| line.fault_at(1, problem))?;
    let reach = |face: &MasterFace| (OF_DIAGONAL * face.least_diagonal()).max(OF_THICKNESS * thickness);
    let grid = FaceGrid::new(&faces, faces.iter().map(reach).fold(0.0, f64::max));
    let (mut made, mut apart) = (GroupMeaning::default(), Vec::new());
    for node in slaves(line, mesh)? {
        let at = position(node).map_err(|problem| line.fault_at(0, problem))?;
        match grid.nearest(&faces, at).filter(|near| near.distance <= reach(&faces[near.face])) {
            Some(near) if faces[near.face].nodes.contains(&node) => {}
            Some(near) => made.rows.extend(rows(node, &faces[near.face].nodes, &near.weights)),
            None => apart.push(node),
        }
    }
    let Some(first) = apart.first() else { return Ok(made) };
    if thickness == 0.0 && mesh.has_shells() {
        let why = format!("needs the thickness of shells to tie nodes such as {first} (write SST and MST)");
        return Ok(GroupMeaning { left_out: Some(why), ..made });
    }
    made.warning =
        Some(format!("leaves {} nodes free that are too far from the surface, such as {first}", apart.len()));
    Ok(made)
}

/// The equations of the three translations of a tied node.
fn rows(node: u32, masters: &[u32], weights: &[f64]) -> impl Iterator<Item = CouplingEquation> {
    (1..=3).map(move |component| {
        let term = |(&master, &weight): (&u32, &f64)| (Dof { node: master, component }, weight);
        CouplingEquation::new(Dof { node, component }, masters.iter().zip(weights).map(term))
    })
}

fn slaves(line: &DynaLine, mesh: &DynaMesh) -> Result<Vec<u32>, Gap> {
    let mut nodes = match line.whole(2)? {
        0 => mesh.members(SetKind::Segment, line, 0)?.to_vec(),
        4 => mesh.members(SetKind::Node, line, 0)?.to_vec(),
        kind => elements(line, 0, kind, mesh)?.into_iter().flat_map(|element| &element.nodes).copied().collect(),
    };
    nodes.sort_unstable();
    nodes.dedup();
    Ok(nodes)
}

fn masters(line: &DynaLine, mesh: &DynaMesh) -> Result<Vec<Vec<u32>>, Gap> {
    let faces = match line.whole(3)? {
        0 => mesh.members(SetKind::Segment, line, 1)?.chunks(4).map(distinct).collect(),
        kind => outside(elements(line, 1, kind, mesh)?),
    };
    match faces.iter().find(|face| !(3..=4).contains(&face.len())) {
        Some(face) => {
            let what = format!("a segment has {} different nodes instead of 3 or 4", face.len());
            Err(line.fault_at(1, Problem::Degenerate { what }).into())
        }
        None => Ok(faces),
    }
}

/// Elements of a part or of a part set.
fn elements<'a>(line: &DynaLine, field: usize, kind: i64, mesh: &'a DynaMesh) -> Result<Vec<&'a DynaElement>, Gap> {
    match kind {
        2 => mesh.elements_of(mesh.members(SetKind::Part, line, field)?),
        3 => mesh.elements_of(&[line.id(field)?]),
        other => Err(Gap::Unread(format!("names a surface by type {other}"))),
    }
}

/// The faces of shells, and those faces of solids that belong to only one solid.
fn outside(elements: Vec<&DynaElement>) -> Vec<Vec<u32>> {
    const SIDES: [[usize; 4]; 6] = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];
    let (shells, others): (Vec<_>, Vec<_>) = elements.into_iter().partition(|one| one.kind == ElementKind::Shell);
    let mut faces: Vec<Vec<u32>> = Vec::new();
    for DynaElement { nodes, .. } in
        others.into_iter().filter(|one| one.kind == ElementKind::Solid && one.nodes.len() > 3)
    {
        // Index of the last corner. A tetrahedron repeats its last corner, unless it has ten nodes, of which four are corners.
        let last = if nodes.len() == 10 { 3 } else { nodes.len().min(8) - 1 };
        let sides = SIDES.iter().map(|side| distinct(&side.map(|k| nodes[k.min(last)])));
        faces.extend(sides.filter(|side| side.len() > 2));
    }
    let key = |face: &Vec<u32>| {
        let mut key = face.clone();
        key.sort_unstable();
        key
    };
    let mut users = FxHashMap::<Vec<u32>, usize>::default();
    faces.iter().for_each(|face| *users.entry(key(face)).or_default() += 1);
    faces.retain(|face| users[&key(face)] == 1);
    faces.extend(shells.into_iter().map(|shell| distinct(&shell.nodes[..shell.nodes.len().min(4)])));
    faces
}

/// The nodes of a face, each once: a triangle has its last node twice.
fn distinct(face: &[u32]) -> Vec<u32> {
    let mut nodes: Vec<u32> = Vec::with_capacity(face.len());
    for node in face {
        if !nodes.contains(node) {
            nodes.push(*node);
        }
    }
    nodes
}
