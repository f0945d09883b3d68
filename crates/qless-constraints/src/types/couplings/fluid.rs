//! Structure and fluid with equal normal displacement, node to node or across meshes that do not match.

use std::collections::BTreeSet;

use super::face_integrals::point;
use crate::geometry::search::{FaceSearch, SearchError};
use crate::geometry::shape::{Shape, ShapeParameters};
use crate::geometry::surface::{Face, Surface, SurfaceError};
use crate::scalar::clean;
use crate::scalar::vector::{Vector, add, dot, unit};
use crate::types::Point;
use crate::{Constraint, EquationSink};

/// Equal normal displacements of a structure and a fluid in displacement form, `n . (u_s - u_f) = 0`, a length.
/// Tangential sliding is free.
///
/// At an edge, a pair of nodes may have several normals: equations with linearly independent normals are independent.
/// For a fluid in pressure form, whose mesh may differ, see [`crate::types::FluidWall`].
///
#[doc = include_str!("../../../docs/pictures/fluid_normal.svg")]
///
#[doc = include_str!("../../../docs/types/fluid_normal.md")]
/// # Example
///
/// ```
/// use qless_constraints::{ConstraintSet, types::FluidNormal};
/// let mut builder = ConstraintSet::builder(6);
/// builder.add("wall", FluidNormal { structure: [0, 1, 2], fluid: [3, 4, 5], normal: [3.0, 4.0, 0.0] })?;
/// let g = builder.build()?.allocate().g().clone();
/// assert_eq!(g.row(0).collect::<Vec<_>>(), [(0, 0.6), (1, 0.8), (3, -0.6), (4, -0.8)]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FluidNormal {
    /// Translations of the structure, 0-based DOFs.
    pub structure: [usize; 3],
    /// Translations of the fluid.
    pub fluid: [usize; 3],
    /// The normal n, of any length.
    pub normal: Vector<f64>,
}

/// What can be wrong with a coupling of normal displacements.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FluidNormalError {
    /// The normal is zero or not finite.
    #[error("the normal has no direction; give a vector that is not zero")]
    Normal,
}

impl Constraint for FluidNormal {
    const NAME: &'static str = "structure and fluid";
    type Error = FluidNormalError;

    fn emit(self, sink: &mut EquationSink) -> Result<(), FluidNormalError> {
        let n = unit(self.normal).ok_or(FluidNormalError::Normal)?;
        let side = |dofs: [usize; 3], sign: f64| (0..3).map(move |k| (dofs[k], sign * n[k]));
        let terms = side(self.structure, 1.0).chain(side(self.fluid, -1.0));
        sink.equation("", terms.filter(|&(_, v)| v != 0.0), 0.0);
        Ok(())
    }
}

/// Cosine of 30 degrees, the largest allowed angle between the normal of a face and the mean normal at a node.
const CREASE: f64 = 0.866;

