//! Bodies, and points attached to them: to the ground, to a node, or to a body with rotations.

use crate::EquationSink;
use crate::geometry::lanes::{Lanes, RotatedArmLanes};
use crate::geometry::rotation::RotationKind;
use crate::geometry::rotation_derivatives;
use crate::scalar::Scalar;
use crate::scalar::vector::{Vector, add, lift};

/// A body of a mechanism. All its DOFs are zero in the reference configuration.
///
/// The position is `x = at + u`. The rotation is a rotation vector `theta`, `R = exp [theta]x`, or four Euler
/// parameters `p = (1, 0, 0, 0) + u`, which need one [`crate::types::EulerNorm`] per body.
///
/// Rotation vectors are singular at a full turn, `|theta| = 2 pi`: all vectors of that length are the same rotation.
/// [`shorten_rotations`](crate::ConstraintSet::shorten_rotations) keeps them away from there;
/// `qless_solve::newton::solve` calls it, so that bodies may turn any number of times. Euler parameters
/// have no singularity.
///
/// ```
/// use qless_constraints::types::Body;
/// let crank = Body::with_euler([0, 1, 2], [0.5, 0.0, 0.0], [3, 4, 5, 6]);
/// let rod = Body::with_vector([7, 8, 9], [1.0, 0.0, 0.0], [10, 11, 12]);
/// assert_ne!(crank, rod);
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

    /// Declares the magnitudes of the coordinates and rotations to the sink.
    ///
    /// Rotation vectors are known to one unit in the last place of a radian, Euler parameters to one unit in the last
    /// place of 1, even if they are small.
    pub(crate) fn declare_magnitudes(&self, sink: &mut EquationSink) {
        sink.numbers(self.at);
        self.rotation_dofs().iter().for_each(|&dof| sink.coordinate(dof, 1.0));
    }

    /// Attaches `point`, given in the reference configuration, to the body.
    pub(crate) fn attach(&self, point: Vector<f64>) -> AttachedPoint {
        let arm = std::array::from_fn(|k| point[k] - self.at[k]);
        AttachedPoint { kind: self.kind, at: self.at, arm }
    }
}

/// A point that moves with a body: `x = at + u + R arm`.
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

    /// Returns the point x and writes `sign dx/du` to the columns of `g` (3 x n) from `first` on. Rotation vectors
    /// read their slopes from a lane of `turns`.
    #[expect(clippy::inline_always, reason = "27 numbers would go through memory, which costs a third")]
    #[inline(always)]
    pub fn write_slopes(
        &self,
        u: &[f64],
        sign: f64,
        [first, n]: [usize; 2],
        g: &mut [f64],
        (turns, lane): (&RotatedArmLanes, usize),
    ) -> Vector<f64> {
        let (turned, slopes) = match self.kind {
            RotationKind::Ground => return add(self.at, self.arm),
            RotationKind::Node => (self.arm, [[0.0; 4]; 3]),
            RotationKind::Vector => turns.lane(lane),
            RotationKind::Euler => rotation_derivatives::slopes(self.kind, &u[3..], self.arm),
        };
        for axis in 0..3 {
            let row = &mut g[axis * n + first..][..u.len()];
            let ([x, y, z], s) =
                (std::array::from_fn(|k| if k == axis { sign } else { 0.0 }), slopes[axis].map(|s| sign * s));
            // Copies of a length known at compile time are faster.
            match self.kind {
                RotationKind::Ground | RotationKind::Node => row.copy_from_slice(&[x, y, z]),
                RotationKind::Vector => row.copy_from_slice(&[x, y, z, s[0], s[1], s[2]]),
                RotationKind::Euler => row.copy_from_slice(&[x, y, z, s[0], s[1], s[2], s[3]]),
            }
        }
        add(add(self.at, turned), [u[0], u[1], u[2]])
    }

    /// Lower triangle of the Hessian of `m . x` in the rotations. For rotation vectors it is read from a lane of
    /// `all`.
    #[inline]
    pub fn curvature(&self, u: &[f64], m: Vector<f64>, out: &mut [f64], (all, lane): (&[Lanes; 6], usize)) {
        match self.kind {
            RotationKind::Ground | RotationKind::Node => (),
            RotationKind::Vector => (0..6).for_each(|k| out[k] = all[k].0[lane]),
            RotationKind::Euler => rotation_derivatives::hessian(self.kind, &u[3..], self.arm, m, out),
        }
    }
}
