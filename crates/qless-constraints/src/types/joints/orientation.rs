//! Joints set these functions of the relative rotation q of two bodies, a quaternion, to zero. All but the last are
//! angles, in radians.
//!
//! - [`Aligned`]: `c = log(R_a^T R_b)`, the shortest rotation vector from a to b, `|c| <= pi`;
//! - [`Tilt`]: the rotation vector, perpendicular to the axis t, that rotates the axis of a to that of b, `|c| <= pi`;
//! - [`Twist`]: the rotation about t that remains after the tilt, minus a prescribed angle, modulo 2 pi, `|c| <= pi`;
//! - [`PerpendicularAxes`]: `c = (R_a s) . (R_b t)`, the cosine of an angle.
//!
//! Each function is zero if and only if the joint condition holds. The first three are computed from angle vectors of
//! `(m, v)` ([`crate::geometry::angle`]). m and v are linear functions of q; for the tilt they are quadratic.

use super::relative::RotationFunction;
use crate::equations::TimeFunction;
use crate::geometry::angle;
use crate::geometry::quaternion::Quaternion;
use crate::geometry::rotation::by_euler;
use crate::scalar::vector::{Vector, dot, lift, perpendicular};
use crate::scalar::{Arithmetic, HALF_DIGITS, Scalar};

/// The value of a prescribed motion at a time. The error is a value that is not finite.
pub(super) fn value_at(motion: &TimeFunction, time: f64) -> Result<f64, f64> {
    let value = motion(time);
    if value.is_finite() { Ok(value) } else { Err(value) }
}

/// Whether `-(m, v)`, which belongs to -q and so to the same rotation, gives the smaller angle. At exactly half a turn m is rounding, which
/// must not change the sense of rotation.
fn negated([m, v @ ..]: [f64; 4]) -> bool {
    m < -HALF_DIGITS * v.into_iter().fold(0.0, f64::hypot)
}

/// `(m, v)` or `-(m, v)`, whichever gives the smaller angle.
fn shorter<S: Scalar>(x: [S; 4]) -> [S; 4] {
    if negated(x.map(Scalar::real)) { x.map(|x| -x) } else { x }
}

/// `c = log(R_a^T R_b)`, zero if the bodies are aligned: twice the angle vector of `(m, v)`, where `m = q0` and v is the vector part of q.
pub struct Aligned;

impl RotationFunction for Aligned {
    const EQUATION_NAMES: &'static [&'static str] = &["turn x", "turn y", "turn z"];

    fn value<S: Scalar>(&self, q: Quaternion<S>, c: &mut [S]) {
        c.copy_from_slice(&angle::value::<S, 3>(shorter(q)).map(|x| S::from(2.0) * x));
    }
}

/// The rotation that turns the axis of one body to that of the other: the angle vector of `(m, v)`. Zero if the axes are
/// parallel and point the same way.
///
/// R is the rotation of q. The vector part of q has the components `q_t` along the axis t, and `q_1, q_2` along two directions
/// perpendicular to t: `m = t . R t = q0^2 + q_t^2 - q_1^2 - q_2^2`, `v = t x R t = 2 (q0 q_1 - q_t q_2, q0 q_2 + q_t q_1)`.
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

    /// `(m, v)` of the quaternion q, whose angle vector is the tilt of the axis. The last entry is unused.
    fn parts<S: Arithmetic>(&self, q: Quaternion<S>) -> [S; 4] {
        let (q0, [t, x, y], two) = (q[0], self.frame.map(|e| dot(lift(e), [q[1], q[2], q[3]])), S::from(2.0));
        [q0 * q0 + t * t - x * x - y * y, two * (q0 * x - t * y), two * (q0 * y + t * x), S::from(0.0)]
    }
}

impl RotationFunction for Tilt {
    const EQUATION_NAMES: &'static [&'static str] = &["tilt 1", "tilt 2"];

    fn value<S: Scalar>(&self, q: Quaternion<S>, c: &mut [S]) {
        c.copy_from_slice(&angle::value::<S, 2>(self.parts(q)));
    }
}

/// The angle about an axis, minus a prescribed angle phi: twice the angle of `(m, v)` with `m = q0 cos(phi/2) + q_t sin(phi/2)` and
/// `v = q_t cos(phi/2) - q0 sin(phi/2)`, where `q_t` is the component of the vector part of q along the axis.
pub struct Twist {
    /// Unit vector along the axis.
    axis: Vector<f64>,
    /// The prescribed angle phi at the current time, in radians.
    angle: f64,
    /// The prescribed angle phi as a function of time.
    motion: TimeFunction,
}

impl Twist {
    /// The twist about the unit vector `axis`, at time 0.
    pub fn new(axis: Vector<f64>, motion: TimeFunction) -> Self {
        Self { axis, angle: motion(0.0), motion }
    }

    /// Coefficients of m and v, which are linear functions of the quaternion q.
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
}

/// The cosine of the angle between a direction of body a and one of body b; zero if they are perpendicular.
pub struct PerpendicularAxes {
    pub of_a: Vector<f64>,
    pub of_b: Vector<f64>,
}

impl RotationFunction for PerpendicularAxes {
    const EQUATION_NAMES: &'static [&'static str] = &[""];

    fn value<S: Scalar>(&self, q: Quaternion<S>, c: &mut [S]) {
        c[0] = dot(lift(self.of_a), by_euler(q, self.of_b));
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
