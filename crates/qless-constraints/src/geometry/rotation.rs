//! `R s`: a vector that rotates with a body.

use crate::scalar::vector::{Vector, add, cross, dot, lift, scale, sub};
use crate::scalar::{Scalar, Univariate};

/// How a body moves: not at all, without rotations, with a rotation vector, or with Euler parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum RotationKind {
    Ground,
    Node,
    Vector,
    Euler,
}

impl RotationKind {
    pub fn positions(self) -> usize {
        if self == Self::Ground { 0 } else { 3 }
    }

    pub fn rotations(self) -> usize {
        match self {
            Self::Ground | Self::Node => 0,
            Self::Vector => 3,
            Self::Euler => 4,
        }
    }

    /// The vector `s` of the reference configuration, rotated; `u` are the rotations of the body.
    pub fn rotate<S: Scalar>(self, u: &[S], s: Vector<f64>) -> Vector<S> {
        match self {
            Self::Ground | Self::Node => lift(s),
            Self::Vector => by_vector([u[0], u[1], u[2]], s),
            Self::Euler => by_euler([S::from(1.0) + u[0], u[1], u[2], u[3]], s),
        }
    }
}

/// `R(theta) s = s + (sin t / t) theta x s + ((1 - cos t) / t^2) ((theta.s) theta - t^2 s)` with `t = |theta|`
/// (Rodrigues).
///
/// Both factors are smooth functions of `t^2`. Their series near zero make derivatives exact at `theta = 0`. The sum has the same terms as
/// in [`super::rotation_derivatives`], so one rounding bound holds for both modules.
pub fn by_vector<S: Scalar>(theta: Vector<S>, s: Vector<f64>) -> Vector<S> {
    let (square, s) = (dot(theta, theta), lift(s));
    let (sine, versine) = factors(square);
    let once = cross(theta, s);
    let twice = sub(scale(dot(theta, s), theta), scale(square, s));
    add(s, add(scale(sine, once), scale(versine, twice)))
}

/// The factors of rotation vectors as functions of `y = t^2`, where t is the angle of rotation.
#[derive(Clone, Copy)]
enum Factor {
    /// `sin t / t`.
    Sine,
    /// `(1 - cos t) / t^2`.
    Versine,
    /// `(t - sin t) / t^3`.
    Third,
}

impl Univariate for Factor {
    fn at<S: Scalar>(self, y: S) -> S {
        // The first term that a series leaves out is below 1e-22 for y < 0.25.
        let is_small = y.real() < 0.25;
        match self {
            Self::Sine if is_small => series(y, 1.0),
            Self::Versine if is_small => series(y, 2.0),
            Self::Third if is_small => series(y, 3.0) / S::from(2.0),
            Self::Sine => {
                let t = y.sqrt();
                t.sin() / t
            }
            Self::Versine => {
                let half = (y.sqrt() * S::from(0.5)).sin();
                S::from(2.0) * half * half / y
            }
            Self::Third => (S::from(1.0) - Self::Sine.at(y)) / y,
        }
    }
}

/// `sin t / t` and `(1 - cos t) / t^2` from `y = t^2`.
pub(super) fn factors<S: Scalar>(y: S) -> (S, S) {
    (y.map(Factor::Sine), y.map(Factor::Versine))
}

/// `(t - sin t) / t^3` from `y = t^2`.
pub(super) fn third_factor<S: Scalar>(y: S) -> S {
    y.map(Factor::Third)
}

/// A series in y: `sum_k (-y)^k / (2k + first)!` if `first` is 1 or 2, and `2 sum_k (-y)^k / (2k + 3)!` if `first` is 3.
fn series<S: Scalar>(y: S, first: f64) -> S {
    let mut sum = S::from(1.0);
    for k in (1..9).rev() {
        let n = 2.0 * f64::from(k) + first;
        sum = S::from(1.0) - y * sum / S::from(n * (n - 1.0));
    }
    sum / S::from(first)
}

/// `R(p) s = (e0^2 - e.e) s + 2 (e.s) e + 2 e0 e x s` with Euler parameters `p = (e0, e)`; a rotation if `|p| = 1`.
pub fn by_euler<S: Scalar>(p: [S; 4], s: Vector<f64>) -> Vector<S> {
    let (e0, e, s) = (p[0], [p[1], p[2], p[3]], lift(s));
    let two = S::from(2.0);
    let along = scale(two * dot(e, s), e);
    let across = scale(two * e0, cross(e, s));
    add(scale(e0 * e0 - dot(e, e), s), add(along, across))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::vector::norm;

    /// A quarter turn and a tiny rotation about z; lengths are kept on both sides of the switch to series.
    #[test]
    fn rotation_vectors_rotate() {
        let quarter = by_vector([0.0, 0.0, std::f64::consts::FRAC_PI_2], [1.0, 0.0, 0.0]);
        assert!(norm(sub(quarter, [0.0, 1.0, 0.0])) < 1e-15);
        for t in [1e-9_f64, 0.3, 0.499_999, 0.500_001, 2.0, 3.1] {
            let turned = by_vector([0.0, 0.0, t], [1.0, 0.0, 0.0]);
            assert!(norm(sub(turned, [t.cos(), t.sin(), 0.0])) < 4e-16, "angle {t}");
        }
    }

    #[test]
    fn euler_parameters_are_the_same_rotation() {
        let theta = [0.3, -0.7, 0.5];
        let t = norm(theta);
        let e = scale((t / 2.0).sin() / t, theta);
        let s = [1.0, 2.0, -0.5];
        let difference = sub(by_euler([(t / 2.0).cos(), e[0], e[1], e[2]], s), by_vector(theta, s));
        assert!(norm(difference) < 1e-15);
    }
}
