//! Ties of nodes to a surface: the translations u_s of a node follow the nearest point of a face, `u_s = sum N_i u_i`. N_i are the shape
//! functions of the face at this point, and u_i the translations of its nodes.

use super::group::Gap;
use super::line::KeywordLine;
use crate::deck::kinematics::body::{CouplingEquation, Poses};
use crate::deck::kinematics::project::{FaceGrid, MasterFace, NearestPoint};
use crate::deck::kinematics::vector::Vector;
use crate::deck::{Dof, Problem};

/// The faces of a surface, each with the largest distance at which it ties a node.
pub struct TiedSurface {
    pub faces: Vec<MasterFace>,
    reaches: Vec<f64>,
    grid: FaceGrid,
}

impl TiedSurface {
    /// Makes a surface of these faces, which the field of a line names.
    pub fn new(
        line: &KeywordLine,
        field: usize,
        faces: Vec<Vec<u32>>,
        poses: &impl Poses,
        reach: impl Fn(&MasterFace) -> f64,
    ) -> Result<Self, Gap> {
        if let Some(face) = faces.iter().find(|face| !(3..=4).contains(&face.len())) {
            let what = format!("a segment has {} different nodes instead of 3 or 4", face.len());
            return Err(line.fault_at(field, Problem::Degenerate { what }).into());
        }
        let position = |node| poses.pose(node).map(|pose| pose.position);
        let faces = MasterFace::all(faces, false, position).map_err(|problem| line.fault_at(field, problem))?;
        let reaches: Vec<f64> = faces.iter().map(reach).collect();
        let grid = FaceGrid::new(&faces, reaches.iter().copied().fold(0.0, f64::max));
        Ok(Self { faces, reaches, grid })
    }

    /// The point nearest to `at`; `None` if no face reaches so far.
    pub fn nearest(&self, at: Vector) -> Option<NearestPoint> {
        self.grid.nearest(&self.faces, at).filter(|near| near.distance <= self.reaches[near.face])
    }
}

/// The equations by which components of a node follow the weighted mean of those of other nodes.
pub fn follow(
    node: u32,
    components: std::ops::RangeInclusive<u8>,
    masters: &[u32],
    weights: &[f64],
) -> impl Iterator<Item = CouplingEquation> {
    components.map(move |component| {
        let term = |(&master, &weight): (&u32, &f64)| (Dof { node: master, component }, weight);
        CouplingEquation::new(Dof { node, component }, masters.iter().zip(weights).map(term))
    })
}
