//! `min_xi |x(xi)|`: the parameters of an element, or of what lies beyond its boundary, nearest to the origin, by Gauss-Newton.
//!
//! An element with as many parameters as its space has dimensions is inverted by it, in one step where its map is affine.

use crate::geometry::shape::{Shape, ShapeParameters};

/// Steps before giving up; an element that is not folded needs fewer than ten.
const STEPS: usize = 50;
/// The most steps that are halved: far from a curved element each of them takes a part of what is left.
const MANY: usize = 500;
/// Halves of a step that are tried.
const HALVES: usize = 12;
/// Tangents that are dependent to this sine make no face.
pub const DEPENDENT: f64 = 1e-7;

/// Where the steps to the foot of a point ended.
pub struct ClosestParameters {
    /// ShapeParameters, inside of the element or not.
    pub xi: ShapeParameters,
    /// Whether the steps came to rest.
    pub converged: bool,
}

/// The foot of the origin on an element that goes on beyond its boundary; nothing if the element is degenerate at its centre.
pub fn closest_parameters<const D: usize>(shape: Shape, nodes: &[[f64; D]]) -> Option<ClosestParameters> {
    closest_parameters_from(shape, nodes, shape.centre())
}

/// The same from other parameters.
pub fn closest_parameters_from<const D: usize>(
    shape: Shape,
    nodes: &[[f64; D]],
    start: ShapeParameters,
) -> Option<ClosestParameters> {
    let (mut foot, mut before) = (ClosestParameters { xi: start, converged: false }, f64::INFINITY);
    for count in 0..STEPS {
        let Some(step) = step(shape, nodes, foot.xi) else {
            // The map of a sound element may be singular somewhere beyond its boundary.
            return (count > 0).then_some(ClosestParameters { converged: false, ..foot });
        };
        // Not clamped to the element on the way: the path to a point inside may lead outside.
        foot.xi = std::array::from_fn(|k| (foot.xi[k] + step[k]).clamp(-4.0, 4.0));
        let size: f64 = step.iter().map(|x| x.abs()).sum();
        foot.converged = size < 1e-8;
        // To rest, or to where steps are rounding.
        if size < f64::EPSILON || (size < 1e-12 && size >= before) {
            break;
        }
        before = size;
    }
    Some(foot)
}

/// ShapeParameters of the element from which no step leads nearer to the origin: each goes as far as the distance falls.
///
/// Far from a curved element whole steps do not come to rest.
pub fn descend<const D: usize>(shape: Shape, nodes: &[[f64; D]], start: ShapeParameters) -> ShapeParameters {
    let distance = |xi: ShapeParameters| {
        let (x, _) = tangents(shape, nodes, xi);
        dot(&x, &x)
    };
    let (mut xi, mut least) = (start, distance(start));
    for _ in 0..MANY {
        let Some(step) = step(shape, nodes, xi) else { break };
        let along = |part: f64| shape.clamp(std::array::from_fn(|k| xi[k] + part * step[k]));
        let parts = std::iter::successors(Some(1.0), |part| Some(0.5 * part)).take(HALVES);
        let Some((lower, next)) = parts.map(|part| (distance(along(part)), along(part))).find(|(d, _)| *d < least)
        else {
            break;
        };
        (xi, least) = (next, lower);
    }
    xi
}

/// `x` and `dx / dxi_k`.
pub fn tangents<const D: usize>(shape: Shape, nodes: &[[f64; D]], xi: ShapeParameters) -> ([f64; D], [[f64; D]; 3]) {
    let n = shape.slopes(xi);
    let part = |k: usize| std::array::from_fn(|d| nodes.iter().zip(&n).map(|(x, n)| n[k] * x[d]).sum());
    (part(0), [part(1), part(2), part(3)])
}

pub fn dot<const D: usize>(x: &[f64; D], y: &[f64; D]) -> f64 {
    x.iter().zip(y).map(|(x, y)| x * y).sum()
}

/// `min |x + J step|` with `J = dx / dxi`, by modified Gram-Schmidt; nothing if the columns of J are dependent.
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
        // A NaN is no length.
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
