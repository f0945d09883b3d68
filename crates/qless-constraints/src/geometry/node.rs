//! A node: its DOFs and where it is at u = 0.

use crate::scalar::Scalar;

/// Components in the order of the DOFs of a node.
pub(crate) const AXES: [&str; 3] = ["x", "y", "z"];

/// A node in D dimensions: `x = at + u`, one translation per component.
///
/// ```
/// use qless_constraints::types::{PlanarPoint, Point};
/// let corner = Point::new([0, 1, 2], [1.0, 0.0, 0.0]);
/// let planar = PlanarPoint::new([0, 1], [1.0, 0.0]);
/// assert_eq!((corner.dofs[2], planar.at[0]), (2, 1.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node<const D: usize> {
    /// The translations, 0-based DOFs.
    pub dofs: [usize; D],
    /// Coordinates at u = 0, a length.
    pub at: [f64; D],
}

/// A node in space.
pub type Point = Node<3>;
/// A node in the plane.
pub type PlanarPoint = Node<2>;

impl<const D: usize> Node<D> {
    /// A node with its DOFs and coordinates.
    pub fn new(dofs: [usize; D], at: [f64; D]) -> Self {
        Self { dofs, at }
    }

    /// A node of a field with one value per node, as a temperature: that value is its only DOF.
    pub fn of_field(dof: usize, at: [f64; D]) -> Self {
        Self { dofs: [dof; D], at }
    }
}

/// `at + u` for the D values that start at `first`.
pub(crate) fn moved<S: Scalar, const D: usize>(at: &[f64; D], u: &[S], first: usize) -> [S; D] {
    std::array::from_fn(|k| S::from(at[k]) + u[first + k])
}

/// Whether a distance is at most the tolerance; neither may be NaN.
pub(crate) fn within(distance: f64, tolerance: f64) -> bool {
    distance <= tolerance
}

/// `|a - b|` of points in D dimensions.
pub(crate) fn separation<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    a.iter().zip(b).fold(0.0, |sum: f64, (a, b)| sum.hypot(a - b))
}
