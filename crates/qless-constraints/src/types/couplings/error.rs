//! Errors of couplings.

use super::node6::Component;
use crate::geometry::surface::SurfaceError;
use crate::scalar::vector::Vector;

/// What can be wrong with a rigid body, an average, or a coupling of a beam or a shell to a solid.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CouplingError {
    /// There are no nodes besides the reference.
    #[error("the coupling has no nodes besides its reference; give at least one")]
    NoNodes,
    /// A node has no coupled component.
    #[error(
        "every DOF of node {node}, from 1 (0 is the reference), is None; name those that are coupled, or remove the node"
    )]
    NoComponents {
        /// Number of the node, counted from 1; 0 for the reference.
        node: usize,
    },
    /// The coordinates of a node are not finite.
    #[error("the coordinates of node {node}, from 1 (0 is the reference), are not finite; correct them")]
    NoPlace {
        /// Number of the node, counted from 1; 0 for the reference.
        node: usize,
    },
    /// A DOF is used twice.
    #[error(
        "DOF {dof} of node {node}, from 1 (0 is the reference), occurs twice: in this node, in the reference or in another \
         node; each node needs DOFs of its own, and may be listed once"
    )]
    SharedDof {
        /// Number of the node, counted from 1; 0 for the reference.
        node: usize,
        /// The DOF.
        dof: usize,
    },
    /// A component along a local axis needs a DOF that the node does not have.
    #[error(
        "the local {component} of node {node}, from 1 (0 is the reference), depends on DOFs that the node does not have; add them, or \
         remove the component"
    )]
    LocalAxis {
        /// Number of the node, counted from 1; 0 for the reference.
        node: usize,
        /// The component in the local axes of the node.
        component: Component,
    },
    /// An equation needs a DOF that the reference does not have.
    #[error(
        "the equation \"{part}\" needs the {component} of the reference, with a factor of {factor}, but the reference has no \
         such DOF; add it, or remove the component that needs it"
    )]
    MissingDof {
        /// Name of the equation, as in labels.
        part: String,
        /// The missing component of the reference.
        component: Component,
        /// The factor of this component in the equation; for a rotation that moves a node, a length.
        factor: f64,
    },
    /// A weight is not a positive number.
    #[error("weight {node}, from 1, is {weight}; weights must be positive")]
    Weight {
        /// Number of the node, counted from 1.
        node: usize,
        /// Weight of the node.
        weight: f64,
    },
    /// The nodes do not determine the motion of the reference.
    #[error(
        "the nodes do not determine the {component} of the reference: the translation {translation:?} with \
         the rotation {rotation:?} moves none of them (nodes on a line do not determine the rotation about it); let only the \
         other components follow (Node6::only), or add components, or nodes off the line"
    )]
    Undetermined {
        /// The component that is not determined.
        component: Component,
        /// Translation of the reference in a motion that no node observes, in units of the size of the group of nodes.
        translation: Vector<f64>,
        /// Rotation of the reference in the motion that no node observes. Translation and rotation together have norm one.
        rotation: Vector<f64>,
    },
    /// Some rotations of a node, but not all three, are to follow a finite rotation.
    #[error(
        "only some rotations of node {node}, from 1, are coupled; components of finite rotations are not independent: \
         couple all three or none, or use a hinge"
    )]
    PartOfRotations {
        /// Number of the node, counted from 1.
        node: usize,
    },
    /// The body has no rotations.
    #[error("the body has no rotations; give it a rotation vector or Euler parameters")]
    NoRotations,
    /// The face of the solid is not a valid surface.
    #[error("face of the solid: {0}")]
    Surface(#[from] SurfaceError),
    /// The faces have no common normal.
    #[error(
        "the faces of the solid are lines or solids, or have opposite normals, so that they have no mean normal; correct them"
    )]
    NoNormal,
    /// A line of nodes through the thickness is invalid.
    #[error("line {line}, from 1, {fault}")]
    Line {
        /// Number of the line, counted from 1.
        line: usize,
        /// What is wrong with the line.
        fault: LineFault,
    },
    /// A node of the face belongs to no line.
    #[error(
        "node {node} (from 0) of the face belongs to no line, so that no shell node takes its share of the area; add it to one"
    )]
    NotInLine {
        /// Index of the node in the surface, from 0.
        node: usize,
    },
}

/// What can be wrong with a line of nodes through the thickness of a shell.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LineFault {
    /// The line does not have two nodes at different places.
    #[error("does not have two nodes at different places; give all nodes through the thickness")]
    TooShort,
    /// A node belongs to no face, or is listed twice.
    #[error("names node {node} (from 0), which belongs to no face, or is listed in another line or twice in this one")]
    Node {
        /// Index of the node in the surface, from 0.
        node: usize,
    },
    /// A node lies off the line.
    #[error(
        "is not straight: node {node} (from 0) is {distance} away from it, more than a hundredth of its length {length}"
    )]
    Bent {
        /// Index of the node in the surface, from 0.
        node: usize,
        /// Distance of the node from the line.
        distance: f64,
        /// The length of the line.
        length: f64,
    },
    /// The shell node is too far from the line.
    #[error("is {distance} away from its shell node, more than its length {length}: they are not a pair")]
    Apart {
        /// Distance of the shell node from the line.
        distance: f64,
        /// The length of the line.
        length: f64,
    },
    /// The shell node has invalid coordinates or DOFs.
    #[error(
        "has a shell node whose coordinates are not finite, whose local axes need DOFs that it does not have, or that shares a DOF with \
         itself, the solid or the shell node of another line; each node needs DOFs of its own"
    )]
    Shell,
    /// A DOF of a node is used twice.
    #[error(
        "names node {node} (from 0) with DOF {dof}, which occurs twice in this node or also in another node; each node needs DOFs of its own"
    )]
    SharedDof {
        /// Index of the node in the surface, from 0.
        node: usize,
        /// The DOF.
        dof: usize,
    },
    /// The integrals over the faces give the nodes of the line no positive area, or no positive second moment of area.
    #[error("has no share of the area of the faces; add lines at mid-edge nodes, or choose other faces")]
    NoArea,
}
