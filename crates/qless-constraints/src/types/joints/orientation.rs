//! Functions of the relative rotation `q = (q0, v)` of two bodies that joints set to zero. All but the last are
//! angles, in radians.
//!
//! - [`Aligned`]: `c = log(R_a^T R_b)`, the shortest rotation vector from a to b, `|c| <= pi`;
//! - [`Tilt`]: the rotation vector, perpendicular to the axis t, that rotates the axis of a to that of b, `|c| <= pi`;
//! - [`Twist`]: the rotation about t that remains after the tilt, minus a prescribed angle, modulo 2 pi, `|c| <= pi`;
//! - [`PerpendicularAxes`]: `c = (R_a s) . (R_b t)`, the cosine of an angle.
//!
//! Each function vanishes exactly if the joint condition holds. The first three are angle vectors
//! ([`crate::geometry::angle`]) of functions `(m, v)` of q, which are linear, or quadratic for the tilt.

use std::array::from_fn;

use super::relative::{MAX_EQUATIONS, QuaternionMatrix, RotationFunction};
use crate::equations::TimeFunction;
use crate::geometry::quaternion::{Quaternion, inner};
use crate::geometry::rotation::{RotationKind, by_euler};
use crate::geometry::{angle, rotation_derivatives};
use crate::scalar::vector::{Vector, dot, lift, perpendicular};
use crate::scalar::{Arithmetic, Scalar};

/// The value at a time. The error is a value that is not finite.
pub(super) fn value_at(motion: &TimeFunction, time: f64) -> Result<f64, f64> {
    let value = motion(time);
    if value.is_finite() { Ok(value) } else { Err(value) }
}

/// m counts as negative only below minus this share of |q|: at exactly half a turn, rounding must not change the sense
/// of rotation.
const HALF_TURN: f64 = 1e-8;

/// Whether -q, which is the same rotation, gives the smaller angle.
fn negated([m, v @ ..]: [f64; 4]) -> bool {
    m < -HALF_TURN * v.into_iter().fold(0.0, f64::hypot)
}

/// `(m, v)` with the sign of the smaller angle.
fn shorter<S: Scalar>(x: [S; 4]) -> [S; 4] {
    if negated(x.map(Scalar::real)) { x.map(|x| -x) } else { x }
}

/// `sum_k weight_k row_k`.
fn combined(weights: &[f64], rows: &[Quaternion<f64>]) -> Quaternion<f64> {
    from_fn(|j| weights.iter().zip(rows).map(|(w, row)| w * row[j]).sum())
}

/// Zero if the bodies are aligned: `m = q0`, v the vector part of q; the angle vector is half of c.
pub struct Aligned;

impl RotationFunction for Aligned {
    const EQUATION_NAMES: &'static [&'static str] = &["turn x", "turn y", "turn z"];

    fn value<S: Scalar>(&self, q: Quaternion<S>, c: &mut [S]) {
        c.copy_from_slice(&angle::value::<S, 3>(shorter(q)).map(|x| S::from(2.0) * x));
    }

    #[inline]
    fn slopes(&self, q: Quaternion<f64>, c: &mut [f64]) -> [Quaternion<f64>; MAX_EQUATIONS] {
        let (half, rows) = angle::slopes::<3>(shorter(q));
        c.copy_from_slice(&half.map(|x| 2.0 * x));
        let factor = if negated(q) { -2.0 } else { 2.0 };
        rows.map(|row| row.map(|x| factor * x))
    }

    fn curvature(&self, q: Quaternion<f64>, w: &[f64]) -> (Quaternion<f64>, QuaternionMatrix) {
        let sign = if negated(q) { -1.0 } else { 1.0 };
        let (slope, square) = angle::curvature(shorter(q), [w[0], w[1], w[2]].map(|w| 2.0 * w));
        (slope.map(|x| sign * x), square)
    }
}

/// Zero if the axes of both bodies are parallel and point the same way.
///
/// With the components `q_t, q_1, q_2` along the axis and two directions perpendicular to it:
/// `m = t . R t = q0^2 + q_t^2 - q_1^2 - q_2^2`, `v = t x R t = 2 (q0 q_1 - q_t q_2, q0 q_2 + q_t q_1)`.
pub struct Tilt {
    /// The axis and two perpendicular directions, a right-handed system of unit vectors.
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

