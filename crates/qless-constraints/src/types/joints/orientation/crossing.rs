//! `c = (R_a s) . (R_b t)`.

use std::array::from_fn;

use crate::geometry::carrier::Kind;
use crate::geometry::quaternion::Quaternion;
use crate::geometry::rotation::by_euler;
use crate::geometry::turned;
use crate::scalar::Scalar;
use crate::scalar::vector::{Vector, dot, lift};
use crate::types::joints::relative::{MOST, OfTurn, Square};

/// A direction of each body, perpendicular to each other.
pub struct Crossing {
    pub of_a: Vector<f64>,
    pub of_b: Vector<f64>,
}

impl OfTurn for Crossing {
    const PARTS: &'static [&'static str] = &[""];

    fn value<S: Scalar>(&self, q: Quaternion<S>, c: &mut [S]) {
        c[0] = dot(lift(self.of_a), by_euler(q, self.of_b));
    }

    #[inline]
    fn slopes(&self, q: Quaternion<f64>, c: &mut [f64]) -> [Quaternion<f64>; MOST] {
        c[0] = dot(self.of_a, by_euler(q, self.of_b));
        let mut rows = [[0.0; 4]; MOST];
        turned::gradient(Kind::Euler, &[q[0] - 1.0, q[1], q[2], q[3]], self.of_b, self.of_a, &mut rows[0]);
        rows
    }

    fn curvature(&self, q: Quaternion<f64>, w: &[f64]) -> (Quaternion<f64>, Square) {
        let (s, t) = (self.of_a.map(|x| w[0] * x), self.of_b);
        let u = [q[0] - 1.0, q[1], q[2], q[3]];
        let (mut slope, mut lower) = ([0.0; 4], [0.0; 10]);
        turned::gradient(Kind::Euler, &u, t, s, &mut slope);
        turned::hessian(Kind::Euler, &u, t, s, &mut lower);
        let entry = |j: usize, k: usize| lower[j.max(k) * (j.max(k) + 1) / 2 + j.min(k)];
        (slope, from_fn(|j| from_fn(|k| entry(j, k))))
    }
}
