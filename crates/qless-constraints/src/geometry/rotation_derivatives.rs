//! `phi = m . (R s)` with its gradient and Hessian in the rotations of a body, in closed form.
//!
//! With `n = s x m`, Euler parameters `p = (e0, e)` give `phi = (e0^2 - e.e) m.s + 2 (e.s)(e.m) + 2 e0 e.n`. A rotation vector, with
//! `y = theta.theta` and the factors a and b of Rodrigues' formula, gives `phi = m.s + a(y) alpha + b(y) beta`, `alpha = theta.n`,
//! `beta = (m.theta)(s.theta) - y m.s`.

use super::rodrigues::factors;
use super::rotation::RotationKind;
use crate::scalar::vector::{Vector, add, axis, cross, dot, scale, sub};

/// Indices of a lower triangle for up to four rotations, row by row.
const LOWER: [(usize, usize); 10] = [(0, 0), (1, 0), (1, 1), (2, 0), (2, 1), (2, 2), (3, 0), (3, 1), (3, 2), (3, 3)];

/// Gradient of `phi = m . (R s)` in the rotation DOFs `u`; the result has as many entries as `u`.
#[inline]
pub fn gradient(kind: RotationKind, u: &[f64], s: Vector<f64>, m: Vector<f64>, out: &mut [f64]) {
    match kind {
        RotationKind::Ground | RotationKind::Node => (),
        RotationKind::Vector => {
            let theta = [u[0], u[1], u[2]];
            out[..3].copy_from_slice(&Phi::new(theta, s, m, factors(dot(theta, theta))).gradient());
        }
        RotationKind::Euler => {
            let (e0, e, n, ms) = (1.0 + u[0], [u[1], u[2], u[3]], cross(s, m), dot(m, s));
            let (em, es) = (dot(e, m), dot(e, s));
            out[0] = 2.0 * (e0 * ms + dot(e, n));
            (0..3).for_each(|k| out[1 + k] = 2.0 * (s[k] * em + m[k] * es - e[k] * ms + e0 * n[k]));
        }
    }
}

/// `R s` and its Jacobian in the rotations.
#[inline]
pub fn slopes(kind: RotationKind, u: &[f64], s: Vector<f64>) -> (Vector<f64>, [[f64; 4]; 3]) {
    if kind == RotationKind::Vector {
        let theta = [u[0], u[1], u[2]];
        let (turned, rows) = slopes_by_vector(theta, s, factors(dot(theta, theta)));
        return (turned, rows.map(|[x, y, z]| [x, y, z, 0.0]));
    }
    let mut rows = [[0.0; 4]; 3];
    if kind == RotationKind::Euler {
        rows.iter_mut().enumerate().for_each(|(k, row)| gradient(kind, u, s, axis(k), row));
    }
    (kind.rotate(u, s), rows)
}

/// `R s = s + a v + b w` with `v = theta x s`, `w = theta x v`, and
/// `d(R s) = -a [s]x + b ((theta.s) I + theta s^T - 2 s theta^T) + 2 (a' v + b' w) theta^T`. a and b are the factors of Rodrigues'
/// formula, a' and b' their derivatives in `theta.theta`.
fn slopes_by_vector(theta: Vector<f64>, s: Vector<f64>, [a, b]: [[f64; 3]; 2]) -> (Vector<f64>, [Vector<f64>; 3]) {
    let once = cross(theta, s);
    let (twice, along) = (cross(theta, once), b[0] * dot(theta, s));
    let side = scale(2.0, sub(add(scale(a[1], once), scale(b[1], twice)), scale(b[0], s)));
    let spin = scale(a[0], s);
    let mut rows = [[0.0, spin[2], -spin[1]], [-spin[2], 0.0, spin[0]], [spin[1], -spin[0], 0.0]];
    for (i, row) in rows.iter_mut().enumerate() {
        let tilt = b[0] * theta[i];
        (0..3).for_each(|k| row[k] += tilt * s[k] + side[i] * theta[k]);
        row[i] += along;
    }
    (add(add(s, scale(a[0], once)), scale(b[0], twice)), rows)
}