/// A fluid in pressure form at a wall whose mesh differs from that of the fluid (Eq. A7 in Appl. Sci. 15 (2025) 13059).
///
/// `u_n,j - n_j . sum_k N_k(xi_j) u_k = 0` for each node j of the fluid's side of the interface. The DOF `u_n,j` is the
/// normal displacement at node j; it equals that of the nearest point of the structure. The user's matrices must couple
/// `u_n` to the pressure. `n_j` is the mean normal of the fluid's faces at the node, weighted by area. The node order of
/// the faces determines the sign of `n_j`, for example out of the fluid. Equal displacements of both meshes satisfy the equations,
/// and forces on `u_n` act on the structure along `n_j`, with the same resultant.
///
/// At an edge of the wall a node needs one `u_n` per side: give each side as a constraint of its own. Nodes with faces
/// more than 30 degrees off the mean normal are refused. Cost: O(n log n). For a fluid in displacement form see
/// [`crate::types::FluidNormal`].
///
#[doc = include_str!("../../../docs/pictures/fluid_wall.svg")]
///
#[doc = include_str!("../../../docs/types/fluid_wall.md")]
/// # Example
///
/// ```
/// use qless_constraints::ConstraintSet;
/// use qless_constraints::types::{Face, FluidNode, FluidWall, Point, Shape, Surface};
/// let at = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 2.0, 0.0], [0.0, 2.0, 0.0]];
/// let nodes = (0..4).map(|i| Point::new([3 * i, 3 * i + 1, 3 * i + 2], at[i])).collect();
/// let structure = Surface { nodes, faces: vec![Face::new(Shape::Quad4, [0, 1, 2, 3])] };
/// let corners = [[0.5, 0.5, 0.0], [1.5, 0.5, 0.0], [0.5, 1.0, 0.0]];
/// let fluid = (0..3).map(|i| FluidNode { normal: 12 + i, at: corners[i] }).collect();
/// let wall = FluidWall { structure, fluid, faces: vec![Face::new(Shape::Tri3, [0, 1, 2])], tolerance: 1e-9 };
/// let mut builder = ConstraintSet::builder(15);
/// builder.add("tank", wall)?;
/// let g = builder.build()?.allocate().g().clone();
/// assert_eq!(g.row(0).collect::<Vec<_>>(), [(2, -0.5625), (5, -0.1875), (8, -0.0625), (11, -0.1875), (12, 1.0)]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct FluidWall {
    /// The wall, with three translations a node.
    pub structure: Surface<3>,
    /// Nodes of the fluid's side.
    pub fluid: Vec<FluidNode>,
    /// Faces of the fluid's side; they index `fluid`.
    pub faces: Vec<Face>,
    /// Largest distance of a fluid node from the wall, a length.
    pub tolerance: f64,
}

/// A node of the fluid at the interface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FluidNode {
    /// The DOF of the normal displacement `u_n`, 0-based.
    pub normal: usize,
    /// Coordinates at u = 0, a length.
    pub at: Vector<f64>,
}

/// What can be wrong with a wall of a fluid.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FluidWallError {
    /// The fluid's side is not a valid surface.
    #[error("fluid's side: {0}")]
    Fluid(SurfaceError),
    /// The structure's side is not a valid surface, or a node of the fluid is too far from it.
    #[error("structure's side: {0}")]
    Structure(SearchError),
    /// A face of the fluid is a line or a solid.
    #[error("face {face}, from 1, of the fluid is a {shape:?}, which has no normal; give faces")]
    NoFace {
        /// Shape of the face.
        shape: Shape,
        /// Number of the face, counted from 1.
        face: usize,
    },
    /// A DOF is used twice.
    #[error(
        "DOF {dof} of node {node}, from 1, of the fluid also belongs to another node or to the wall; each needs its own"
    )]
    SharedDof {
        /// Number of the node, counted from 1.
        node: usize,
        /// The DOF.
        dof: usize,
    },
    /// The normals of the faces at a node differ too much.
    #[error(
        "face {face} and the mean of all faces at node {node} of the fluid, both from 1, have normals with a cosine of \
         {cosine}, below 0.866: split the wall at its edge, with a DOF for each side, or reverse faces that point to the other side"
    )]
    Crease {
        /// Number of the node, counted from 1.
        node: usize,
        /// Number of the face, counted from 1.
        face: usize,
        /// Cosine of the angle between the normals.
        cosine: f64,
    },
}

/// Nodes of a face and the normals there.
type Normals = Vec<(usize, Vector<f64>)>;

impl FluidWall {
    /// Checks that each fluid node has a DOF of its own.
    fn check_dofs(&self, mut used: impl Iterator<Item = usize>) -> Result<(), FluidWallError> {
        let nodes = self.structure.faces.iter().flat_map(|face| &face.nodes);
        let mut taken: BTreeSet<usize> = nodes.flat_map(|&node| self.structure.nodes[node].dofs).collect();
        let shared = used.find(|&i| !taken.insert(self.fluid[i].normal));
        shared.map_or(Ok(()), |i| Err(FluidWallError::SharedDof { node: i + 1, dof: self.fluid[i].normal }))
    }

