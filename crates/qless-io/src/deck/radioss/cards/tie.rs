//! Reads `/INTER/TYPE2`. A slave node s follows the point p of a master face below it (see [`face_point`]), with the weights N_i there:
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
use super::segment::{FacePoint, face_point};
use crate::deck::Dof;
use crate::deck::keyword::group::{Gap, GroupMeaning};
use crate::deck::keyword::line::{FieldLayout, KeywordLine};
use crate::deck::keyword::tied::{TiedSurface, follow};
use crate::deck::kinematics::axes::BASIC_AXES;
use crate::deck::kinematics::body::{CouplingEquation, Poses};
use crate::deck::kinematics::components::Components;
use crate::deck::kinematics::mean::{MeanElement, WeightedNodes};
use crate::deck::kinematics::project::MasterFace;
use crate::deck::kinematics::vector::{Vector, cross, length, minus};
use crate::deck::radioss::model::mesh::RadiossMesh;

/// If Ignore is 2 or 3, a node is tied if its distance from the face is at most this part of the longer diagonal of the face, or 60 % of the
/// thicknesses of both sides (starter, `i2buc1.F`).
const OF_DIAGONAL: f64 = 0.05;
/// If Ignore is not 0, a node is not tied if a parameter of its point is larger; on the face, parameters are from -1 to 1 (`i2dst3.F`).
const BEYOND: f64 = 1.5;

/// The equations that tie the nodes of a group to a surface.
pub fn tie(lines: &[KeywordLine], mesh: &mut RadiossMesh) -> Result<GroupMeaning, Gap> {
    let (line, kind) = (&lines[0], lines[0].whole(3)?);
    match kind {
        0 | 1 | 2 | 4 | 5 => {}
        25 | 26 => return Err(Gap::Unread("ties by springs, which are no equations (Spotflag)".into())),
        other => return Err(Gap::Unread(format!("ties nodes with Spotflag = {other}"))),
    }
    let made = SurfaceTies::new(line, kind, mesh)?.all(mesh.group_nodes(line, 0)?)?;
    mesh.tied.extend(made.rows.iter().map(|row| row.terms[0].0.node));
    Ok(made)
}

/// The distance dsearch; 0 if it is blank.
fn given_reach(line: &KeywordLine) -> Result<f64, Gap> {
    Ok(line.laid_out(FieldLayout::Wide).number(8)?.unwrap_or(0.0))
}

/// The master surface. By default, it reaches as far as its edges are long, in the mean of squares.
fn surface(line: &KeywordLine, mesh: &RadiossMesh) -> Result<TiedSurface, Gap> {
    let (faces, given, by_diagonal) = (mesh.surface(line, 1)?, given_reach(line)?, line.whole(2)? > 1);
    let edges = |face: &Vec<u32>| -> f64 {
        let at = corners(face, mesh);
        (0..at.len()).map(|k| length(minus(at[k], at[(k + 1) % at.len()])).powi(2)).sum()
    };
    let mean = (faces.iter().map(edges).sum::<f64>() / (4.0 * faces.len().max(1) as f64)).sqrt();
    let reach = |face: &MasterFace| match given {
        0.0 if by_diagonal => OF_DIAGONAL * face.longest_diagonal(),
        0.0 => mean,
        given => given,
    };
    TiedSurface::new(line, 1, faces, mesh, reach)
}

/// The positions of the nodes of a face.
fn corners(face: &[u32], mesh: &RadiossMesh) -> Vec<Vector> {
    face.iter().map(|node| mesh.pose(*node).map_or([0.0; 3], |pose| pose.position)).collect()
}

/// The ties of some nodes to a surface.
struct SurfaceTies<'a> {
    line: &'a KeywordLine<'a>,
    mesh: &'a RadiossMesh,
    surface: TiedSurface,
    kind: i64,
    /// 0 if the solver stops at nodes that are too far, and 2 or 3 if thicknesses count.
    ignore: i64,
    made: GroupMeaning,
    /// Nodes that are too far from the surface.
    apart: Vec<u32>,
}

