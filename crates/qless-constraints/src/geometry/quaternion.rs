//! Quaternions `q = (q0, q1, q2, q3)` of rotations, `R s = q s conj(q)`, and the quaternion of a body with its
//! derivatives.
//!
//! For a rotation vector, `q = (C, A theta)` with `C = cos(t / 2)`, `A = sin(t / 2) / t` and `y = t^2 = theta.theta`.
//! As functions of y, `C' = -A / 4`, and A is half of the first factor in Rodrigues' formula at `y / 4`. Euler
//! parameters are q itself.

use super::rodrigues::factors;
use super::rotation;
use super::rotation::RotationKind;
use crate::scalar::vector::{Vector, dot};
use crate::scalar::{Arithmetic, Scalar};

/// A scalar part and a vector part.
pub type Quaternion<S> = [S; 4];

/// The inverse rotation.
pub fn conjugate<S: Arithmetic>(q: Quaternion<S>) -> Quaternion<S> {
    [q[0], -q[1], -q[2], -q[3]]
}

/// `p q`: the rotation q, followed by p.
pub fn product<S: Arithmetic>(p: Quaternion<S>, q: Quaternion<S>) -> Quaternion<S> {
    [
        p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3],
        p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2],
        p[0] * q[2] + p[2] * q[0] + p[3] * q[1] - p[1] * q[3],
        p[0] * q[3] + p[3] * q[0] + p[1] * q[2] - p[2] * q[1],
    ]
}

/// Scalar product of all four components.
pub fn inner(p: Quaternion<f64>, q: Quaternion<f64>) -> f64 {
    p[0] * q[0] + p[1] * q[1] + p[2] * q[2] + p[3] * q[3]
}

/// The quaternion of a body with the rotations `u`.
pub fn body_quaternion<S: Scalar>(kind: RotationKind, u: &[S]) -> Quaternion<S> {
    let one = S::from(1.0);
    match kind {
        RotationKind::Ground | RotationKind::Node => [1.0, 0.0, 0.0, 0.0].map(S::from),
        RotationKind::Vector => {
            let theta = [u[0], u[1], u[2]];
            let quarter = S::from(0.25) * dot(theta, theta);
            let (sine, versine) = rotation::factors(quarter);
            let [x, y, z] = theta.map(|x| S::from(0.5) * sine * x);
            [one - quarter * versine, x, y, z]
        }
        RotationKind::Euler => [one + u[0], u[1], u[2], u[3]],
    }
}

/// The quaternion of a body, and the factors of its derivatives.
pub struct BodyQuaternion {
    kind: RotationKind,
    theta: Vector<f64>,
    pub q: Quaternion<f64>,
    /// `A = sin(t / 2) / t` of a rotation vector with the angle t, and its first two derivatives with respect to `t^2`.
    a: [f64; 3],
}

impl BodyQuaternion {
    /// Computes the quaternion and the factors for a body with the rotation DOFs `u`.
    #[inline]
    pub fn new(kind: RotationKind, u: &[f64]) -> Self {
        if kind != RotationKind::Vector {
            return Self { kind, theta: [0.0; 3], q: body_quaternion(kind, u), a: [0.0; 3] };
        }
        let theta = [u[0], u[1], u[2]];
        let quarter = 0.25 * dot(theta, theta);
        let [a, b] = factors(quarter);
        let a = [a[0] / 2.0, a[1] / 8.0, a[2] / 32.0];
        let [x, y, z] = theta.map(|x| a[0] * x);
        Self { kind, theta, q: [1.0 - quarter * b[0], x, y, z], a }
    }

    /// Gradient of `r . q` in the rotation DOFs, for a constant `r = (r_0, r_v)`. For a rotation vector theta it is
    /// `A r_v + (2 A' r_v.theta - A r_0 / 2) theta`, where `A = sin(t / 2) / t`, `t = |theta|`, and A' is the derivative of A in `t^2`.
    #[inline]
    pub fn gradient(&self, r: Quaternion<f64>, out: &mut [f64]) {
        match self.kind {
            RotationKind::Ground | RotationKind::Node => (),
            RotationKind::Vector => {
                let (t, [a, slope, _], v) = (self.theta, self.a, [r[1], r[2], r[3]]);
                let along = 2.0 * slope * dot(v, t) - 0.5 * a * r[0];
                (0..3).for_each(|k| out[k] = a * v[k] + along * t[k]);
            }
            RotationKind::Euler => out.copy_from_slice(&r),
        }
    }

    /// `dq / du_j` for each rotation DOF j. A rotation vector has three rotation DOFs; the fourth entry is then meaningless.
    #[inline]
    pub fn slopes(&self) -> [Quaternion<f64>; 4] {
        let mut rows = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];
        if self.kind == RotationKind::Vector {
            let by_component = rows.map(|unit| {
                let mut row = [0.0; 3];
                self.gradient(unit, &mut row);
                row
            });
            (0..3).for_each(|j| rows[j] = std::array::from_fn(|k| by_component[k][j]));
        }
        rows
    }

    /// Lower triangle of the Hessian of `r . q` in the rotation DOFs, row by row, for a constant `r = (r_0, r_v)`. For a rotation vector it
    /// is
    /// `(2 A' r_v.theta - A r_0 / 2) I + 2 A' (r_v theta^T + theta r_v^T) + (4 A'' r_v.theta - A' r_0) theta theta^T`, where
    /// `A = sin(t / 2) / t`, `t = |theta|`, and A' and A'' are derivatives of A in `t^2`.
    #[inline]
    pub fn hessian(&self, r: Quaternion<f64>, out: &mut [f64]) {
        match self.kind {
            RotationKind::Ground | RotationKind::Node => (),
            RotationKind::Vector => {
                let (t, [a, slope, curve], v) = (self.theta, self.a, [r[1], r[2], r[3]]);
                let diagonal = 2.0 * slope * dot(v, t) - 0.5 * a * r[0];
                let twice = 4.0 * curve * dot(v, t) - slope * r[0];
                let mut place = 0;
                for j in 0..3 {
                    for k in 0..=j {
                        let own = if j == k { diagonal } else { 0.0 };
                        out[place] = 2.0 * slope * (v[j] * t[k] + t[j] * v[k]) + twice * t[j] * t[k] + own;
                        place += 1;
                    }
                }
            }
            RotationKind::Euler => out.fill(0.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::rotation::{by_euler, by_vector};
    use super::*;
    use crate::scalar::vector::{norm, sub};

    /// Quaternions rotate like Rodrigues' formula at small and large angles, and products compose rotations.
    #[test]
    fn quaternions_turn_as_rotation_vectors() {
        let s = [1.0, 2.0, -0.5];
        for size in [1e-9, 0.3, 1.9, 3.1, 4.1, 6.2] {
            let (p, q) = ([0.6 * size, 0.0, -0.8 * size], [0.2, -1.1, 0.4]);
            let [of_p, of_q] = [p, q].map(|theta| BodyQuaternion::new(RotationKind::Vector, &theta).q);
            assert!(norm(sub(by_euler(of_p, s), by_vector(p, s))) < 4e-15, "{size}");
            let both = by_euler(product(of_p, of_q), s);
            assert!(norm(sub(both, by_euler(of_p, by_euler(of_q, s)))) < 4e-15, "{size}");
            let back = product(conjugate(of_p), of_p);
            assert!((back[0] - 1.0).abs() < 1e-15 && back[1..].iter().all(|x| x.abs() < 1e-15));
            let generic = body_quaternion(RotationKind::Vector, &p);
            assert!((0..4).all(|k| (generic[k] - of_p[k]).abs() < 4e-16));
        }
    }
}
