//! Nodes with up to six DOFs, their components and local axes.

use super::rigid_motion::{about, along};
use crate::geometry::node::Point;
use crate::scalar::vector::{Vector, axis, cross, dot, norm, scale, sub, unit};
use crate::scalar::{HALF_DIGITS, clean};

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
    /// All six components, in the order of the DOFs of a [`Node6`].
    pub const ALL: [Self; 6] = [Self::X, Self::Y, Self::Z, Self::TurnX, Self::TurnY, Self::TurnZ];

    /// Name of an equation for this component.
    pub(crate) fn short_name(self) -> &'static str {
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

/// A node in space with translations and rotations. Any of them may be missing.
///
/// A DOF is `None` if the node does not have it or if it is not coupled. To couple only some components, set the other
/// DOFs to `None` ([`Node6::only`]).
/// Rotations are small, or components of one rotation vector, in radians. [`Node6::along`] selects components along
/// local axes; the DOFs are always along x, y and z.
///
/// ```
/// use qless_constraints::types::{Axes, Component, Node6, Point};
/// let whole = Node6::new([0, 1, 2], [3, 4, 5], [1.0, 0.0, 0.0]);
/// // Components 1, 2 and 6 in the numbering of decks.
/// let pin = whole.only([Component::X, Component::Y, Component::TurnZ]);
/// assert_eq!(pin.dofs, [Some(0), Some(1), None, None, None, Some(5)]);
/// let solid = Node6::from(Point::new([6, 7, 8], [0.0; 3]));
/// assert_eq!(solid.dofs, [Some(6), Some(7), Some(8), None, None, None]);
/// // Only the radial displacement of a node on a bore along z.
/// let axes = Axes::cylindrical([0.0; 3], [0.0, 0.0, 1.0], [3.0, 4.0, 1.0])?;
/// let radial = Node6::from(Point::new([9, 10, 11], [3.0, 4.0, 1.0])).along(axes, [Component::X]);
/// assert_eq!(radial.local.map(|local| local.axes.rows()[0]), Some([0.6, 0.8, 0.0]));
/// # Ok::<(), qless_constraints::types::AxesError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node6 {
    /// Translations along x, y, z, then rotations about x, y, z; 0-based DOFs.
    pub dofs: [Option<usize>; 6],
    /// Coordinates at u = 0, a length.
    pub at: Vector<f64>,
    /// Selected components along local axes; `None` if the DOFs select the components.
    pub local: Option<Local>,
}

/// Components along local axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Local {
    /// The local axes. The component `X` is the translation along the first axis, `TurnX` the rotation about it.
    pub axes: Axes,
    /// Whether each of [`Component::ALL`] is coupled.
    pub listed: [bool; 6],
}

/// A coupled component of a node: `sum a_j u_j`.
pub(crate) struct CoupledComponent {
    pub kind: Component,
    /// Direction of a translation, or axis of a rotation.
    pub axis: Vector<f64>,
    /// The component as terms in the DOFs of the node.
    pub terms: Vec<(usize, f64)>,
}

impl CoupledComponent {
    /// The component as a row that acts on the rigid motion `(u_r, theta)` of a reference. r is the arm from the reference to the node.
    pub fn row(&self, r: Vector<f64>) -> [f64; 6] {
        if self.kind.is_rotation() { about(self.axis) } else { along(self.axis, r) }
    }
}

impl Node6 {
    /// A node with all six DOFs.
    pub fn new(translations: [usize; 3], rotations: [usize; 3], at: Vector<f64>) -> Self {
        let ([a, b, c], [d, e, f]) = (translations, rotations);
        Self { dofs: [a, b, c, d, e, f].map(Some), at, local: None }
    }

    /// The node with only the listed components.
    #[must_use]
    pub fn only(self, components: impl IntoIterator<Item = Component>) -> Self {
        if let Some(Local { axes, listed }) = self.local {
            return self.along(axes, components.into_iter().filter(|&component| listed[component as usize]));
        }
        let mut dofs = [None; 6];
        components.into_iter().for_each(|component| dofs[component as usize] = self.dofs[component as usize]);
        Self { dofs, ..self }
    }

    /// The node with only the listed components along local axes. Earlier selections are overridden.
    ///
    /// The node must have all DOFs that these components depend on: three for an oblique axis.
    #[must_use]
    pub fn along(self, axes: Axes, components: impl IntoIterator<Item = Component>) -> Self {
        let mut listed = [false; 6];
        components.into_iter().for_each(|component| listed[component as usize] = true);
        Self { local: Some(Local { axes, listed }), ..self }
    }

    /// Whether a component is coupled.
    pub(crate) fn has(&self, component: Component) -> bool {
        let k = component as usize;
        self.local.map_or(self.dofs[k].is_some(), |local| local.listed[k])
    }

    /// The axis of a component.
    pub(crate) fn axis(&self, component: Component) -> Vector<f64> {
        let k = component as usize % 3;
        self.local.map_or(axis(k), |local| local.axes.rows()[k])
    }

