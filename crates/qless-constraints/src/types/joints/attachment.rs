//! Bodies of mechanisms, and points that are attached to them. A body is the ground, a node without rotations, or a body with rotations.

use crate::geometry::rotation::RotationKind;
use crate::geometry::rotation_derivatives;
use crate::scalar::Scalar;
use crate::scalar::vector::{Vector, add, lift};
use crate::{EquationSink, Nonlinear};

/// A body of a mechanism. All its DOFs are zero in the reference configuration.
///
/// The position is `x = at + u`. The rotation is a rotation vector `theta`, `R = exp [theta]x`, or four Euler
/// parameters `p = (1, 0, 0, 0) + u`, whose length the set keeps: it adds `(|p|^2 - 1) / 2 = 0` once for each body.
///
/// Rotation vectors are singular at a full turn, `|theta| = 2 pi`: all vectors of that length are the same rotation.
/// [`shorten_rotations`](crate::ConstraintSet::shorten_rotations) keeps them away from there;
/// `qless_solve::newton::solve` calls it, so that bodies may turn any number of times. Euler parameters
/// have no singularity.
///
/// ```
/// use qless_constraints::types::Body;
/// use qless_constraints::{ConstraintSet, types::Spherical};
/// let crank = Body::with_euler([0, 1, 2], [0.5, 0.0, 0.0], [3, 4, 5, 6]);
/// let rod = Body::with_vector([7, 8, 9], [1.0, 0.0, 0.0], [10, 11, 12]);
/// let mut builder = ConstraintSet::builder(13);
/// builder.add("pin", Spherical { a: crank, b: rod, at: [0.9, 0.0, 0.0] })?;
/// // Three equations of the joint, and the length of the Euler parameters.
/// assert_eq!(builder.build()?.equations(), 4);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    pub(crate) kind: RotationKind,
    pub(crate) position: [usize; 3],
    pub(crate) at: Vector<f64>,
    pub(crate) rotation: [usize; 4],
}

impl Body {
    /// The ground, which does not move.
    pub fn ground() -> Self {
        Self { kind: RotationKind::Ground, position: [0; 3], at: [0.0; 3], rotation: [0; 4] }
    }

    /// A node without rotations, for joints that fix only a point.
    pub fn node(node: crate::geometry::node::Point) -> Self {
        Self { kind: RotationKind::Node, position: node.dofs, at: node.at, ..Self::ground() }
    }

    /// A body with a rotation vector.
    pub fn with_vector(position: [usize; 3], at: Vector<f64>, rotation: [usize; 3]) -> Self {
        let [x, y, z] = rotation;
        Self { kind: RotationKind::Vector, position, at, rotation: [x, y, z, 0] }
    }

    /// A body with Euler parameters.
    pub fn with_euler(position: [usize; 3], at: Vector<f64>, rotation: [usize; 4]) -> Self {
        Self { kind: RotationKind::Euler, position, at, rotation }
    }

    /// The point of the body that is at these coordinates in the reference configuration.
    pub fn point(self, at: Vector<f64>) -> BodyPoint {
        BodyPoint { body: self, at }
    }

    pub(crate) fn turns(&self) -> bool {
        self.kind.rotations() > 0
    }

    pub(crate) fn rotation_dofs(&self) -> &[usize] {
        &self.rotation[..self.kind.rotations()]
    }

    pub(crate) fn dofs(&self) -> Vec<usize> {
        let position = &self.position[..self.kind.positions()];
        [position, self.rotation_dofs()].concat()
    }

    /// Tells the sink the place and the rotation DOFs of the body. The set refuses constraints that disagree on them.
    pub(crate) fn state(&self, sink: &mut EquationSink) {
        sink.numbers(self.at);
        if self.kind.positions() > 0 {
            sink.place(&self.position, &self.at, false);
        }
        if self.turns() {
            sink.rotation(self.rotation_dofs());
        }
    }

    /// Attaches `point`, given in the reference configuration, to the body.
    pub(crate) fn attach(&self, point: Vector<f64>) -> AttachedPoint {
        let arm = std::array::from_fn(|k| point[k] - self.at[k]);
        AttachedPoint { kind: self.kind, at: self.at, arm }
    }
}

