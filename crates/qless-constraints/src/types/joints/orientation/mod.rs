//! The functions of a relative rotation `q = (q0, v)` that joints hold at zero; all but the last are angles, in radians.
//!
//! - [`Aligned`]: `c = log(R_a^T R_b)`, the rotation vector from a to b the shorter way round: `|c| <= pi`;
//! - [`Tilt`]: the rotation vector, perpendicular to the axis t, that brings the axis of a to that of b: `|c| <= pi`;
//! - [`Twist`]: the rotation about t that is left after the tilt, less an angle, the shorter way round: `|c| <= pi`;
//! - [`Crossing`]: `c = (R_a s) . (R_b t)`, the cosine of an angle.
//!
//! Each vanishes where the joint holds and nowhere else. The first three are angle vectors ([`crate::geometry::angle`]) of `(m, v)`, functions of q:
//! linear ones, or for the tilt squares of it.

mod aligned;
mod crossing;
mod tilt;
mod twist;

use std::array::from_fn;

pub use aligned::Aligned;
pub use crossing::Crossing;
pub use tilt::Tilt;
pub use twist::Twist;

use crate::geometry::quaternion::Quaternion;
use crate::scalar::Scalar;

/// An m below zero by less than this part of |q| is not negative: at half a turn exactly, the sense is that of the quaternion, whatever is rounded.
const HALF_TURN: f64 = 1e-8;

/// Whether -q, the same rotation, is the shorter way to `(m, v)`.
fn negated([m, v @ ..]: [f64; 4]) -> bool {
    m < -HALF_TURN * v.into_iter().fold(0.0, f64::hypot)
}

/// `(m, v)` the shorter way.
fn shorter<S: Scalar>(x: [S; 4]) -> [S; 4] {
    if negated(x.map(Scalar::real)) { x.map(|x| -x) } else { x }
}

/// `sum_k weight_k row_k`.
fn combined(weights: &[f64], rows: &[Quaternion<f64>]) -> Quaternion<f64> {
    from_fn(|j| weights.iter().zip(rows).map(|(w, row)| w * row[j]).sum())
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::scalar::vector::{Vector, cross, norm, scale, sub, unit};
    use crate::types::joints::relative::OfTurn;

    fn turn(axis: Vector<f64>, angle: f64) -> Quaternion<f64> {
        let [x, y, z] = scale((0.5 * angle).sin(), unit(axis).expect("not zero"));
        [(0.5 * angle).cos(), x, y, z]
    }

    /// What the value says, in radians: at any angle, for q and -q, and for quaternions that are not of length one.
    #[test]
    fn angles_are_those_of_the_rotation() {
        let axis = unit([1.0, -2.0, 0.5]).expect("not zero");
        for angle in [0.0, 1e-7, 0.4, 2.0, 3.0, 3.14] {
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