    /// The terms of a component. `None` if it is not coupled, or if it depends on a missing DOF.
    pub(crate) fn coupled(&self, component: Component) -> Option<CoupledComponent> {
        let (axis, first) = (self.axis(component), component as usize / 3 * 3);
        let used = (0..3).filter(|&k| axis[k] != 0.0);
        let terms = used.map(|k| Some((self.dofs[first + k]?, axis[k]))).collect::<Option<_>>()?;
        self.has(component).then_some(CoupledComponent { kind: component, axis, terms })
    }

    /// The coupled components. Components with missing DOFs were refused before, by [`super::equations::check`].
    pub(crate) fn coupled_components(&self) -> impl Iterator<Item = CoupledComponent> + use<> {
        let node = *self;
        Component::ALL.into_iter().filter_map(move |component| node.coupled(component))
    }

    /// The first coupled component that depends on a missing DOF, if there is one.
    pub(crate) fn without_dofs(&self) -> Option<Component> {
        let lacks = |component: &Component| self.has(*component) && self.coupled(*component).is_none();
        if self.local.is_some() { Component::ALL.into_iter().find(lacks) } else { None }
    }

    /// Name of the equation of a component.
    pub(crate) fn name(&self, component: Component) -> String {
        if self.local.is_some() {
            format!("local {}", component.short_name())
        } else {
            component.short_name().to_owned()
        }
    }

    /// Name of the equation of a component, with "translation" or "rotation".
    pub(crate) fn long_name(&self, component: Component) -> String {
        if self.local.is_some() { format!("local {component}") } else { component.to_string() }
    }
}

impl From<Point> for Node6 {
    /// A node without rotations.
    fn from(point: Point) -> Self {
        let [x, y, z] = point.dofs.map(Some);
        Self { dofs: [x, y, z, None, None, None], at: point.at, local: None }
    }
}

/// Local axes, a right-handed system of unit vectors: Cartesian, or radial, circumferential and axial at a point.
///
/// ```
/// use qless_constraints::types::Axes;
/// let beam = Axes::new([1.0, 1.0, 0.0], [0.0, 1.0, 0.0])?;
/// let half = 0.5_f64.sqrt();
/// assert!((beam.rows()[1][0] + half).abs() < 1e-15 && beam.rows()[2] == [0.0, 0.0, 1.0]);
/// // At a bore along z: radial, circumferential and axial direction.
/// let bore = Axes::cylindrical([0.0; 3], [0.0, 0.0, 2.0], [0.0, 3.0, 7.0])?;
/// assert_eq!(bore.rows(), [[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]);
/// # Ok::<(), qless_constraints::types::AxesError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axes {
    rows: [Vector<f64>; 3],
}

/// Why local axes cannot be made.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AxesError {
    /// The vectors do not span a plane.
    #[error("{first:?} and {second:?} are parallel, zero or not finite; give two directions that differ")]
    NoPlane {
        /// The direction of an axis.
        first: Vector<f64>,
        /// The other vector.
        second: Vector<f64>,
    },
}

impl Axes {
    /// The first axis is along `x`; the second lies in the plane of `x` and `xy`, on the side of `xy`. The vectors may
    /// have any length.
    ///
    /// # Errors
    /// [`AxesError`] if a vector is zero or not finite, or the sine of their angle is below 1e-8.
    pub fn new(x: Vector<f64>, xy: Vector<f64>) -> Result<Self, AxesError> {
        let fault = AxesError::NoPlane { first: x, second: xy };
        let (first, other) = (unit(x).ok_or(fault)?, unit(xy).ok_or(fault)?);
        let second = across(first, other).ok_or(fault)?;
        let third = unit(cross(first, second)).ok_or(fault)?;
        let mut rows = [first, second, third];
        // Components that are only rounding would become coefficients.
        rows.iter_mut().for_each(|row| clean(row.iter_mut(), 1.0));
        Ok(Self { rows })
    }

    /// Cylindrical axes at the point `at`: radial, circumferential and axial, for the line through `origin` along
    /// `axis`.
    ///
    /// # Errors
    /// [`AxesError`] if `axis` is zero, a vector is not finite, or the point lies on the line, up to 1e-8 of its distance
    /// from `origin`.
    pub fn cylindrical(origin: Vector<f64>, axis: Vector<f64>, at: Vector<f64>) -> Result<Self, AxesError> {
        let Self { rows: [along, out, around] } = Self::new(axis, sub(at, origin))?;
        Ok(Self { rows: [out, around, along] })
    }

    /// The three axes.
    pub fn rows(&self) -> [Vector<f64>; 3] {
        self.rows
    }
}

/// The unit vector perpendicular to `e`, on the side of `other`.
fn across(e: Vector<f64>, other: Vector<f64>) -> Option<Vector<f64>> {
    let part = |x: Vector<f64>| sub(x, scale(dot(e, x), e));
    let rest = part(other);
    // Orthogonalise twice: if the first result is short, its rounding errors are large, relative to its length.
    if norm(rest) > HALF_DIGITS { unit(part(rest)) } else { None }
}
