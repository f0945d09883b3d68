//! `c = psi - phi(t)`, psi the rotation about an axis.

use std::array::from_fn;

use super::{combined, negated, shorter};
use crate::geometry::angle;
use crate::geometry::quaternion::{Quaternion, inner};
use crate::scalar::Scalar;
use crate::scalar::vector::Vector;
use crate::types::joints::motor::{Motion, at};
use crate::types::joints::relative::{MOST, OfTurn, Square};

/// The angle about an axis: `m = q0 cos + q_t sin`, `v = q_t cos - q0 sin` of half the angle that it is to have.
pub struct Twist {
    /// Unit vector.
    axis: Vector<f64>,
    /// In radians, now ...
    angle: f64,
    /// ... and at each time.
    motion: Motion,
}

impl Twist {
    /// `axis` is a unit vector. The angle is that of time 0.
    pub fn new(axis: Vector<f64>, motion: Motion) -> Self {
        Self { axis, angle: motion(0.0), motion }
    }

    /// m and v as products with q.
    fn rows(&self) -> [Quaternion<f64>; 2] {
        let ((sin, cos), [x, y, z]) = ((0.5 * self.angle).sin_cos(), self.axis);
        [[cos, sin * x, sin * y, sin * z], [-sin, cos * x, cos * y, cos * z]]
    }
}

impl OfTurn for Twist {
    const PARTS: &'static [&'static str] = &[""];
    const DRIVEN: bool = true;

    fn at_time(&mut self, time: f64) -> Result<(), f64> {
        self.angle = at(&self.motion, time)?;
        Ok(())
    }

    fn angle(&self) -> Option<f64> {
        Some(self.angle)
    }

    fn value<S: Scalar>(&self, q: Quaternion<S>, c: &mut [S]) {
        let [m, v] = self.rows().map(|row| (0..4).fold(S::from(0.0), |sum, k| sum + S::from(row[k]) * q[k]));
        let [half] = angle::value::<S, 1>(shorter([m, v, S::from(0.0), S::from(0.0)]));
        c[0] = S::from(2.0) * half;
    }

    #[inline]
    fn slopes(&self, q: Quaternion<f64>, c: &mut [f64]) -> [Quaternion<f64>; MOST] {
        let rows = self.rows();
        let [m, v] = rows.map(|row| inner(row, q));
        let ([half], [slope]) = angle::slopes::<1>(shorter([m, v, 0.0, 0.0]));
        c[0] = 2.0 * half;
        let sign = if negated([m, v, 0.0, 0.0]) { -2.0 } else { 2.0 };
        [combined(&slope.map(|x| sign * x), &rows), [0.0; 4], [0.0; 4]]
    }

    fn curvature(&self, q: Quaternion<f64>, w: &[f64]) -> (Quaternion<f64>, Square) {
        let rows = self.rows();
        let [m, v] = rows.map(|row| inner(row, q));
        let (slope, square) = angle::curvature(shorter([m, v, 0.0, 0.0]), [2.0 * w[0]]);
        let sign = if negated([m, v, 0.0, 0.0]) { -1.0 } else { 1.0 };
        let half: [Quaternion<f64>; 2] = from_fn(|j| combined(&square[j], &rows));
        let square = from_fn(|j| from_fn(|k| rows[0][j] * half[0][k] + rows[1][j] * half[1][k]));
        (combined(&slope.map(|x| sign * x), &rows), square)
    }
}
