//! Reads `/INTER/TYPE2`. A slave node s follows the point p of a master face below it: with the shape functions N_i at this point,
//!
//! ```text
//! Spotflag 0, 2, 5     u_s = sum N_i u_i + (sum N_i w_i) x (x_s - x_p),   w_s = sum N_i w_i
//! Spotflag 4           u_s = sum N_i u_i
//! Spotflag 1           u_s, w_s: the rigid motion nearest to the translations of the face
//!
//! grnd_IDs, surf_IDm, Ignore, Spotflag, Level, Isearch, Idel2, surf_IDs, dsearch (20 columns)
//! ```
//!
//! Other values of Spotflag mean springs or ties that fail. Nodes of solids have no rotations w.

use super::own;
use crate::deck::Dof;
use crate::deck::keyword::group::{Gap, GroupMeaning};
use crate::deck::keyword::line::{FieldLayout, KeywordLine};
use crate::deck::keyword::tied::{TiedSurface, follow};
use crate::deck::kinematics::axes::BASIC_AXES;
use crate::deck::kinematics::body::{CouplingEquation, Poses};
use crate::deck::kinematics::components::Components;
use crate::deck::kinematics::mean::{MeanElement, WeightedNodes};
use crate::deck::kinematics::project::{MasterFace, NearestPoint};
use crate::deck::kinematics::vector::{Vector, cross, dot, length, minus, plus, scaled, unit};
use crate::deck::radioss::model::mesh::RadiossMesh;

/// If Ignore is 2 or 3, a node is tied if its distance from the face is at most this part of the longer diagonal of the face, or 60 % of the
/// thicknesses of both sides (starter, `i2buc1.F`).
const OF_DIAGONAL: f64 = 0.05;
/// The solver warns of nodes that lie beyond an edge by 1 % of the face (starter, `i2tid3.F`). It extrapolates there.
const BEYOND: f64 = 0.01;

/// The equations that tie the nodes of a group to a surface.
pub fn tie(lines: &[KeywordLine], mesh: &mut RadiossMesh) -> Result<GroupMeaning, Gap> {
    let line = &lines[0];
    let kind = line.whole(3)?;
    match kind {
        0 | 1 | 2 | 4 | 5 => {}
        25 | 26 => return Err(Gap::Unread("ties by springs, which are no equations (Spotflag)".into())),
        other => return Err(Gap::Unread(format!("ties nodes with Spotflag = {other}"))),
    }
    let surface = surface(line, mesh)?;
    let mut ties = Ties { kind, mesh, surface: &surface, made: GroupMeaning::default(), apart: Vec::new(), why: None };
    for node in mesh.group_nodes(line, 0)? {
        ties.node(line, node)?;
    }
    let ignore = line.whole(2)?;
    let has_thickness = ignore > 1 && number(line)? == 0.0 && mesh.elements.has_shells();
    let made = ties.finish(ignore > 0, has_thickness);
    mesh.tied.extend(made.rows.iter().map(|row| row.terms[0].0.node));
    Ok(made)
}

/// The distance dsearch; 0 if it is blank.
fn number(line: &KeywordLine) -> Result<f64, Gap> {
    Ok(line.laid_out(FieldLayout::Wide).number(8)?.unwrap_or(0.0))
}

/// The master surface. By default, it reaches as far as its edges are long, in the mean of squares.
fn surface(line: &KeywordLine, mesh: &RadiossMesh) -> Result<TiedSurface, Gap> {
    let (faces, given) = (mesh.surface(line, 1)?, number(line)?);
    let place = |node: &u32| mesh.pose(*node).map_or([0.0; 3], |pose| pose.position);
    let edges = |face: &Vec<u32>| -> f64 {
        let at: Vec<Vector> = face.iter().map(place).collect();
        (0..at.len()).map(|k| length(minus(at[k], at[(k + 1) % at.len()])).powi(2)).sum()
    };
    let all = (faces.iter().map(edges).sum::<f64>() / (4.0 * faces.len().max(1) as f64)).sqrt();
    let by_diagonal = line.whole(2)? > 1;
    let reach = |face: &MasterFace| match given {
        0.0 if by_diagonal => OF_DIAGONAL * face.longest_diagonal(),
        0.0 => all,
        given => given,
    };
    TiedSurface::new(line, 1, faces, mesh, reach)
}

/// The ties of the nodes so far.
struct Ties<'a> {
    kind: i64,
    mesh: &'a RadiossMesh,
    surface: &'a TiedSurface,
    made: GroupMeaning,
    /// Nodes that are too far from the surface.
    apart: Vec<u32>,
    /// Why some nodes are not tied although the solver ties them.
    why: Option<String>,
}

