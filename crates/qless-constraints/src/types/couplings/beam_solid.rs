//! `u_b + theta x r`: the end of a beam joined to a face of a solid.

use super::Section;
use super::equations::{RepeatedNodes, check, follow, lead};
use super::error::CouplingError;
use super::face_integrals::{self, mean_normal};
use super::mean_rigid_motion::MeanRigidMotion;
use super::node6::{CoupledComponent, Node6};
use super::rigid_motion::{about, along, arm};
use crate::geometry::node::AXES;
use crate::geometry::surface::Surface;
use crate::scalar::vector::{Vector, axis, perpendicular};
use crate::{Constraint, EquationSink};

/// The end of a beam joined to a face of a solid, for small rotations.
///
/// With `r = X - X_b` and the normal n of the face, the equations are one of
///
/// - [`Section::Rigid`]: `u_i = u_b + theta x r_i` at each of the N nodes of the face, 3 N equations;
/// - [`Section::Plane`]: `n . u_i = n . (u_b + theta x r_i)` at each node, and the mean motion within the plane,
///   `N + 3` equations;
/// - [`Section::Mean`]: `(u_b, theta) = argmin int |u - u_b - theta x r|^2 dA`, one equation for each DOF of the beam's
///   node, at most six. At the minimum, `int (u - u_b - theta x r) dA = 0` and `int r x (u - u_b - theta x r) dA = 0`.
///
/// The integrals use the shape functions of the faces, `u = sum N_i u_i`. So a node has the weight `int N_i dA`, its
/// tributary area, and the first moment `int N_i r dA`. With `Mean` the beam therefore applies the nodal forces of a stress
/// that is linear over the section, for every mesh: under pure tension and bending the stress in the solid is exact.
/// For all three choices, forces and moments of the beam equal the resultants on the face, as rigid motions satisfy
/// every equation.
///
/// With `Rigid`, other ties of these nodes easily become redundant or conflicting. Cost: O(nodes + faces).
///
#[doc = include_str!("../../../docs/pictures/beam_to_solid.svg")]
///
#[doc = include_str!("../../../docs/types/beam_to_solid.md")]
/// # Example
///
/// ```
/// use qless_constraints::ConstraintSet;
/// use qless_constraints::types::{BeamToSolid, Face, Node6, Point, Section, Shape, Surface};
/// let at = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
/// let nodes = (0..4).map(|i| Point::new([6 + 3 * i, 7 + 3 * i, 8 + 3 * i], at[i])).collect();
/// let face = Surface { nodes, faces: vec![Face::new(Shape::Quad4, [0, 1, 2, 3])] };
/// let beam = Node6::new([0, 1, 2], [3, 4, 5], [1.0, 0.5, 0.0]);
/// for (section, equations) in [(Section::Rigid, 12), (Section::Plane, 7), (Section::Mean, 6)] {
///     let mut builder = ConstraintSet::builder(18);
///     builder.add("end", BeamToSolid { beam, face: face.clone(), section })?;
///     assert_eq!(builder.build()?.equations(), equations);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct BeamToSolid {
    /// The end node of the beam. With `Mean`, a DOF that is `None` is not coupled: a hinge, possibly about a local
    /// axis ([`Node6::along`]).
    pub beam: Node6,
    /// The face of the solid. `Plane` needs faces with consistent normals; `Rigid` and `Mean` accept any faces, such as
    /// the wall of a hole.
    pub face: Surface<3>,
    /// How the section may deform.
    pub section: Section,
}

impl BeamToSolid {
    /// The nodes of the faces, in ascending order, without repetition.
    fn nodes(&self) -> Vec<(usize, Node6)> {
        let mut used: Vec<usize> = self.face.faces.iter().flat_map(|face| face.nodes.iter().copied()).collect();
        used.sort_unstable();
        used.dedup();
        used.into_iter().map(|i| (i, self.face.nodes[i].into())).collect()
    }

    /// Adds `e . u_i = e . (u_b + theta x r_i)` at each node i of the face, which is at `r_i` from the beam's node b.
    fn equation_per_node(&self, sink: &mut EquationSink, e: Vector<f64>, name: &str) -> Result<(), CouplingError> {
        for (i, node) in self.nodes() {
            let terms = self.along(i, e, 1.0).collect();
            let motion = along(e, arm(node.at, self.beam.at));
            follow(sink, format!("node {}, {name}", i + 1), terms, &self.beam, motion)?;
        }
        Ok(())
    }

    /// The terms of `factor e . u_i`, where `u_i` is the displacement of `node`.
    fn along(&self, node: usize, e: Vector<f64>, factor: f64) -> impl Iterator<Item = (usize, f64)> + use<> {
        let dofs = self.face.nodes[node].dofs;
        (0..3).map(move |k| (dofs[k], factor * e[k]))
    }

    /// Adds `motion . (u_b, theta) = motion . q` with six coefficients `motion`. `u_b` and theta are the motion of the beam's node, q is
    /// the mean rigid motion of the face at that node.
    fn mean(
        &self,
        sink: &mut EquationSink,
        fit: &MeanRigidMotion,
        motion: [f64; 6],
        name: String,
    ) -> Result<(), CouplingError> {
        let terms = fit.terms(&self.face, motion, self.beam.at)?;
        lead(sink, name, terms.into_iter(), &self.beam, motion)
    }
}

impl Constraint for BeamToSolid {
    const NAME: &'static str = "beam to solid";
    type Error = CouplingError;

    fn emit(self, sink: &mut EquationSink) -> Result<(), CouplingError> {
        let points = face_integrals::points(&self.face)?;
        let again = if self.section == Section::Mean { RepeatedNodes::Allowed } else { RepeatedNodes::Refused };
        check(&self.beam, self.nodes().iter().map(|(_, node)| node), again)?;
        match self.section {
            Section::Rigid => (0..3).try_for_each(|k| self.equation_per_node(sink, axis(k), AXES[k])),
            Section::Plane => {
                let normal = mean_normal(&points)?;
                self.equation_per_node(sink, normal, "normal")?;
                let mean_motion = MeanRigidMotion::new(points);
                let [s, t] = perpendicular(normal);
                let no_arm = [0.0; 3];
                self.mean(sink, &mean_motion, along(s, no_arm), "in the plane 1".to_owned())?;
                self.mean(sink, &mean_motion, along(t, no_arm), "in the plane 2".to_owned())?;
                self.mean(sink, &mean_motion, about(normal), "torsion".to_owned())
            }
            Section::Mean => {
                let mean_motion = MeanRigidMotion::new(points);
                let name = |component: &CoupledComponent| self.beam.long_name(component.kind);
                self.beam
                    .coupled_components()
                    .try_for_each(|component| self.mean(sink, &mean_motion, component.row([0.0; 3]), name(&component)))
            }
        }
    }
}
