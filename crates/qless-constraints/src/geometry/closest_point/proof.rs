//! Proves that a point of a line or face is the nearest of all its points to the origin.
//!
//! ```text
//! x(xi + delta) = x + J delta + e,    x^T J delta >= 0,    |e| <= kappa |delta|^2 / 2
//! |x(xi + delta)|^2 >= |x|^2 + ((sigma - kappa |delta| / 2)^2 - |x| nu) |delta|^2
//! ```
//!
//! J is `dx / dxi`, and e is the remainder of second order. delta is scaled by the lengths `|J_k|` of the columns of J. In
//! this scale, sigma is the least singular value of J, kappa bounds the second derivatives of x on the whole element, and
//! nu bounds their component along x. An element that bends little, compared to its distance from the origin, has a single
//! nearest point. Cost: the tangents at two or four points per node.

use super::gauss_newton::{dot, tangents};
use crate::geometry::node::ROUNDING;
use crate::geometry::shape::{Shape, ShapeParameters};
use crate::scalar::NO_EXTENT;

/// Safety factor for second derivatives between nodes: they are at most quadratic along an edge, and known at its ends
/// and its middle.
const SAFETY: f64 = 1.25;

/// Whether `xi` is proved to be the nearest point of the element, up to rounding.
pub fn is_nearest<const D: usize>(shape: Shape, nodes: &[[f64; D]], xi: ShapeParameters) -> bool {
    let (x, slopes) = tangents(shape, nodes, xi);
    let distance = dot(&x, &x).sqrt();
    let size = nodes.iter().map(|x| dot(x, x)).fold(0.0, f64::max).sqrt();
    // If the origin lies on the element, no other point is nearer.
    if distance <= ROUNDING * size {
        return true;
    }
    let n = shape.dimensions();
    let descent = slopes.map(|slope| -dot(&x, &slope));
    // Changes of the squared distance below this are rounding.
    let least = (NO_EXTENT * distance + ROUNDING * size) * size;
    let falls = |to: &ShapeParameters| (0..n).map(|k| descent[k] * (to[k] - xi[k])).sum::<f64>() > least;
    if shape.corners().iter().any(falls) {
        return false;
    }
    let lengths = slopes.map(|slope| dot(&slope, &slope).sqrt());
    let farthest = |k: usize| shape.corners().iter().map(|to| (to[k] - xi[k]).abs()).fold(0.0, f64::max);
    let reach = (0..n).map(|k| lengths[k] * farthest(k)).fold(0.0, f64::hypot);
    let [kappa, nu] = second_derivatives(shape, nodes, &x.map(|x| x / distance), lengths);
    // Whether the element is flat up to rounding. This is tested separately, because nu is inaccurate if the origin is near: then the
    // direction to it is inaccurate.
    let is_flat = distance * nu * reach * reach <= least;
    let cosine = if n == 2 { dot(&slopes[0], &slopes[1]) / (lengths[0] * lengths[1]) } else { 0.0 };
    let straight = (1.0 - cosine.abs()).sqrt() - 0.5 * kappa * reach;
    is_flat || (straight > 0.0 && distance * nu <= straight * straight)
}

/// `[kappa, nu]`: bounds on `d2x / dxi_k dxi_l` and on its component along `normal`. They are [`SAFETY`] times the
/// largest values at the nodes, as norms over all k and l. Parameters are scaled by `lengths`.
fn second_derivatives<const D: usize>(
    shape: Shape,
    nodes: &[[f64; D]],
    normal: &[f64; D],
    lengths: [f64; 3],
) -> [f64; 2] {
    let n = shape.dimensions();
    let (mut all, mut along) = ([[0.0_f64; 3]; 3], [[0.0_f64; 3]; 3]);
    for place in shape.places() {
        for l in 0..n {
            let at = |step: f64| {
                tangents(shape, nodes, std::array::from_fn(|k| place[k] + step * f64::from(u8::from(k == l)))).1
            };
            // Differences are exact: tangents are at most quadratic in each parameter.
            let (before, after) = (at(-1.0), at(1.0));
            for k in 0..n {
                let bend: [f64; D] = std::array::from_fn(|d| 0.5 * (after[k][d] - before[k][d]));
                all[k][l] = all[k][l].max(dot(&bend, &bend).sqrt());
                along[k][l] = along[k][l].max(dot(&bend, normal).abs());
            }
        }
    }
    [all, along].map(|most| {
        let scaled = |(k, l): (usize, usize)| most[k][l] / (lengths[k] * lengths[l]);
        SAFETY * (0..n).flat_map(|k| (0..n).map(move |l| (k, l))).map(scaled).fold(0.0, f64::hypot)
    })
}

#[cfg(test)]
mod tests {
    use super::super::gauss_newton::closest_parameters;
    use super::*;
    use crate::geometry::node::relative;
    use crate::geometry::shape::tests::{inside, random};

    /// On faces that bend by a few per cent, every nearest point inside the face is proved, for gaps up to half a unit. The middle of an
    /// arc is proved for an origin nearer than the centre of curvature. Beyond the centre it is not proved: then the ends are nearest.
    #[test]
    fn feet_on_faces_that_are_bent_little_are_proved() {
        let faces = [Shape::Line3, Shape::Tri6, Shape::Quad4, Shape::Quad8, Shape::Quad9];
        for (shape, seed) in faces.into_iter().flat_map(|shape| (0..200).map(move |seed| (shape, 31 * seed))) {
            let off = |k: usize| 0.04 * (random(seed + k) - 0.5);
            let nodes: Vec<[f64; 3]> =
                shape.places().iter().enumerate().map(|(k, p)| [p[0], p[1] + off(k), off(k + 9)]).collect();
            let truth = shape.weights(inside(shape, seed));
            let on: [f64; 3] = std::array::from_fn(|d| nodes.iter().zip(&truth).map(|(x, n)| n * x[d]).sum());
            for gap in [1e-13, 1e-10, 1e-6, 1e-3, 0.1, 0.5] {
                let arms = relative(&nodes, &[on[0], on[1], on[2] + gap]);
                let Some(closest) = closest_parameters(shape, &arms, shape.centre())
                    .filter(|closest| shape.clamp(closest.xi) == closest.xi)
                else {
                    continue;
                };
                assert!(is_nearest(shape, &arms, closest.xi), "{shape:?}, {seed}, {gap}");
            }
        }
        let bow = |height: f64| [[-1.0, -height], [1.0, -height], [0.0, -height - 0.2]];
        assert!(is_nearest(Shape::Line3, &bow(0.5), [0.0; 3]) && !is_nearest(Shape::Line3, &bow(3.0), [0.0; 3]));
    }
}