impl Ties<'_> {
    fn node(&mut self, line: &KeywordLine, node: u32) -> Result<(), Gap> {
        let at = self.mesh.pose(node).map_err(|problem| line.fault_at(0, problem))?.position;
        let Some(near) = self.surface.nearest(at) else {
            self.apart.push(node);
            return Ok(());
        };
        let face = &self.surface.faces[near.face];
        if face.nodes.contains(&node) {
            return Ok(());
        }
        let arm = self.arm(at, face, &near);
        let beyond = unit(face.normal()).map_or(0.0, |normal| length(minus(arm, scaled(normal, dot(arm, normal)))));
        if beyond > BEYOND * face.longest_diagonal() {
            self.why = Some(format!("ties nodes beyond the edge of the surface, such as {node}"));
        } else if self.kind == 1 {
            self.made.rows.extend(self.spot(line, node, face)?);
            self.made.is_linearised = true;
        } else {
            self.follow(node, face, &near, arm);
        }
        Ok(())
    }

    /// The vector from the nearest point of a face to a position.
    fn arm(&self, at: Vector, face: &MasterFace, near: &NearestPoint) -> Vector {
        let place = |node: &u32| self.mesh.pose(*node).map_or([0.0; 3], |pose| pose.position);
        let terms = face.nodes.iter().zip(&near.weights).map(|(node, weight)| scaled(place(node), *weight));
        minus(at, terms.fold([0.0; 3], plus))
    }

    /// Adds the equations of a node that follows the point of a face.
    fn follow(&mut self, node: u32, face: &MasterFace, near: &NearestPoint, arm: Vector) {
        let rotating: Vec<(u32, f64)> = face
            .nodes
            .iter()
            .zip(&near.weights)
            .filter(|&(&master, &weight)| weight != 0.0 && self.mesh.elements.rotates(master))
            .map(|(&master, &weight)| (master, weight))
            .collect();
        let has_all = rotating.len() == near.weights.iter().filter(|weight| **weight != 0.0).count();
        let turns = self.kind != 4;
        for (mut row, axis) in follow(node, 1..=3, &face.nodes, &near.weights).zip(BASIC_AXES) {
            // Component e of w x r is w . (r x e).
            let turned = cross(arm, axis);
            for &(master, weight) in rotating.iter().filter(|_| turns) {
                let term = |(component, x): (u8, f64)| (Dof { node: master, component }, -weight * x);
                row.terms.extend((4..).zip(turned).map(term).filter(|(_, x)| *x != 0.0));
            }
            self.made.rows.push(row);
        }
        match self.mesh.elements.rotates(node) && turns {
            true if has_all => self.made.rows.extend(follow(node, 4..=6, &face.nodes, &near.weights)),
            true => self.why = Some(format!("ties rotations to solids, such as those of node {node}")),
            false => {}
        }
    }

    /// The equations of a node that follows the nearest rigid motion of a face. A triangle counts its last node twice.
    fn spot(&self, line: &KeywordLine, node: u32, face: &MasterFace) -> Result<Vec<CouplingEquation>, Gap> {
        let mut nodes = face.nodes.clone();
        nodes.extend(nodes.last().copied().filter(|_| nodes.len() == 3));
        let groups = vec![WeightedNodes { weight: 1.0, components: Components::TRANSLATIONS, nodes }];
        let components = own(self.mesh, node, Components::ALL);
        let element = MeanElement { reference: node, components, groups, dependent: Vec::new() };
        element.equations(self.mesh).map_err(|problem| line.fault(problem).into())
    }

    /// What the ties mean. Nodes that are too far stay free, unless the solver stops at them, or ties them by the thickness of shells.
    fn finish(self, stays_free: bool, has_thickness: bool) -> GroupMeaning {
        let Self { mut made, apart, why, .. } = self;
        made.left_out = why;
        let Some(first) = apart.first() else { return made };
        let count = apart.len();
        if !stays_free {
            let why =
                format!("names {count} nodes that are too far from the surface, such as {first}, where Radioss stops");
            made.left_out = Some(why);
        } else if has_thickness {
            made.left_out = Some(format!("needs the thickness of shells to tie nodes such as {first} (write dsearch)"));
        } else {
            made.warning =
                Some(format!("leaves {count} nodes free that are too far from the surface, such as {first}"));
        }
        made
    }
}