    /// Gradients of m and v.
    fn rows(&self, q: Quaternion<f64>) -> [Quaternion<f64>; 3] {
        let (q0, [t, x, y]) = (q[0], self.frame.map(|e| dot(e, [q[1], q[2], q[3]])));
        let whole = |in_frame: [f64; 4]| self.in_space(in_frame.map(|x| 2.0 * x));
        [whole([q0, t, -x, -y]), whole([x, -y, q0, -t]), whole([y, x, t, q0])]
    }

    fn in_space(&self, q: Quaternion<f64>) -> Quaternion<f64> {
        let [t, x, y] = self.frame;
        let component = |k: usize| q[1] * t[k] + q[2] * x[k] + q[3] * y[k];
        [q[0], component(0), component(1), component(2)]
    }

    /// `sum_k slope_k d^2 (m, v)_k / dq^2`.
    fn bend(&self, slope: [f64; 4]) -> QuaternionMatrix {
        let [m, v, w, _] = slope.map(|x| 2.0 * x);
        let in_frame = [[m, 0.0, v, w], [0.0, m, w, -v], [v, w, -m, 0.0], [w, -v, 0.0, -m]];
        let half = in_frame.map(|row| self.in_space(row));
        let columns: QuaternionMatrix = from_fn(|k| self.in_space(from_fn(|j| half[j][k])));
        from_fn(|j| from_fn(|k| columns[k][j]))
    }
}

impl RotationFunction for Tilt {
    const EQUATION_NAMES: &'static [&'static str] = &["tilt 1", "tilt 2"];

    fn value<S: Scalar>(&self, q: Quaternion<S>, c: &mut [S]) {
        c.copy_from_slice(&angle::value::<S, 2>(self.parts(q)));
    }

    #[inline]
    fn slopes(&self, q: Quaternion<f64>, c: &mut [f64]) -> [Quaternion<f64>; MAX_EQUATIONS] {
        let (rows, (tilt, slopes)) = (self.rows(q), angle::slopes::<2>(self.parts(q)));
        c.copy_from_slice(&tilt);
        [combined(&slopes[0], &rows), combined(&slopes[1], &rows), [0.0; 4]]
    }

    fn curvature(&self, q: Quaternion<f64>, w: &[f64]) -> (Quaternion<f64>, QuaternionMatrix) {
        let rows = self.rows(q);
        let (slope, square) = angle::curvature(self.parts(q), [w[0], w[1]]);
        let half: [Quaternion<f64>; 3] = from_fn(|j| combined(&square[j], &rows));
        let mut whole = self.bend(slope);
        (0..4).for_each(|j| (0..4).for_each(|k| whole[j][k] += (0..3).map(|i| rows[i][j] * half[i][k]).sum::<f64>()));
        (combined(&slope, &rows), whole)
    }
}

/// The angle about an axis, minus a prescribed angle phi: `m = q0 cos(phi/2) + q_t sin(phi/2)`,
/// `v = q_t cos(phi/2) - q0 sin(phi/2)`.
pub struct Twist {
    /// Unit vector.
    axis: Vector<f64>,
    /// phi at the current time, in radians.
    angle: f64,
    /// phi as a function of time.
    motion: TimeFunction,
}

impl Twist {
    /// For a unit vector `axis`. The time is 0.
    pub fn new(axis: Vector<f64>, motion: TimeFunction) -> Self {
        Self { axis, angle: motion(0.0), motion }
    }

    /// Coefficients of m and v in q.
    fn rows(&self) -> [Quaternion<f64>; 2] {
        let ((sin, cos), [x, y, z]) = ((0.5 * self.angle).sin_cos(), self.axis);
        [[cos, sin * x, sin * y, sin * z], [-sin, cos * x, cos * y, cos * z]]
    }
}

