//! Whether an element has no size, or turns over within.

use super::foot::{DEPENDENT, dot, step, tangents};
use super::shape::Shape;

/// Whether the tangents at the centre are dependent, or, of an element that fills its space, the map turns over between corners.
pub fn is_degenerate<const D: usize>(shape: Shape, nodes: &[[f64; D]]) -> bool {
    if step(shape, nodes, shape.centre()).is_none() {
        return true;
    }
    if shape.dimensions() < D {
        return false;
    }
    let all: Vec<_> = shape.corners().iter().map(|&xi| tangents(shape, nodes, xi).1).collect();
    // By the longest tangent in each direction: where corners are one node, or middles at a quarter of their edges, one vanishes.
    let longest = |k: usize| all.iter().map(|t| dot(&t[k], &t[k]).sqrt()).fold(0.0, f64::max);
    let unit: f64 = (0..D).map(longest).product();
    let volumes = || all.iter().map(|t| determinant(&t[..D]) / unit);
    volumes().any(|v| v > DEPENDENT) && volumes().any(|v| v < -DEPENDENT)
}

/// Of two columns in the plane or three in space.
fn determinant<const D: usize>(columns: &[[f64; D]]) -> f64 {
    match columns {
        [a, b] => a[0] * b[1] - a[1] * b[0],
        [a, b, c] => (0..3).map(|k| a[k] * (b[(k + 1) % 3] * c[(k + 2) % 3] - b[(k + 2) % 3] * c[(k + 1) % 3])).sum(),
        _ => 0.0,
    }
}