impl<'a> SurfaceTies<'a> {
    fn new(line: &'a KeywordLine, kind: i64, mesh: &'a RadiossMesh) -> Result<Self, Gap> {
        let (surface, ignore) = (surface(line, mesh)?, line.whole(2)?);
        Ok(Self { line, mesh, surface, kind, ignore, made: GroupMeaning::default(), apart: Vec::new() })
    }

    /// The equations of all nodes. Nodes that are too far stay free, unless the solver stops at them, or ties them by the thickness of shells.
    fn all(mut self, nodes: Vec<u32>) -> Result<GroupMeaning, Gap> {
        nodes.into_iter().try_for_each(|node| self.node(node))?;
        let Self { mut made, apart, line, mesh, ignore, .. } = self;
        let Some(first) = apart.first() else { return Ok(made) };
        let far = format!("nodes that are too far from the surface, such as {first}");
        if ignore == 0 {
            made.left_out = Some(format!("names {far}, where Radioss stops"));
        } else if ignore > 1 && given_reach(line)? == 0.0 && mesh.elements.has_shells() {
            made.left_out = Some(format!("needs the thickness of shells to tie {far} (write dsearch)"));
        } else {
            made.warning = Some(format!("leaves free {} {far}", apart.len()));
        }
        Ok(made)
    }

    fn node(&mut self, node: u32) -> Result<(), Gap> {
        let at = self.mesh.pose(node).map_err(|problem| self.line.fault_at(0, problem))?.position;
        let face = self.surface.nearest(at).map(|near| self.surface.faces[near.face].nodes.clone());
        let Some(face) = face else {
            self.apart.push(node);
            return Ok(());
        };
        let point = face_point(at, &corners(&face, self.mesh));
        match point.filter(|point| self.ignore == 0 || point.largest() < BEYOND) {
            _ if face.contains(&node) => {}
            Some(_) if self.kind == 1 => self.follow_motion(node, face)?,
            Some(point) => self.follow_point(node, &face, &point, minus(at, point.position)),
            None => self.apart.push(node),
        }
        Ok(())
    }

    /// Adds the equations of a node that follows a point of a face. `arm` leads from the point to the node.
    fn follow_point(&mut self, node: u32, face: &[u32], point: &FacePoint, arm: Vector) {
        let masters: Vec<(u32, f64)> = face.iter().copied().zip(point.weights.iter().copied()).collect();
        let weighing = masters.iter().filter(|(_, weight)| *weight != 0.0);
        let rotating: Vec<&(u32, f64)> =
            weighing.clone().filter(|(node, _)| self.mesh.elements.rotates(*node)).collect();
        let (has_all, turns) = (rotating.len() == weighing.count(), self.kind != 4);
        for (mut row, axis) in follow(node, 1..=3, face, &point.weights).zip(BASIC_AXES) {
            // Component e of w x r is w . (r x e).
            let turned = cross(arm, axis);
            for &&(node, weight) in rotating.iter().filter(|_| turns) {
                let term = |(component, x): (u8, f64)| (Dof { node, component }, -weight * x);
                row.terms.extend((4..).zip(turned).map(term).filter(|(_, x)| *x != 0.0));
            }
            self.made.rows.push(row);
        }
        match self.mesh.elements.rotates(node) && turns {
            true if has_all => self.made.rows.extend(follow(node, 4..=6, face, &point.weights)),
            true => self.made.left_out = Some(format!("ties rotations to solids, such as those of node {node}")),
            false => {}
        }
    }

    /// Adds the equations of a node that follows the nearest rigid motion of a face. A triangle counts its last node twice.
    fn follow_motion(&mut self, node: u32, mut nodes: Vec<u32>) -> Result<(), Gap> {
        nodes.extend(nodes.last().copied().filter(|_| nodes.len() == 3));
        let groups = vec![WeightedNodes { weight: 1.0, components: Components::TRANSLATIONS, nodes }];
        let components = own(self.mesh, node, Components::ALL);
        let element = MeanElement { reference: node, components, groups, dependent: Vec::new() };
        let rows: Vec<CouplingEquation> = element.equations(self.mesh).map_err(|problem| self.line.fault(problem))?;
        self.made.is_linearised = true;
        self.made.rows.extend(rows);
        Ok(())
    }
}