impl RotationFunction for Twist {
    const EQUATION_NAMES: &'static [&'static str] = &[""];
    const DRIVEN: bool = true;

    fn at_time(&mut self, time: f64) -> Result<(), f64> {
        self.angle = value_at(&self.motion, time)?;
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
    fn slopes(&self, q: Quaternion<f64>, c: &mut [f64]) -> [Quaternion<f64>; MAX_EQUATIONS] {
        let rows = self.rows();
        let [m, v] = rows.map(|row| inner(row, q));
        let ([half], [slope]) = angle::slopes::<1>(shorter([m, v, 0.0, 0.0]));
        c[0] = 2.0 * half;
        let sign = if negated([m, v, 0.0, 0.0]) { -2.0 } else { 2.0 };
        [combined(&slope.map(|x| sign * x), &rows), [0.0; 4], [0.0; 4]]
    }

    fn curvature(&self, q: Quaternion<f64>, w: &[f64]) -> (Quaternion<f64>, QuaternionMatrix) {
        let rows = self.rows();
        let [m, v] = rows.map(|row| inner(row, q));
        let (slope, square) = angle::curvature(shorter([m, v, 0.0, 0.0]), [2.0 * w[0]]);
        let sign = if negated([m, v, 0.0, 0.0]) { -1.0 } else { 1.0 };
        let half: [Quaternion<f64>; 2] = from_fn(|j| combined(&square[j], &rows));
        let square = from_fn(|j| from_fn(|k| rows[0][j] * half[0][k] + rows[1][j] * half[1][k]));
        (combined(&slope.map(|x| sign * x), &rows), square)
    }
}

/// Zero if a direction of body a and one of body b are perpendicular.
pub struct PerpendicularAxes {
    pub of_a: Vector<f64>,
    pub of_b: Vector<f64>,
}

impl RotationFunction for PerpendicularAxes {
    const EQUATION_NAMES: &'static [&'static str] = &[""];

    fn value<S: Scalar>(&self, q: Quaternion<S>, c: &mut [S]) {
        c[0] = dot(lift(self.of_a), by_euler(q, self.of_b));
    }

    #[inline]
    fn slopes(&self, q: Quaternion<f64>, c: &mut [f64]) -> [Quaternion<f64>; MAX_EQUATIONS] {
        c[0] = dot(self.of_a, by_euler(q, self.of_b));
        let mut rows = [[0.0; 4]; MAX_EQUATIONS];
        rotation_derivatives::gradient(
            RotationKind::Euler,
            &[q[0] - 1.0, q[1], q[2], q[3]],
            self.of_b,
            self.of_a,
            &mut rows[0],
        );
        rows
    }

    fn curvature(&self, q: Quaternion<f64>, w: &[f64]) -> (Quaternion<f64>, QuaternionMatrix) {
        let (s, t) = (self.of_a.map(|x| w[0] * x), self.of_b);
        let u = [q[0] - 1.0, q[1], q[2], q[3]];
        let (mut slope, mut lower) = ([0.0; 4], [0.0; 10]);
        rotation_derivatives::gradient(RotationKind::Euler, &u, t, s, &mut slope);
        rotation_derivatives::hessian(RotationKind::Euler, &u, t, s, &mut lower);
        let entry = |j: usize, k: usize| lower[j.max(k) * (j.max(k) + 1) / 2 + j.min(k)];
        (slope, from_fn(|j| from_fn(|k| entry(j, k))))
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::super::relative::RotationFunction;
    use super::*;
    use crate::scalar::vector::{Vector, cross, norm, scale, sub, unit};

    fn turn(axis: Vector<f64>, angle: f64) -> Quaternion<f64> {
        let [x, y, z] = scale((0.5 * angle).sin(), unit(axis).expect("not zero"));
        [(0.5 * angle).cos(), x, y, z]
    }

    /// The values are the angles, for q and -q, also for quaternions that do not have length one.
    #[test]
    fn angles_are_those_of_the_rotation() {
        let axis = unit([1.0, -2.0, 0.5]).expect("not zero");
        for angle in [0.0, 1e-7, 0.4, 2.0, 3.0, 3.13] {
            for factor in [1.0, -1.0, 3.0] {
                let q = turn(axis, angle).map(|x| factor * x);
                let mut c = [0.0; 3];
                Aligned.value(q, &mut c);
                assert!(norm(sub(c, scale(angle, axis))) < 4e-15, "{angle}: {c:?}");
                Twist::new(axis, Arc::new(move |_| angle - 7.0)).value(q, &mut c[..1]);
                assert!((c[0] - 7.0 + std::f64::consts::TAU).abs() < 1e-14, "{angle}: {c:?}");
                let across = unit(cross(axis, [1.0, 0.0, 0.0])).expect("not parallel");
                Tilt::new(across).value(q, &mut c[..2]);
                assert!((c[0].hypot(c[1]) - angle).abs() < 4e-15, "{angle}: {c:?}");
                Tilt::new(axis).value(q, &mut c[..2]);
                assert!(c[0].hypot(c[1]) < 1e-15, "{angle}: {c:?}");
            }
        }
    }
}
