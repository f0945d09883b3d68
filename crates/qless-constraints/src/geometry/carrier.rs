//! What a point or a direction is attached to: the ground, a node, or a body with rotations.

use super::lanes::Lanes;
use super::rotation::{by_euler, by_vector};
use super::turned;
use super::turns::Turns;
use crate::Store;
use crate::scalar::Scalar;
use crate::scalar::vector::{Vector, add, lift};

/// A body of a mechanism. All its DOFs are zero in the reference configuration.
///
/// Position `x = at + u`. Rotation: a rotation vector `theta`, `R = exp [theta]x`, or Euler parameters `p = (1, 0, 0, 0) + u`, which need
/// [`super::super::types::EulerNorm`] once per body.
///
/// At a whole turn, `|theta| = 2 pi`, rotation vectors are singular: all around it are the same rotation. They are kept away from there by
/// [`shorten_rotations`](crate::ConstraintSet::shorten_rotations), which `qless_solve::newton::solve` calls by itself, so that bodies turn any
/// number of times. Euler parameters are singular nowhere.
///
/// ```
/// use qless_constraints::types::Body;
/// let crank = Body::with_euler([0, 1, 2], [0.5, 0.0, 0.0], [3, 4, 5, 6]);
/// let rod = Body::with_vector([7, 8, 9], [1.0, 0.0, 0.0], [10, 11, 12]);
/// assert_ne!(crank, rod);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    pub(crate) kind: Kind,
    pub(crate) position: [usize; 3],
    pub(crate) at: Vector<f64>,
    pub(crate) rotation: [usize; 4],
}

/// How a body moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Kind {
    Ground,
    Node,
    Vector,
    Euler,
}

impl Kind {
    pub fn positions(self) -> usize {
        if self == Self::Ground { 0 } else { 3 }
    }

    pub fn rotations(self) -> usize {
        match self {
            Self::Ground | Self::Node => 0,
            Self::Vector => 3,
            Self::Euler => 4,
        }
    }

    /// The vector `s` of the reference configuration, turned; `u` are the rotations.
    pub fn turn<S: Scalar>(self, u: &[S], s: Vector<f64>) -> Vector<S> {
        match self {
            Self::Ground | Self::Node => lift(s),
            Self::Vector => by_vector([u[0], u[1], u[2]], s),
            Self::Euler => by_euler([S::from(1.0) + u[0], u[1], u[2], u[3]], s),
        }
    }
}

impl Body {
    /// What does not move.
    pub fn ground() -> Self {
        Self { kind: Kind::Ground, position: [0; 3], at: [0.0; 3], rotation: [0; 4] }
    }

    /// A node without rotations, for joints that fix a point only.
    pub fn node(node: super::node::Point) -> Self {
        Self { kind: Kind::Node, position: node.dofs, at: node.at, ..Self::ground() }
    }

    /// A body with a rotation vector.
    pub fn with_vector(position: [usize; 3], at: Vector<f64>, rotation: [usize; 3]) -> Self {
        let [x, y, z] = rotation;
        Self { kind: Kind::Vector, position, at, rotation: [x, y, z, 0] }
    }

    /// A body with Euler parameters.
    pub fn with_euler(position: [usize; 3], at: Vector<f64>, rotation: [usize; 4]) -> Self {
        Self { kind: Kind::Euler, position, at, rotation }
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

    /// States the place of the body, and that a rotation is known to one unit in the last place of a radian, and Euler parameters to
    /// that of one, however small they are: what they turn is known no better.
    pub(crate) fn state(&self, store: &mut Store) {
        store.numbers(self.at);
        self.rotation_dofs().iter().for_each(|&dof| store.coordinate(dof, 1.0));
    }

    /// What moves with the body at `point`, a point of the reference configuration.
    pub(crate) fn carry(&self, point: Vector<f64>) -> Carrier {
        let arm = std::array::from_fn(|k| point[k] - self.at[k]);
        Carrier { kind: self.kind, at: self.at, arm }
    }
}

/// A point that moves with a body: `x = at + u + R arm`.
#[derive(Clone, Copy)]
pub(crate) struct Carrier {
    pub kind: Kind,
    at: Vector<f64>,
    pub arm: Vector<f64>,
}

impl Carrier {
    pub fn dofs(&self) -> usize {
        self.kind.positions() + self.kind.rotations()
    }

    /// Where the point is; `u` are the DOFs of the body.
    pub fn point<S: Scalar>(&self, u: &[S]) -> Vector<S> {
        let (position, rotation) = u.split_at(self.kind.positions());
        let turned = add(lift(self.at), self.kind.turn(rotation, self.arm));
        if position.is_empty() { turned } else { add(turned, [position[0], position[1], position[2]]) }
    }

    /// Where the body is to which the point belongs: `at + u`.
    pub fn centre<S: Scalar>(&self, u: &[S]) -> Vector<S> {
        if self.kind == Kind::Ground { lift(self.at) } else { add(lift(self.at), [u[0], u[1], u[2]]) }
    }

    /// The point x, and `sign dx` in the columns from `first` of `g`, 3 x n; rotation vectors as they are in a lane of `turns`.
    #[expect(clippy::inline_always, reason = "27 numbers would go through memory, which costs a third")]
    #[inline(always)]
    pub fn write_slopes(
        &self,
        u: &[f64],
        sign: f64,
        [first, n]: [usize; 2],
        g: &mut [f64],
        (turns, lane): (&Turns, usize),
    ) -> Vector<f64> {
        let (turned, slopes) = match self.kind {
            Kind::Ground => return add(self.at, self.arm),
            Kind::Node => (self.arm, [[0.0; 4]; 3]),
            Kind::Vector => turns.of(lane),
            Kind::Euler => turned::slopes(self.kind, &u[3..], self.arm),
        };
        for axis in 0..3 {
            let row = &mut g[axis * n + first..][..u.len()];
            let ([x, y, z], s) =
                (std::array::from_fn(|k| if k == axis { sign } else { 0.0 }), slopes[axis].map(|s| sign * s));
            // Written as a whole, in a length that the compiler knows.
            match self.kind {
                Kind::Ground | Kind::Node => row.copy_from_slice(&[x, y, z]),
                Kind::Vector => row.copy_from_slice(&[x, y, z, s[0], s[1], s[2]]),
                Kind::Euler => row.copy_from_slice(&[x, y, z, s[0], s[1], s[2], s[3]]),
            }
        }
        add(add(self.at, turned), [u[0], u[1], u[2]])
    }

    /// The lower triangle of the Hessian of `m . x`, in the rotations; for rotation vectors as it is in a lane of `all`.
    #[inline]
    pub fn curvature(&self, u: &[f64], m: Vector<f64>, out: &mut [f64], (all, lane): (&[Lanes; 6], usize)) {
        match self.kind {
            Kind::Ground | Kind::Node => (),
            Kind::Vector => (0..6).for_each(|k| out[k] = all[k].0[lane]),
            Kind::Euler => turned::hessian(self.kind, &u[3..], self.arm, m, out),
        }
    }
}
