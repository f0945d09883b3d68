//! Reads rigid bodies: node k follows the main node m with its rotation w, `u_k = u_m + w x (x_k - x_m)`, where x are positions.
//!
//! ```text
//! /RBODY    node_ID, sens_ID, Skew_ID, Ispher, Mass (20 columns), grnd_ID, Ikrem, ICoG, surf_ID
//!           two lines with inertia
//!           Ioptoff, Iexpams, Ifail
//! /RBE2     node_ID, Trarot, skew_ID, grnod_ID, Iflag
//! ```

use super::{along, led, marked, own};
use crate::deck::Dof;
use crate::deck::keyword::group::{Gap, GroupMeaning, is_without_axes};
use crate::deck::keyword::line::KeywordLine;
use crate::deck::kinematics::body::{CouplingEquation, Pose, Poses};
use crate::deck::kinematics::components::Components;
use crate::deck::kinematics::rigid::RigidElement;
use crate::deck::kinematics::vector::Vector;
use crate::deck::radioss::model::mesh::{RadiossBody, RadiossMesh};

/// The nodes of the group that a field names, without the main node.
fn slaves(line: &KeywordLine, field: usize, main: u32, mesh: &RadiossMesh) -> Result<Vec<u32>, Gap> {
    let nodes = mesh.group_nodes(line, field)?;
    Ok(nodes.into_iter().filter(|node| *node != main).collect())
}

/// The equations by which nodes follow a main node with all of their components.
pub fn rigid(lines: &[KeywordLine], mesh: &mut RadiossMesh) -> Result<GroupMeaning, Gap> {
    let line = &lines[0];
    if line.whole(1)? != 0 {
        return Err(Gap::Unread("holds only while its sensor is active".into()));
    }
    if lines.get(3).map_or(Ok(0), |line| line.whole(2))? != 0 {
        return Err(Gap::Unread("holds only until it fails (Ifail)".into()));
    }
    let main = mesh.node_at(line, 0)?;
    // A body without a group may get nodes only by cards that are not read.
    let nodes = if line.whole(6)? == 0 { Vec::new() } else { slaves(line, 6, main, mesh)? };
    if nodes.is_empty() {
        return Ok(GroupMeaning::default());
    }
    let rows = following(line, main, &nodes, Components::ALL, mesh)?;
    let moves = matches!(line.whole(8)?, 0..=2);
    mesh.bodies.push(RadiossBody { main, slaves: nodes, moves, place: mesh.card.clone() });
    Ok(GroupMeaning { is_linearised: true, rows, ..GroupMeaning::default() })
}

/// The equations by which components of nodes, in a skew frame, follow a main node.
pub fn rbe2(lines: &[KeywordLine], mesh: &mut RadiossMesh) -> Result<GroupMeaning, Gap> {
    let (line, marked) = (&lines[0], marked(&lines[0], 1)?);
    let set = if marked.is_empty() { Components::ALL } else { marked };
    let main = mesh.node_at(line, 0)?;
    if set != Components::ALL && line.whole(4)? != 0 {
        return Err(Gap::Unread("has another rotation than its main node (Iflag)".into()));
    }
    let nodes = slaves(line, 3, main, mesh)?;
    mesh.links.push(RadiossBody { main, slaves: nodes.clone(), moves: false, place: mesh.card.clone() });
    let rows = match mesh.axes(line, 2)?.filter(|_| !is_without_axes(set)) {
        _ if nodes.is_empty() => Vec::new(),
        None => following(line, main, &nodes, set, mesh)?,
        Some(axes) => in_frame(line, main, &nodes, set, &axes, mesh)?,
    };
    Ok(GroupMeaning { is_linearised: !rows.is_empty(), rows, ..GroupMeaning::default() })
}

fn following(
    line: &KeywordLine,
    main: u32,
    nodes: &[u32],
    set: Components,
    mesh: &RadiossMesh,
) -> Result<Vec<CouplingEquation>, Gap> {
    let dependent = nodes.iter().map(|&node| (node, own(mesh, node, set))).collect();
    let element = RigidElement { independent: vec![(main, Components::ALL)], dependent };
    element.equations(mesh).map_err(|problem| line.fault(problem).into())
}

/// The equations `e . u_k - e . u_m - (r x e) . w = 0` and `e . w_k - e . w = 0`, where e is an axis of the frame and r the arm of node k.
fn in_frame(
    line: &KeywordLine,
    main: u32,
    nodes: &[u32],
    set: Components,
    axes: &[Vector; 3],
    mesh: &RadiossMesh,
) -> Result<Vec<CouplingEquation>, Gap> {
    let position = |node| mesh.pose(node).map(|pose| pose.position).map_err(|problem| Gap::from(line.fault(problem)));
    let (centre, mut rows) = (position(main)?, Vec::new());
    for &node in nodes {
        let pose = Pose { position: position(node)?, axes: *axes };
        for component in own(mesh, node, set).iter() {
            let mut terms = along(node, component, axes);
            let count = terms.len();
            let moved = (1..).zip(pose.row(component, centre)).filter(|(_, x)| *x != 0.0);
            terms.extend(moved.map(|(component, x)| (Dof { node: main, component }, -x)));
            rows.push(led(&rows, terms, count));
        }
    }
    Ok(rows)
}
