//! `phi = m . (R s)` with its gradient and Hessian in the rotations, in closed form.
//!
//! With `n = s x m`, for Euler parameters `p = (e0, e)`:
//! `phi = (e0^2 - e.e) m.s + 2 (e.s)(e.m) + 2 e0 e.n`; for a rotation vector, with `y = theta.theta`:
//! `phi = m.s + a(y) alpha + b(y) beta`, `alpha = theta.n`, `beta = (m.theta)(s.theta) - y m.s`.

use super::carrier::Kind;
use super::factors::factors;
use crate::scalar::vector::{Vector, cross, dot};

/// Lower triangles of up to four rotations, row by row.
const LOWER: [(usize, usize); 10] = [(0, 0), (1, 0), (1, 1), (2, 0), (2, 1), (2, 2), (3, 0), (3, 1), (3, 2), (3, 3)];

/// The gradient of phi; `u` are the rotations, of which there are as many as entries of the result.
#[inline]
pub fn gradient(kind: Kind, u: &[f64], s: Vector<f64>, m: Vector<f64>, out: &mut [f64]) {
    match kind {
        Kind::Ground | Kind::Node => (),
        Kind::Vector => {
            let theta = [u[0], u[1], u[2]];
            out[..3].copy_from_slice(&Phi::new(theta, s, m, factors(dot(theta, theta))).gradient());
        }
        Kind::Euler => {
            let (e0, e, n, ms) = (1.0 + u[0], [u[1], u[2], u[3]], cross(s, m), dot(m, s));
            let (em, es) = (dot(e, m), dot(e, s));
            out[0] = 2.0 * (e0 * ms + dot(e, n));
            (0..3).for_each(|k| out[1 + k] = 2.0 * (s[k] * em + m[k] * es - e[k] * ms + e0 * n[k]));
        }
    }
}

/// `R s`, and `d(R s)`, 3 x rotations.
#[inline]
pub fn slopes(kind: Kind, u: &[f64], s: Vector<f64>) -> (Vector<f64>, [[f64; 4]; 3]) {
    if kind == Kind::Vector {
        return slopes_by_vector([u[0], u[1], u[2]], s);
    }
    let mut rows = [[0.0; 4]; 3];
    if kind == Kind::Euler {
        rows.iter_mut().enumerate().for_each(|(axis, row)| gradient(kind, u, s, unit(axis), row));
    }
    (kind.turn(u, s), rows)
}

/// `R s = s + a v + b w` with `v = theta x s`, `w = theta x v`, and
/// `d(R s) = -a [s]x + b ((theta.s) I + theta s^T - 2 s theta^T) + 2 (a' v + b' w) theta^T`.
#[inline]
fn slopes_by_vector(theta: Vector<f64>, s: Vector<f64>) -> (Vector<f64>, [[f64; 4]; 3]) {
    let [a, b] = factors(dot(theta, theta));
    let once = cross(theta, s);
    let (twice, along) = (cross(theta, once), b[0] * dot(theta, s));
    let side: Vector<f64> = std::array::from_fn(|i| 2.0 * (a[1] * once[i] + b[1] * twice[i] - b[0] * s[i]));
    let spin = s.map(|x| a[0] * x);
    let skew = [[0.0, spin[2], -spin[1]], [-spin[2], 0.0, spin[0]], [spin[1], -spin[0], 0.0]];
    let mut rows = [[0.0; 4]; 3];
    for i in 0..3 {
        let tilt = b[0] * theta[i];
        (0..3).for_each(|k| rows[i][k] = skew[i][k] + tilt * s[k] + side[i] * theta[k]);
        rows[i][i] += along;
    }
    (std::array::from_fn(|i| s[i] + a[0] * once[i] + b[0] * twice[i]), rows)
}

fn unit(axis: usize) -> Vector<f64> {
    std::array::from_fn(|k| if k == axis { 1.0 } else { 0.0 })
}

/// The lower triangle of the Hessian of phi, row by row.
#[inline]
pub fn hessian(kind: Kind, u: &[f64], s: Vector<f64>, m: Vector<f64>, out: &mut [f64]) {
    match kind {
        Kind::Ground | Kind::Node => (),
        Kind::Vector => {
            let theta = [u[0], u[1], u[2]];
            Phi::new(theta, s, m, factors(dot(theta, theta))).hessian(out);
        }
        Kind::Euler => {
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

/// The parts of phi for a rotation vector.
struct Phi {
    theta: Vector<f64>,
    s: Vector<f64>,
    m: Vector<f64>,
    n: Vector<f64>,
    ms: f64,
    alpha: f64,
    beta: f64,
    slope_beta: Vector<f64>,
    /// a, a', a'' and b, b', b''.
    a: [f64; 3],
    b: [f64; 3],
}

impl Phi {
    #[inline]
    fn new(theta: Vector<f64>, s: Vector<f64>, m: Vector<f64>, [a, b]: [[f64; 3]; 2]) -> Self {
        let (n, ms, y) = (cross(s, m), dot(m, s), dot(theta, theta));
        let (mt, st) = (dot(m, theta), dot(s, theta));
        let slope_beta = std::array::from_fn(|k| m[k] * st + s[k] * mt - 2.0 * theta[k] * ms);
        Self { theta, s, m, n, ms, alpha: dot(theta, n), beta: mt * st - y * ms, slope_beta, a, b }
    }

    /// `a n + 2 a' alpha theta + b grad beta + 2 b' beta theta`.
    #[inline]
    fn gradient(&self) -> Vector<f64> {
        let along = 2.0 * (self.a[1] * self.alpha + self.b[1] * self.beta);
        std::array::from_fn(|k| self.a[0] * self.n[k] + self.b[0] * self.slope_beta[k] + along * self.theta[k])
    }

    /// The derivative of the gradient: `q theta^T + theta q^T + b (m s^T + s m^T) + d I`.
    #[inline]
    fn hessian(&self, out: &mut [f64]) {
        let (t, s, [a, b]) = (self.theta, self.s, [self.a, self.b]);
        let twice = 2.0 * (a[2] * self.alpha + b[2] * self.beta);
        let q: Vector<f64> =
            std::array::from_fn(|k| 2.0 * (a[1] * self.n[k] + b[1] * self.slope_beta[k]) + twice * t[k]);
        let m = self.m.map(|m| b[0] * m);
        let diagonal = 2.0 * (a[1] * self.alpha + b[1] * self.beta - b[0] * self.ms);
        let entry = |j: usize, k: usize| q[j] * t[k] + t[j] * q[k] + (m[j] * s[k] + s[j] * m[k]);
        out[..6].copy_from_slice(&[
            entry(0, 0) + diagonal,
            entry(1, 0),
            entry(1, 1) + diagonal,
            entry(2, 0),
            entry(2, 1),
            entry(2, 2) + diagonal,
        ]);
    }
}
