//! Nodes, their names in labels, and distances between them.

use std::borrow::Cow;

use crate::scalar::Scalar;

/// Relative rounding error of sums of a few products. Multiplied by the largest coordinate, it is the rounding error of a length.
pub(crate) const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// Distance within which a point counts as on an element, due to the rounding of the coordinates of both.
pub fn rounding<const D: usize>(nodes: &[[f64; D]], point: &[f64; D]) -> f64 {
    ROUNDING * nodes.iter().flatten().chain(point).fold(0.0, |most: f64, x| most.max(x.abs()))
}

/// The coordinates of nodes relative to a point p: `x_k - p`.
pub fn relative<const D: usize>(nodes: &[[f64; D]], point: &[f64; D]) -> Vec<[f64; D]> {
    nodes.iter().map(|x| std::array::from_fn(|d| x[d] - point[d])).collect()
}

/// Names of the coordinate axes in labels.
pub(crate) const AXES: [&str; 3] = ["x", "y", "z"];

/// A node in D dimensions that carries the DOFs of F fields.
///
/// | field | F | DOFs |
/// | --- | --- | --- |
/// | displacements (default) | D | one translation per coordinate, `x = at + u` |
/// | temperature, pressure, potential | 1 | its value ([`Node::of_field`]) |
/// | shell | 6 | three translations, then three rotations |
/// | displacements and a temperature | D + 1 | all of them |
///
/// ```
/// use qless_constraints::types::{Node, PlanarPoint, Point};
/// let corner = Point::new([0, 1, 2], [1.0, 0.0, 0.0]);
/// let planar = PlanarPoint::new([0, 1], [1.0, 0.0]);
/// let shell = Node::new([6, 7, 8, 9, 10, 11], [1.0, 0.0, 0.0]);
/// assert_eq!((corner.dofs[2], planar.at[0], shell.dofs.len()), (2, 1.0, 6));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node<const D: usize, const F: usize = D> {
    /// One 0-based DOF for each field.
    pub dofs: [usize; F],
    /// Coordinates at u = 0, a length.
    pub at: [f64; D],
}

/// A node in space.
pub type Point = Node<3>;
/// A node in the plane.
pub type PlanarPoint = Node<2>;

impl<const D: usize, const F: usize> Node<D, F> {
    /// A node with its DOFs and coordinates.
    pub fn new(dofs: [usize; F], at: [f64; D]) -> Self {
        Self { dofs, at }
    }
}

impl<const D: usize> Node<D, 1> {
    /// A node of a scalar field such as a temperature.
    pub fn of_field(dof: usize, at: [f64; D]) -> Self {
        Self { dofs: [dof], at }
    }
}

/// Name of the equation of field k: "" for a single field, the axis for translations, otherwise "field 4".
pub(crate) fn field<const D: usize, const F: usize>(k: usize) -> Cow<'static, str> {
    match F {
        1 => Cow::Borrowed(""),
        _ if F == D && D <= AXES.len() => Cow::Borrowed(AXES[k]),
        _ => Cow::Owned(format!("field {}", k + 1)),
    }
}

/// Name of the equation of field k at a node: "node 3, x", or "node 3" for a single field.
pub(crate) fn field_of_node<const D: usize, const F: usize>(node: usize, k: usize) -> String {
    let field = field::<D, F>(k);
    if field.is_empty() { format!("node {}", node + 1) } else { format!("node {}, {field}", node + 1) }
}

/// `at + u`, with u read from index `first` on.
pub(crate) fn moved<S: Scalar, const D: usize>(at: &[f64; D], u: &[S], first: usize) -> [S; D] {
    std::array::from_fn(|k| S::from(at[k]) + u[first + k])
}

/// Whether a distance is at most the tolerance. False if either is NaN.
pub(crate) fn within(distance: f64, tolerance: f64) -> bool {
    distance <= tolerance
}

/// `|a - b|` of points in D dimensions.
pub(crate) fn separation<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    a.iter().zip(b).fold(0.0, |sum: f64, (a, b)| sum.hypot(a - b))
}
