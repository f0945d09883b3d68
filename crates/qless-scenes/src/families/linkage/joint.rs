//! `u_a + theta_a x (p - x_a) - u_b - theta_b x (p - x_b) = 0`, and `s_i . (theta_a - theta_b) = 0` for a hinge.

use crate::families::sums::Terms;

/// What holds two bodies together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum JointKind {
    /// Revolute, about the axis of the plane.
    Hinge,
    /// Spherical.
    Ball,
}

/// A joint of two bodies, by their numbers.
pub(super) struct Joint {
    pub(super) kind: JointKind,
    pub(super) bodies: [usize; 2],
    pub(super) at: [f64; 3],
}

/// Two axes of the plane and the one across, whole numbers: of length 3, perpendicular, and none an axis of space.
pub(super) const AXES: [[f64; 3]; 3] = [[2.0, -1.0, 2.0], [2.0, 2.0, -1.0], [-1.0, 2.0, 2.0]];

impl Joint {
    /// Names and terms of the equations; a body has six DOFs, its displacement and a small rotation.
    pub(super) fn equations(&self, centres: &[[f64; 3]]) -> impl Iterator<Item = (&'static str, Terms)> {
        let point = (0..3).map(|axis| (["x", "y", "z"][axis], self.point(centres, axis)));
        let sides = if self.kind == JointKind::Hinge { &AXES[..2] } else { &[] };
        point.chain(["axis 1", "axis 2"].into_iter().zip(sides.iter().map(|side| self.turn(*side))))
    }

    /// The point does not part along an axis: `(theta x r)_x = theta_y r_z - theta_z r_y` and so on around.
    fn point(&self, centres: &[[f64; 3]], axis: usize) -> Terms {
        let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
        let of = |(body, sign): (usize, f64)| {
            let r: [f64; 3] = std::array::from_fn(|k| self.at[k] - centres[body][k]);
            let first = 6 * body;
            [(first + axis, sign), (first + 3 + next, sign * r[last]), (first + 3 + last, -sign * r[next])]
        };
        self.signed().into_iter().flat_map(of).filter(|term| term.1 != 0.0).collect()
    }

    /// The bodies do not turn on each other about a side.
    fn turn(&self, side: [f64; 3]) -> Terms {
        let of = |(body, sign): (usize, f64)| (0..3).map(move |k| (6 * body + 3 + k, sign * side[k]));
        self.signed().into_iter().flat_map(of).collect()
    }

    fn signed(&self) -> [(usize, f64); 2] {
        [(self.bodies[0], 1.0), (self.bodies[1], -1.0)]
    }
}