/// A point of a body, of a node or of the ground: `x = X + u + R (at - X)` for a body with the place X ([`Body::point`]).
///
/// ```
/// use qless_constraints::{ConstraintSet, types::{Body, Distance}};
/// // A tie rod from a chassis point to the arm of a wheel carrier: one equation, and no body of its own.
/// let carrier = Body::with_vector([0, 1, 2], [0.0, 0.7, 0.3], [3, 4, 5]);
/// let rod = Distance::new(Body::ground().point([0.1, 0.3, 0.3]), carrier.point([0.1, 0.6, 0.3]));
/// let mut builder = ConstraintSet::builder(6);
/// builder.add("tie rod", rod)?;
/// assert_eq!(builder.build()?.equations(), 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyPoint {
    pub(crate) body: Body,
    /// Coordinates of the point in the reference configuration.
    pub(crate) at: Vector<f64>,
}

impl From<crate::geometry::node::Point> for BodyPoint {
    fn from(node: crate::geometry::node::Point) -> Self {
        Body::node(node).point(node.at)
    }
}

/// Equations `c = 0` that depend only on the current places of some points in space.
pub(crate) trait PointFunction: Send + Sync + 'static {
    /// As [`Nonlinear::EQUATION_NAMES`].
    const EQUATION_NAMES: &'static [&'static str];

    /// Writes `c`, given the places of the points.
    fn value<S: Scalar>(&self, points: &[Vector<S>], c: &mut [S]);
}

/// Adds the equations `function` on these points.
pub(crate) fn on_points<F: PointFunction, const N: usize>(
    sink: &mut EquationSink,
    points: [BodyPoint; N],
    function: F,
) {
    for BodyPoint { body, at } in &points {
        sink.numbers(*at);
        body.state(sink);
    }
    let dofs: Vec<usize> = points.iter().flat_map(|point| point.body.dofs()).collect();
    sink.nonlinear("", &dofs, OnPoints { points: points.map(|point| point.body.attach(point.at)), function });
}

/// Equations on N attached points; the DOFs are those of their bodies, one after the other.
struct OnPoints<F, const N: usize> {
    points: [AttachedPoint; N],
    function: F,
}

impl<F: PointFunction, const N: usize> Nonlinear for OnPoints<F, N> {
    const EQUATION_NAMES: &'static [&'static str] = F::EQUATION_NAMES;

    fn value<S: Scalar>(&self, u: &[S], c: &mut [S]) {
        let mut rest = u;
        let places = self.points.map(|point| {
            let own;
            (own, rest) = rest.split_at(point.dofs());
            point.point(own)
        });
        self.function.value(&places, c);
    }
}

/// A point that moves with a body: `x = at + u + R arm`. `at + u` is the place of the body. In the reference configuration, `arm` leads
/// from there to the point.
#[derive(Clone, Copy)]
pub(crate) struct AttachedPoint {
    pub kind: RotationKind,
    at: Vector<f64>,
    pub arm: Vector<f64>,
}

impl AttachedPoint {
    pub fn dofs(&self) -> usize {
        self.kind.positions() + self.kind.rotations()
    }

    /// Current place of the point; `u` are the DOFs of the body.
    pub fn point<S: Scalar>(&self, u: &[S]) -> Vector<S> {
        let (position, rotation) = u.split_at(self.kind.positions());
        let turned = add(lift(self.at), self.kind.rotate(rotation, self.arm));
        if position.is_empty() { turned } else { add(turned, [position[0], position[1], position[2]]) }
    }

    /// Current place of the body itself: `at + u`.
    pub fn centre<S: Scalar>(&self, u: &[S]) -> Vector<S> {
        if self.kind == RotationKind::Ground { lift(self.at) } else { add(lift(self.at), [u[0], u[1], u[2]]) }
    }

    /// Returns the point x and writes `sign dx/du` to the columns of `g` (3 x n) from `first` on.
    pub fn write_slopes(&self, u: &[f64], sign: f64, [first, n]: [usize; 2], g: &mut [f64]) -> Vector<f64> {
        let positions = self.kind.positions();
        let (turned, slopes) = rotation_derivatives::slopes(self.kind, &u[positions..], self.arm);
        for axis in 0..3 {
            let row = &mut g[axis * n + first..][..u.len()];
            (0..positions).for_each(|k| row[k] = if k == axis { sign } else { 0.0 });
            row[positions..].iter_mut().zip(slopes[axis]).for_each(|(g, slope)| *g = sign * slope);
        }
        let place = add(self.at, turned);
        if positions == 0 { place } else { add(place, [u[0], u[1], u[2]]) }
    }
}
