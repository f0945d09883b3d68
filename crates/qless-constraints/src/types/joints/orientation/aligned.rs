//! `c = log(R_a^T R_b)`.

use super::{negated, shorter};
use crate::geometry::angle;
use crate::geometry::quaternion::Quaternion;
use crate::scalar::Scalar;
use crate::types::joints::relative::{MOST, OfTurn, Square};

/// The bodies are aligned: `m = q0`, `v`, and the angle is half of that of the rotation.
pub struct Aligned;

impl OfTurn for Aligned {
    const PARTS: &'static [&'static str] = &["turn x", "turn y", "turn z"];

    fn value<S: Scalar>(&self, q: Quaternion<S>, c: &mut [S]) {
        c.copy_from_slice(&angle::value::<S, 3>(shorter(q)).map(|x| S::from(2.0) * x));
    }

    #[inline]
    fn slopes(&self, q: Quaternion<f64>, c: &mut [f64]) -> [Quaternion<f64>; MOST] {
        let (half, rows) = angle::slopes::<3>(shorter(q));
        c.copy_from_slice(&half.map(|x| 2.0 * x));
        let factor = if negated(q) { -2.0 } else { 2.0 };
        rows.map(|row| row.map(|x| factor * x))
    }

    fn curvature(&self, q: Quaternion<f64>, w: &[f64]) -> (Quaternion<f64>, Square) {
        let sign = if negated(q) { -1.0 } else { 1.0 };
        let (slope, square) = angle::curvature(shorter(q), [w[0], w[1], w[2]].map(|w| 2.0 * w));
        (slope.map(|x| sign * x), square)
    }
}
