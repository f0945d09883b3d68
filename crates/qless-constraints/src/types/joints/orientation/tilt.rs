//! `c = beta e`, the rotation vector that aligns two axes.

use std::array::from_fn;

use super::combined;
use crate::geometry::angle;
use crate::geometry::quaternion::Quaternion;
use crate::scalar::vector::{Vector, dot, lift, perpendicular};
use crate::scalar::{Arithmetic, Scalar};
use crate::types::joints::relative::{MOST, OfTurn, Square};

/// The axes of both bodies are parallel, and point the same way.
///
/// With `q_t, q_1, q_2` along the axis and two directions perpendicular to it: `m = t . R t = q0^2 + q_t^2 - q_1^2 - q_2^2`,
/// `v = t x R t = 2 (q0 q_1 - q_t q_2, q0 q_2 + q_t q_1)`.
pub struct Tilt {
    /// The axis and two directions, a right-handed frame of unit vectors.
    frame: [Vector<f64>; 3],
}

impl Tilt {
    /// `axis` is a unit vector.
    pub fn new(axis: Vector<f64>) -> Self {
        let [first, second] = perpendicular(axis);
        Self { frame: [axis, first, second] }
    }

    /// m and v.
    fn parts<S: Arithmetic>(&self, q: Quaternion<S>) -> [S; 4] {
        let (q0, [t, x, y], two) = (q[0], self.frame.map(|e| dot(lift(e), [q[1], q[2], q[3]])), S::from(2.0));
        [q0 * q0 + t * t - x * x - y * y, two * (q0 * x - t * y), two * (q0 * y + t * x), S::from(0.0)]
    }

    /// Their gradients.
    fn rows(&self, q: Quaternion<f64>) -> [Quaternion<f64>; 3] {
        let (q0, [t, x, y]) = (q[0], self.frame.map(|e| dot(e, [q[1], q[2], q[3]])));
        let whole = |in_frame: [f64; 4]| self.in_space(in_frame.map(|x| 2.0 * x));
        [whole([q0, t, -x, -y]), whole([x, -y, q0, -t]), whole([y, x, t, q0])]
    }

    fn in_space(&self, q: Quaternion<f64>) -> Quaternion<f64> {
        let [t, x, y] = self.frame;
        let of = |k: usize| q[1] * t[k] + q[2] * x[k] + q[3] * y[k];
        [q[0], of(0), of(1), of(2)]
    }

    /// `sum_k slope_k d^2 (m, v)_k / dq^2`.
    fn bend(&self, slope: [f64; 4]) -> Square {
        let [m, v, w, _] = slope.map(|x| 2.0 * x);
        let in_frame = [[m, 0.0, v, w], [0.0, m, w, -v], [v, w, -m, 0.0], [w, -v, 0.0, -m]];
        let half = in_frame.map(|row| self.in_space(row));
        let columns: Square = from_fn(|k| self.in_space(from_fn(|j| half[j][k])));
        from_fn(|j| from_fn(|k| columns[k][j]))
    }
}

impl OfTurn for Tilt {
    const PARTS: &'static [&'static str] = &["tilt 1", "tilt 2"];

    fn value<S: Scalar>(&self, q: Quaternion<S>, c: &mut [S]) {
        c.copy_from_slice(&angle::value::<S, 2>(self.parts(q)));
    }

    #[inline]
    fn slopes(&self, q: Quaternion<f64>, c: &mut [f64]) -> [Quaternion<f64>; MOST] {
        let (rows, (tilt, slopes)) = (self.rows(q), angle::slopes::<2>(self.parts(q)));
        c.copy_from_slice(&tilt);
        [combined(&slopes[0], &rows), combined(&slopes[1], &rows), [0.0; 4]]
    }

    fn curvature(&self, q: Quaternion<f64>, w: &[f64]) -> (Quaternion<f64>, Square) {
        let rows = self.rows(q);
        let (slope, square) = angle::curvature(self.parts(q), [w[0], w[1]]);
        let half: [Quaternion<f64>; 3] = from_fn(|j| combined(&square[j], &rows));
        let mut whole = self.bend(slope);
        (0..4).for_each(|j| (0..4).for_each(|k| whole[j][k] += (0..3).map(|i| rows[i][j] * half[i][k]).sum::<f64>()));
        (combined(&slope, &rows), whole)
    }
}
