//! A node with up to six DOFs, and the names of its components.

use crate::geometry::node::Point;
use crate::scalar::vector::Vector;

/// A component of the motion of a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Component {
    /// Translation along x.
    X,
    /// Translation along y.
    Y,
    /// Translation along z.
    Z,
    /// Rotation about x.
    TurnX,
    /// Rotation about y.
    TurnY,
    /// Rotation about z.
    TurnZ,
}

impl Component {
    /// All six, in the order of the DOFs of a [`Node6`].
    pub const ALL: [Self; 6] = [Self::X, Self::Y, Self::Z, Self::TurnX, Self::TurnY, Self::TurnZ];

    /// What an equation for this component is called: translations by their axis alone.
    pub(crate) fn part(self) -> &'static str {
        ["x", "y", "z", "rotation x", "rotation y", "rotation z"][self as usize]
    }

    pub(crate) fn is_rotation(self) -> bool {
        self as usize >= 3
    }
}

impl std::fmt::Display for Component {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let kind = if self.is_rotation() { "rotation" } else { "translation" };
        write!(f, "{kind} {}", crate::geometry::node::AXES[*self as usize % 3])
    }
}

/// A node in space with translations and rotations, of which any may be missing.
///
/// A DOF that is `None` is one that the node does not have, or that takes no part in the constraint: so component lists are
/// written. Rotations are small, or the components of one rotation vector; radians.
///
/// ```
/// use qless_constraints::types::{Component, Node6, Point};
/// let whole = Node6::new([0, 1, 2], [3, 4, 5], [1.0, 0.0, 0.0]);
/// // What cards call components 1, 2 and 6.
/// let pin = whole.only([Component::X, Component::Y, Component::TurnZ]);
/// assert_eq!(pin.dofs, [Some(0), Some(1), None, None, None, Some(5)]);
/// let solid = Node6::from(Point::new([6, 7, 8], [0.0; 3]));
/// assert_eq!(solid.dofs, [Some(6), Some(7), Some(8), None, None, None]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node6 {
    /// Translations along x, y, z, then rotations about x, y, z; 0-based DOFs.
    pub dofs: [Option<usize>; 6],
    /// Coordinates at u = 0, a length.
    pub at: Vector<f64>,
}

impl Node6 {
    /// A node with all six DOFs.
    pub fn new(translations: [usize; 3], rotations: [usize; 3], at: Vector<f64>) -> Self {
        let ([a, b, c], [d, e, f]) = (translations, rotations);
        Self { dofs: [a, b, c, d, e, f].map(Some), at }
    }

    /// The node with those of its DOFs alone that are listed.
    #[must_use]
    pub fn only(self, components: impl IntoIterator<Item = Component>) -> Self {
        let mut dofs = [None; 6];
        components.into_iter().for_each(|component| dofs[component as usize] = self.dofs[component as usize]);
        Self { dofs, ..self }
    }

    /// The components that take part, with their DOFs.
    pub(crate) fn components(&self) -> impl Iterator<Item = (Component, usize)> + use<> {
        Component::ALL.into_iter().zip(self.dofs).filter_map(|(component, dof)| Some((component, dof?)))
    }

    /// A DOF that this node has as well as another.
    pub(crate) fn shared_dof(&self, other: &Self) -> Option<usize> {
        self.components().map(|(_, dof)| dof).find(|dof| other.dofs.contains(&Some(*dof)))
    }

    /// A DOF that the node has twice.
    pub(crate) fn repeated_dof(&self) -> Option<usize> {
        let count = |dof: usize| self.dofs.iter().filter(|&&other| other == Some(dof)).count();
        self.components().map(|(_, dof)| dof).find(|&dof| count(dof) > 1)
    }
}

impl From<Point> for Node6 {
    /// A node without rotations.
    fn from(point: Point) -> Self {
        let [x, y, z] = point.dofs.map(Some);
        Self { dofs: [x, y, z, None, None, None], at: point.at }
    }
}
