//! `min_xi |x(xi)|` by Gauss-Newton: the parameters xi of the point nearest to the origin, on an element or on its continuation beyond the
//! boundary.

use crate::geometry::shape::{Shape, ShapeParameters};
use crate::scalar::{HALF_DIGITS, NO_EXTENT};

/// Maximum number of steps; sound elements need fewer than ten.
const MAX_STEPS: usize = 50;
/// Maximum number of damped steps: far from a curved element each of them makes little progress.
const MAX_DAMPED_STEPS: usize = 500;
/// Maximum number of lengths that are tried for a damped step; each is half of the one before.
const MAX_HALVINGS: usize = 12;
/// Tangents are dependent if the sine of their angle is at most this.
pub const DEPENDENT: f64 = 1e-7;

/// Result of the Gauss-Newton iteration.
pub struct ClosestParameters {
    /// Parameters, inside the element or outside.
    pub xi: ShapeParameters,
    /// Whether the iteration converged.
    pub converged: bool,
}

/// The parameters of the point nearest to the origin, inside the element or outside. Returns `None` if the element is degenerate at the
/// starting point.
pub fn closest_parameters<const D: usize>(
    shape: Shape,
    nodes: &[[f64; D]],
    start: ShapeParameters,
) -> Option<ClosestParameters> {
    let (mut closest, mut before) = (ClosestParameters { xi: start, converged: false }, f64::INFINITY);
    for count in 0..MAX_STEPS {
        let Some(step) = step(shape, nodes, closest.xi) else {
            // Even a sound element may have a singular map outside of its boundary. Then the iteration ends without convergence.
            return (count > 0).then_some(ClosestParameters { converged: false, ..closest });
        };
        // The iterates are not clamped to the element: the path to an inner point may lead outside.
        closest.xi = std::array::from_fn(|k| (closest.xi[k] + step[k]).clamp(-4.0, 4.0));
        let size: f64 = step.iter().map(|x| x.abs()).sum();
        // The remaining error of xi is about the square of the step.
        closest.converged = size < HALF_DIGITS;
        // Stop at convergence, or when the steps are only rounding.
        if size < f64::EPSILON || (size < NO_EXTENT && size >= before) {
            break;
        }
        before = size;
    }
    Some(closest)
}

/// A local minimum of the distance from the origin within the element, by damped steps.
///
/// Far from a curved element undamped steps do not converge.
pub fn descend<const D: usize>(shape: Shape, nodes: &[[f64; D]], start: ShapeParameters) -> ShapeParameters {
    let distance = |xi: ShapeParameters| {
        let (x, _) = tangents(shape, nodes, xi);
        dot(&x, &x)
    };
    let (mut xi, mut least) = (start, distance(start));
    for _ in 0..MAX_DAMPED_STEPS {
        let Some(step) = step(shape, nodes, xi) else { break };
        let along = |part: f64| shape.clamp(std::array::from_fn(|k| xi[k] + part * step[k]));
        let parts = std::iter::successors(Some(1.0), |part| Some(0.5 * part)).take(MAX_HALVINGS);
        let Some((lower, next)) = parts.map(|part| (distance(along(part)), along(part))).find(|(d, _)| *d < least)
        else {
            break;
        };
        (xi, least) = (next, lower);
    }
    xi
}

/// The point `x(xi)` of an element, and its derivatives `dx / dxi_k`.
pub fn tangents<const D: usize>(shape: Shape, nodes: &[[f64; D]], xi: ShapeParameters) -> ([f64; D], [[f64; D]; 3]) {
    let n = shape.slopes(xi);
    let part = |k: usize| std::array::from_fn(|d| nodes.iter().zip(&n).map(|(x, n)| n[k] * x[d]).sum());
    (part(0), [part(1), part(2), part(3)])
}

pub fn dot<const D: usize>(x: &[f64; D], y: &[f64; D]) -> f64 {
    x.iter().zip(y).map(|(x, y)| x * y).sum()
}

/// Solves `min |x + J step|` with `J = dx / dxi` by modified Gram-Schmidt. Returns `None` if the columns of J are
/// dependent.
pub fn step<const D: usize>(shape: Shape, nodes: &[[f64; D]], xi: ShapeParameters) -> Option<ShapeParameters> {
    let (x, mut q) = tangents(shape, nodes, xi);
    let (n, mut rest) = (shape.dimensions(), x.map(|x| -x));
    let (mut r, mut y) = ([[0.0; 3]; 3], [0.0; 3]);
    for k in 0..n {
        let before = dot(&q[k], &q[k]).sqrt();
        for j in 0..k {
            r[j][k] = dot(&q[j], &q[k]);
            q[k] = std::array::from_fn(|d| q[k][d] - r[j][k] * q[j][d]);
        }
        r[k][k] = dot(&q[k], &q[k]).sqrt();
        // NaN must not pass as a length.
        if r[k][k].is_nan() || r[k][k] <= DEPENDENT * before {
            return None;
        }
        q[k] = q[k].map(|x| x / r[k][k]);
        y[k] = dot(&q[k], &rest);
        rest = std::array::from_fn(|d| rest[d] - y[k] * q[k][d]);
    }
    for k in (0..n).rev() {
        y[k] = (y[k] - (k + 1..n).map(|j| r[k][j] * y[j]).sum::<f64>()) / r[k][k];
    }
    Some(y)
}
