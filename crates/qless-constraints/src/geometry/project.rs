//! The point of a face nearest to a given one: `min_xi |x(xi) - p|`, by Gauss-Newton.

use super::shape::Shape;

/// Steps before giving up; a face that is not folded needs fewer than ten.
const STEPS: usize = 50;

/// Where a point meets a face.
pub struct Projection {
    /// N_k at the nearest point.
    pub weights: Vec<f64>,
    /// From the point to the face, a length.
    pub distance: f64,
}

/// Projects; nothing if the face is degenerate or folded.
pub fn project<const D: usize>(shape: Shape, nodes: &[[f64; D]], point: &[f64; D]) -> Option<Projection> {
    let mut xi = shape.centre();
    for _ in 0..STEPS {
        let step = step(shape, nodes, point, xi)?;
        let next = [xi[0] + step[0], xi[1] + step[1]];
        // Not clamped on the way: the path to a point inside may lead outside.
        xi = next.map(|x| x.clamp(-4.0, 4.0));
        if step[0].abs() + step[1].abs() < 1e-14 {
            break;
        }
    }
    let xi = shape.clamp(xi);
    let weights: Vec<f64> = shape.functions(xi).iter().map(|n| n[0]).collect();
    let distance = gap(nodes, point, &weights).iter().fold(0.0, |sum: f64, x| sum.hypot(*x));
    distance.is_finite().then_some(Projection { weights, distance })
}

/// `p - x`.
fn gap<const D: usize>(nodes: &[[f64; D]], point: &[f64; D], weights: &[f64]) -> [f64; D] {
    std::array::from_fn(|d| point[d] - nodes.iter().zip(weights).map(|(x, n)| n * x[d]).sum::<f64>())
}

/// `J^T J step = J^T (p - x)` with `J = dx / dxi`.
fn step<const D: usize>(shape: Shape, nodes: &[[f64; D]], point: &[f64; D], xi: [f64; 2]) -> Option<[f64; 2]> {
    let n = shape.functions(xi);
    let part = |k: usize| n.iter().map(|n| n[k]).collect::<Vec<_>>();
    let tangent = |k: usize| gap(nodes, &[0.0; D], &part(k)).map(|x| -x);
    let (r, a, b) = (gap(nodes, point, &part(0)), tangent(1), tangent(2));
    let dot = |x: &[f64; D], y: &[f64; D]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>();
    if shape.dimensions() == 1 {
        let aa = dot(&a, &a);
        return (aa > 0.0).then(|| [dot(&a, &r) / aa, 0.0]);
    }
    let (aa, ab, bb) = (dot(&a, &a), dot(&a, &b), dot(&b, &b));
    let determinant = aa * bb - ab * ab;
    let (ra, rb) = (dot(&a, &r), dot(&b, &r));
    (determinant > 1e-14 * aa * bb).then(|| [(bb * ra - ab * rb) / determinant, (aa * rb - ab * ra) / determinant])
}