/// Lower triangle of the Hessian of `phi = m . (R s)` in the rotation DOFs `u`, row by row.
#[inline]
pub fn hessian(kind: RotationKind, u: &[f64], s: Vector<f64>, m: Vector<f64>, out: &mut [f64]) {
    match kind {
        RotationKind::Ground | RotationKind::Node => (),
        RotationKind::Vector => {
            let theta = [u[0], u[1], u[2]];
            out[..6].copy_from_slice(&Phi::new(theta, s, m, factors(dot(theta, theta))).hessian());
        }
        RotationKind::Euler => {
            let (n, ms) = (cross(s, m), dot(m, s));
            let entry = |j: usize, k: usize| match (j, k) {
                (0, 0) => 2.0 * ms,
                (j, 0) => 2.0 * n[j - 1],
                (j, k) => {
                    let both = s[j - 1] * m[k - 1] + m[j - 1] * s[k - 1];
                    2.0 * (if j == k { both - ms } else { both })
                }
            };
            out.iter_mut().zip(LOWER).for_each(|(h, (j, k))| *h = entry(j, k));
        }
    }
}

/// The terms of `phi = m . (R s)` for a rotation vector theta: `phi = m.s + a alpha + b beta` with `n = s x m`, `alpha = theta.n` and
/// `beta = (m.theta)(s.theta) - theta.theta m.s`.
struct Phi {
    theta: Vector<f64>,
    s: Vector<f64>,
    m: Vector<f64>,
    n: Vector<f64>,
    ms: f64,
    alpha: f64,
    beta: f64,
    slope_beta: Vector<f64>,
    /// The factors a(y) and b(y) of Rodrigues' formula, each with its first two derivatives in `y = theta.theta`.
    a: [f64; 3],
    b: [f64; 3],
}

impl Phi {
    fn new(theta: Vector<f64>, s: Vector<f64>, m: Vector<f64>, [a, b]: [[f64; 3]; 2]) -> Self {
        let (n, ms, y) = (cross(s, m), dot(m, s), dot(theta, theta));
        let (mt, st) = (dot(m, theta), dot(s, theta));
        let slope_beta = sub(add(scale(st, m), scale(mt, s)), scale(ms, scale(2.0, theta)));
        Self { theta, s, m, n, ms, alpha: dot(theta, n), beta: mt * st - y * ms, slope_beta, a, b }
    }

    /// The gradient of phi in theta, in the symbols of [`Phi`]: `a n + 2 a' alpha theta + b grad beta + 2 b' beta theta`.
    fn gradient(&self) -> Vector<f64> {
        let along = 2.0 * (self.a[1] * self.alpha + self.b[1] * self.beta);
        add(add(scale(self.a[0], self.n), scale(self.b[0], self.slope_beta)), scale(along, self.theta))
    }

    /// The Hessian of phi in theta, in the symbols of [`Phi`]: `q theta^T + theta q^T + b (m s^T + s m^T) + d I` with
    /// `d = 2 (a' alpha + b' beta - b m.s)` and `q = 2 a' n + 2 b' grad beta + 2 (a'' alpha + b'' beta) theta`.
    fn hessian(&self) -> [f64; 6] {
        let (t, s, [a, b]) = (self.theta, self.s, [self.a, self.b]);
        let twice = 2.0 * (a[2] * self.alpha + b[2] * self.beta);
        let q = add(scale(2.0, add(scale(a[1], self.n), scale(b[1], self.slope_beta))), scale(twice, t));
        let m = scale(b[0], self.m);
        let diagonal = 2.0 * (a[1] * self.alpha + b[1] * self.beta - b[0] * self.ms);
        let entry = |j: usize, k: usize| q[j] * t[k] + t[j] * q[k] + (m[j] * s[k] + s[j] * m[k]);
        [entry(0, 0) + diagonal, entry(1, 0), entry(1, 1) + diagonal, entry(2, 0), entry(2, 1), entry(2, 2) + diagonal]
    }
}
