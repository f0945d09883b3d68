//! Angle vectors `c = atan2(|v|, m) v / |v|`: c is parallel to v, and its length is the angle of `(m, |v|)` in [0,
//! pi].
//!
//! `c = f v` with `f(m, y) = atan2(sqrt y, m) / sqrt y` and `y = v.v`. f is smooth if v is not zero or m is positive.
//! Scaling m and v together does not change c. If v is zero and m is negative, the angle is pi and every direction is
//! equally near. Within [`TURNED_OVER`] of that point c takes the first direction, `c = (pi + v_1 / m, 0, ..)`, and
//! its Jacobian has rank one.
//!
//! With `r = y + m^2`: `f_m = -1 / r`, `f_mm = 2 m / r^2`, `f_my = 1 / r^2`, `f_y = (m / r - f) / (2 y)`,
//! `f_yy = -(m / r^2 + 3 f_y) / (2 y)`. Near zero, series in `y / m^2` replace the last two.

use std::array::from_fn;
use std::f64::consts::PI;

use crate::scalar::Scalar;

/// Distance from pi, in radians, that counts as half a turn: the sine of such an angle has lost half of its digits.
const TURNED_OVER: f64 = 1e-8;
/// Largest `y / m^2` for which the series are used.
const SMALL: f64 = 0.1;
/// Terms of the series for angles up to 0.3, and up to 0.03.
const TERMS: [i32; 2] = [18, 7];

/// The angle vector of `x = (m, v)`. v has K components; later entries of x are ignored.
pub fn value<S: Scalar, const K: usize>(x: [S; 4]) -> [S; K] {
    let (m, v): (S, [S; K]) = (x[0], from_fn(|k| x[1 + k]));
    if turned_over(m.real(), v.map(Scalar::real)) {
        return from_fn(|k| if k == 0 { S::from(PI) + v[0] / m } else { S::from(0.0) });
    }
    let f = factor(m, v.iter().fold(S::from(0.0), |sum, &v| sum + v * v));
    v.map(|v| f * v)
}

/// f.
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

/// Whether v points nearly opposite to m.
fn turned_over<const K: usize>(m: f64, v: [f64; K]) -> bool {
    m < 0.0 && v.iter().fold(0.0, |sum: f64, v| sum.hypot(*v)) <= -TURNED_OVER * m
}

/// f and its derivatives.
struct AngleFactors {
    f: f64,
    m: f64,
    y: f64,
    mm: f64,
    my: f64,
    yy: f64,
}

impl AngleFactors {
    fn new(m: f64, y: f64) -> Self {
        let (r, z) = (y + m * m, y / (m * m));
        let (by_m, mm, my) = (-1.0 / r, 2.0 * m / (r * r), 1.0 / (r * r));
        if m > 0.0 && z < SMALL {
            let [f, by_y, yy] = series(z);
            return Self { f: f / m, m: by_m, y: by_y / (m * m * m), mm, my, yy: yy / (m * m * m * m * m) };
        }
        let f = y.sqrt().atan2(m) / y.sqrt();
        let by_y = (m / r - f) / (2.0 * y);
        Self { f, m: by_m, y: by_y, mm, my, yy: -(m / (r * r) + 3.0 * by_y) / (2.0 * y) }
    }
}

/// `sum (-z)^k / (2 k + 1)` and its first two derivatives.
fn series(z: f64) -> [f64; 3] {
    (0..terms(z)).rev().fold([0.0; 3], |[f, slope, curve], k| {
        let next = -z * f + 1.0 / f64::from(2 * k + 1);
        [next, -z * slope - f, -z * curve - 2.0 * slope]
    })
}

/// The angle vector and its Jacobian with respect to (m, v), one row per component.
pub fn slopes<const K: usize>(x: [f64; 4]) -> ([f64; K], [[f64; 4]; K]) {
    let (m, v): (f64, [f64; K]) = (x[0], from_fn(|k| x[1 + k]));
    let mut rows = [[0.0; 4]; K];
    if turned_over(m, v) {
        (rows[0][0], rows[0][1]) = (-v[0] / (m * m), 1.0 / m);
        return (from_fn(|k| if k == 0 { PI + v[0] / m } else { 0.0 }), rows);
    }
    let factors = AngleFactors::new(m, v.iter().map(|v| v * v).sum());
    for (i, row) in rows.iter_mut().enumerate() {
        row[0] = factors.m * v[i];
        (0..K).for_each(|k| row[1 + k] = 2.0 * factors.y * v[i] * v[k]);
        row[1 + i] += factors.f;
    }
    (v.map(|v| factors.f * v), rows)
}

/// Gradient and Hessian of `w . c` with respect to (m, v).
pub fn curvature<const K: usize>(x: [f64; 4], w: [f64; K]) -> ([f64; 4], [[f64; 4]; 4]) {
    let (m, v): (f64, [f64; K]) = (x[0], from_fn(|k| x[1 + k]));
    let rows = slopes::<K>(x).1;
    let gradient = from_fn(|j| (0..K).map(|k| w[k] * rows[k][j]).sum());
    let mut h = [[0.0; 4]; 4];
    if turned_over(m, v) {
        h[0][0] = 2.0 * w[0] * v[0] / (m * m * m);
        (h[0][1], h[1][0]) = (-w[0] / (m * m), -w[0] / (m * m));
        return (gradient, h);
    }
    let f = AngleFactors::new(m, v.iter().map(|v| v * v).sum());
    let p: f64 = (0..K).map(|k| w[k] * v[k]).sum();
    h[0][0] = f.mm * p;
    for j in 0..K {
        h[0][1 + j] = f.m * w[j] + 2.0 * f.my * p * v[j];
        h[1 + j][0] = h[0][1 + j];
        (0..K).for_each(|k| h[1 + j][1 + k] = 2.0 * f.y * (v[j] * w[k] + w[j] * v[k]) + 4.0 * f.yy * p * v[j] * v[k]);
        h[1 + j][1 + j] += 2.0 * f.y * p;
    }
    (gradient, h)
}

#[cfg(test)]
mod tests {
    use super::*;

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
            let (c, rows) = slopes::<2>([-1.0, v[0], v[1], 0.0]);
            assert!((c[0].hypot(c[1]) - PI).abs() < 1e-8, "{c:?}");
            assert!(rows.iter().flatten().all(|x| x.abs() <= 1.0));
            assert!((rows[0][1] * rows[1][2] - rows[0][2] * rows[1][1]).abs() < 1e-15);
        }
    }
}
