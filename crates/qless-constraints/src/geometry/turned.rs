//! `phi = m . (R s)` with its gradient and Hessian in the rotations, in closed form.
//!
//! With `n = s x m`, for Euler parameters `p = (e0, e)`:
//! `phi = (e0^2 - e.e) m.s + 2 (e.s)(e.m) + 2 e0 e.n`; for a rotation vector, with `y = theta.theta`:
//! `phi = m.s + a(y) alpha + b(y) beta`, `alpha = theta.n`, `beta = (m.theta)(s.theta) - y m.s`.

use super::carrier::Kind;
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
    let mut rows = [[0.0; 4]; 3];
    if kind != Kind::Vector {
        rows.iter_mut().enumerate().for_each(|(axis, row)| gradient(kind, u, s, unit(axis), row));
        return (kind.turn(u, s), rows);
    }
    let theta = [u[0], u[1], u[2]];
    let factors = factors(dot(theta, theta));
    let mut turned = [0.0; 3];
    for (axis, row) in rows.iter_mut().enumerate() {
        let phi = Phi::new(theta, s, unit(axis), factors);
        turned[axis] = phi.ms + phi.a[0] * phi.alpha + phi.b[0] * phi.beta;
        row[..3].copy_from_slice(&phi.gradient());
    }
    (turned, rows)
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

    /// The derivative of the gradient, term by term.
    #[inline]
    fn hessian(&self, out: &mut [f64]) {
        let (t, s, m) = (self.theta, self.s, self.m);
        let side: Vector<f64> = std::array::from_fn(|k| 2.0 * (self.a[1] * self.n[k] + self.b[1] * self.slope_beta[k]));
        let twice = 4.0 * (self.a[2] * self.alpha + self.b[2] * self.beta);
        let diagonal = 2.0 * (self.a[1] * self.alpha + self.b[1] * self.beta - self.b[0] * self.ms);
        for (h, (j, k)) in out.iter_mut().zip(LOWER) {
            let both = side[j] * t[k] + t[j] * side[k] + self.b[0] * (m[j] * s[k] + s[j] * m[k]);
            *h = both + twice * t[j] * t[k] + if j == k { diagonal } else { 0.0 };
        }
    }
}

/// `a = sin t / t`, `b = (1 - cos t) / t^2` and two derivatives of each with respect to `y = t^2`.
fn factors(y: f64) -> [[f64; 3]; 2] {
    if y < 4.0 {
        return [series(y, 1.0), series(y, 2.0)];
    }
    let t = y.sqrt();
    let (sin, cos) = t.sin_cos();
    let half = (0.5 * t).sin();
    let (a, b) = (sin / t, 2.0 * half * half / y);
    // d(cos t)/dy = -a / 2, and so on.
    let (slope_a, slope_b) = ((cos - a) / (2.0 * y), (a - 2.0 * b) / (2.0 * y));
    let curves = [(-0.5 * a - 3.0 * slope_a) / (2.0 * y), (slope_a - 4.0 * slope_b) / (2.0 * y)];
    [[a, slope_a, curves[0]], [b, slope_b, curves[1]]]
}

/// `sum_k (-y)^k / (2k + first)!` and two derivatives, by Horner's rule; for y below 5 the next term is below 1e-25.
fn series(y: f64, first: f64) -> [f64; 3] {
    let coefficients = if first == 1.0 { &ODD } else { &EVEN };
    let (mut value, mut slope, mut half_curve) = (0.0, 0.0, 0.0);
    // Small rotations are common, and eight terms are enough: the ninth adds less than 1e-20 to the second derivative.
    let terms = if y < 0.05 { 8 } else { coefficients.len() };
    for c in coefficients[..terms].iter().rev() {
        half_curve = half_curve * y + slope;
        slope = slope * y + value;
        value = value * y + c;
    }
    [value, slope, 2.0 * half_curve]
}

const ODD: [f64; 16] = inverse_factorials(1);
const EVEN: [f64; 16] = inverse_factorials(2);

/// `(-1)^k / (2k + first)!`.
const fn inverse_factorials(first: u32) -> [f64; 16] {
    let mut all = [0.0; 16];
    let (mut k, mut c) = (0, 1.0 / first as f64);
    while k < 16 {
        all[k] = c;
        let n = 2 * k as u32 + first;
        c /= -(((n + 1) * (n + 2)) as f64);
        k += 1;
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The closed forms go on where the series end. Nearer to zero they would lose digits in differences.
    #[test]
    fn series_and_closed_forms_agree() {
        for y in [4.0, 4.5, 5.0] {
            for (closed, first) in factors(y).iter().zip([1.0, 2.0]) {
                for (a, b) in closed.iter().zip(series(y, first)) {
                    assert!((a - b).abs() < 1e-14 * b.abs(), "y = {y}: {a}, {b}");
                }
            }
        }
    }
}