    /// The fluid's side as a surface; only its coordinates are used.
    fn side(&self) -> Surface<3> {
        let nodes = self.fluid.iter().map(|node| Point::new([node.normal; 3], node.at)).collect();
        Surface { nodes, faces: self.faces.clone() }
    }

    /// For each face, its nodes and the normals there, scaled in proportion to the area.
    fn face_normals(&self) -> Result<Vec<Normals>, FluidWallError> {
        let side = self.side();
        side.check_integrable().map_err(FluidWallError::Fluid)?;
        let on = |(i, face): (usize, &Face)| {
            let shape = face.shape;
            if shape.dimensions() != 2 {
                return Err(FluidWallError::NoFace { shape, face: i + 1 });
            }
            let places = side.places(i);
            // The area of the face is about the length of the normal times the area of the parameter domain: 1/2 for triangles, 4 for
            // quadrilaterals.
            let share = if shape.corners().len() == 3 { 0.5 } else { 4.0 };
            let at = |(&node, &xi): (&usize, &ShapeParameters)| (node, point(shape, &places, xi).2.map(|x| share * x));
            Ok(face.nodes.iter().zip(shape.places()).map(at).collect())
        };
        self.faces.iter().enumerate().map(on).collect()
    }

    /// The unit normal at each node, `None` for nodes without a face.
    fn normals(&self) -> Result<Vec<Option<Vector<f64>>>, FluidWallError> {
        let faces = self.face_normals()?;
        let mut sums: Vec<Option<Vector<f64>>> = vec![None; self.fluid.len()];
        for &(node, normal) in faces.iter().flatten() {
            sums[node] = Some(add(sums[node].unwrap_or_default(), normal));
        }
        let normals: Vec<Option<Vector<f64>>> = sums.into_iter().map(|sum| sum.map(unit_or_zero)).collect();
        for (face, own) in faces.iter().enumerate() {
            for &(node, normal) in own {
                let cosine = dot(unit_or_zero(normal), normals[node].unwrap_or_default());
                if cosine < CREASE || cosine.is_nan() {
                    return Err(FluidWallError::Crease { node: node + 1, face: face + 1, cosine });
                }
            }
        }
        Ok(normals)
    }
}

/// The unit vector, or zero if x has no direction; zero fails every check of the cosine.
fn unit_or_zero(x: Vector<f64>) -> Vector<f64> {
    let mut normal = unit(x).unwrap_or_default();
    clean(normal.iter_mut(), 1.0);
    normal
}

impl Constraint for FluidWall {
    const NAME: &'static str = "wall of a fluid";
    type Error = FluidWallError;

    fn emit(self, sink: &mut EquationSink) -> Result<(), FluidWallError> {
        let normals = self.normals()?;
        let at_wall = |&(i, n): &(usize, Option<Vector<f64>>)| n.map(|n| (i, n));
        let used: Vec<_> = normals.into_iter().enumerate().filter_map(|pair| at_wall(&pair)).collect();
        let places: Vec<Vector<f64>> = used.iter().map(|&(i, _)| self.fluid[i].at).collect();
        let search = FaceSearch::new(&self.structure).map_err(|fault| FluidWallError::Structure(fault.into()))?;
        let nearest = search.within(&places, self.tolerance).map_err(FluidWallError::Structure)?;
        self.check_dofs(used.iter().map(|&(i, _)| i))?;
        for ((i, n), found) in used.into_iter().zip(nearest) {
            let nodes = self.structure.faces[found.face].nodes.iter().zip(&found.weights);
            let terms = nodes.flat_map(|(&node, w)| {
                let dofs = self.structure.nodes[node].dofs;
                (0..3).map(move |k| (dofs[k], -w * n[k]))
            });
            let all = terms.filter(|&(_, v)| v != 0.0).chain([(self.fluid[i].normal, 1.0)]);
            sink.equation(format!("node {}", i + 1), all, 0.0);
        }
        Ok(())
    }
}
