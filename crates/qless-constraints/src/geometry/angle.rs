//! Angle vectors `c = atan2(|v|, m) v / |v|`: c is parallel to v, and its length is the angle of `(m, |v|)` in [0,
//! pi].
//!
//! `c = f v` with `f(m, y) = atan2(sqrt y, m) / sqrt y` and `y = v.v`. f is smooth if v is not zero or m is positive. Scaling m and v
//! together does not change c. If v is zero and m is negative, the angle is pi and c may have any direction. Within 1e-8 rad of that point,
//! c is therefore set to the first direction, `c = (pi + v_1 / m, 0, ..)`, and its Jacobian has rank one.

use std::array::from_fn;
use std::f64::consts::PI;

use crate::scalar::{HALF_DIGITS, Scalar};

/// Largest `y / m^2`, with `y = v.v`, for which [`factor`] uses a series.
const SMALL: f64 = 0.1;
/// Number of terms of the series of `atan2(sqrt y, m) / sqrt y`: for angles up to 0.3, and for angles up to 0.03.
const TERMS: [i32; 2] = [18, 7];

/// The angle vector `atan2(|v|, m) v / |v|` of `x = (m, v)`. v has K components; later entries of x are ignored.
pub fn value<S: Scalar, const K: usize>(x: [S; 4]) -> [S; K] {
    let (m, v): (S, [S; K]) = (x[0], from_fn(|k| x[1 + k]));
    if turned_over(m.real(), v.map(Scalar::real)) {
        return from_fn(|k| if k == 0 { S::from(PI) + v[0] / m } else { S::from(0.0) });
    }
    let f = factor(m, v.iter().fold(S::from(0.0), |sum, &v| sum + v * v));
    v.map(|v| f * v)
}

/// `f(m, y) = atan2(sqrt y, m) / sqrt y`.
fn factor<S: Scalar>(m: S, y: S) -> S {
    let z = y / (m * m);
    if m.real() > 0.0 && z.real() < SMALL {
        let odd = |k: i32| S::from(1.0 / f64::from(2 * k + 1));
        return (0..terms(z.real())).rev().fold(S::from(0.0), |sum, k| odd(k) - z * sum) / m;
    }
    let n = y.sqrt();
    n.atan2(m) / n
}

fn terms(z: f64) -> i32 {
    TERMS[usize::from(z < 1e-3)]
}

/// Whether the angle of `(m, |v|)` is within 1e-8 rad of pi.
fn turned_over<const K: usize>(m: f64, v: [f64; K]) -> bool {
    m < 0.0 && v.iter().fold(0.0, |sum: f64, v| sum.hypot(*v)) <= -HALF_DIGITS * m
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::Dual;

    /// Series and closed forms give the exact angles and directions on both sides of the switch.
    #[test]
    fn angles_are_angles() {
        for angle in [1e-9, 1e-3, 0.029, 0.033, 0.3, 0.32, 1.0, 1.6, 2.5, 3.0, 3.13] {
            for size in [1e-6, 1.0, 1e6_f64] {
                let (sin, cos) = f64::sin_cos(angle);
                let c: [f64; 2] = value([size * cos, size * 0.6 * sin, size * 0.8 * sin, f64::NAN]);
                assert!((c[0] - 0.6 * angle).abs() < 2e-15 && (c[1] - 0.8 * angle).abs() < 2e-15, "{angle}: {c:?}");
            }
        }
    }

    /// For opposite directions the angle is pi, the slopes are finite and the rank is one.
    #[test]
    fn turned_over_is_half_a_turn() {
        for v in [[0.0, 0.0], [6e-17, 0.0], [3e-9, -4e-9]] {
            let x = [-1.0, v[0], v[1], 0.0];
            let c: [Dual<4>; 2] = value(from_fn(|j| Dual::variable(x[j], j)));
            let rows = c.map(|c| c.slope);
            assert!((c[0].real.hypot(c[1].real) - PI).abs() < 1e-8, "{c:?}");
            assert!(rows.iter().flatten().all(|x| x.abs() <= 1.0));
            assert!((rows[0][1] * rows[1][2] - rows[0][2] * rows[1][1]).abs() < 1e-15);
        }
    }
}
