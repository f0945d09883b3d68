//! Equations of a joint at the point p of bodies a and b: `u_a + theta_a x (p - x_a) - u_b - theta_b x (p - x_b) = 0`, where x_a and x_b
//! are the centres of the bodies. A hinge adds `s_i . (theta_a - theta_b) = 0` for two directions `s_i` perpendicular to its axis.

use crate::families::AXES;
use crate::families::sums::Terms;

/// Kinds of joints.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum JointKind {
    /// Revolute joint, whose axis is normal to the plane of the net.
    Hinge,
    /// Spherical joint.
    Ball,
}

/// A joint of two bodies.
pub(super) struct Joint {
    pub(super) kind: JointKind,
    pub(super) bodies: [usize; 2],
    pub(super) at: [f64; 3],
}

impl Joint {
    /// Names and terms of the equations of the joint. A body has six DOFs: displacement and small rotation.
    pub(super) fn equations(&self, centres: &[[f64; 3]]) -> impl Iterator<Item = (&'static str, Terms)> {
        let point = (0..3).map(|axis| (["x", "y", "z"][axis], self.point(centres, axis)));
        // A hinge fixes the rotations about the first two axes, which span the plane of the net.
        let sides = if self.kind == JointKind::Hinge { &AXES[..2] } else { &[] };
        point.chain(["axis 1", "axis 2"].into_iter().zip(sides.iter().map(|side| self.rotation(*side))))
    }

    /// Equal displacement of the joint's point along an axis: `(theta x r)_x = theta_y r_z - theta_z r_y`, cyclically.
    fn point(&self, centres: &[[f64; 3]], axis: usize) -> Terms {
        let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
        let of = |(body, sign): (usize, f64)| {
            let r: [f64; 3] = std::array::from_fn(|k| self.at[k] - centres[body][k]);
            let first = 6 * body;
            [(first + axis, sign), (first + 3 + next, sign * r[last]), (first + 3 + last, -sign * r[next])]
        };
        self.signed().into_iter().flat_map(of).filter(|term| term.1 != 0.0).collect()
    }

    /// Equal rotation of both bodies about the direction `side`, which is perpendicular to the axis of the hinge.
    fn rotation(&self, side: [f64; 3]) -> Terms {
        let of = |(body, sign): (usize, f64)| (0..3).map(move |k| (6 * body + 3 + k, sign * side[k]));
        self.signed().into_iter().flat_map(of).collect()
    }

    fn signed(&self) -> [(usize, f64); 2] {
        [(self.bodies[0], 1.0), (self.bodies[1], -1.0)]
    }
}
