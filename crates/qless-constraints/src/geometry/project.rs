//! The point of a face nearest to a given one: `min_xi |x(xi) - p|`, by Gauss-Newton, on the face or else on its edges.

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
///
/// Beyond the edge of a skew face the nearest parameters are not those of the nearest point, so that each edge is asked too.
pub fn project<const D: usize>(shape: Shape, nodes: &[[f64; D]], point: &[f64; D]) -> Option<Projection> {
    let Foot { xi, settled } = foot(shape, nodes, point)?;
    let inside = shape.clamp(xi);
    let corners = if settled && inside == xi { &[] } else { shape.corners() };
    let ends = corners.iter().zip(corners.iter().cycle().skip(1));
    let on_edges = ends.map(|(&a, &b)| foot_on_edge(shape, nodes, point, a, b));
    std::iter::once(inside)
        .chain(on_edges)
        .map(|xi| projection(shape, nodes, point, xi))
        .filter(|found| found.distance.is_finite())
        .min_by(|a, b| a.distance.total_cmp(&b.distance))
}

fn projection<const D: usize>(shape: Shape, nodes: &[[f64; D]], point: &[f64; D], xi: [f64; 2]) -> Projection {
    let weights: Vec<f64> = shape.functions(xi).iter().map(|n| n[0]).collect();
    let distance = gap(nodes, point, &weights).iter().fold(0.0, |sum: f64, x| sum.hypot(*x));
    Projection { weights, distance }
}

/// Where the steps to the foot of a point ended.
pub struct Foot {
    /// Parameters, inside of the face or not.
    pub xi: [f64; 2],
    /// Whether the steps came to rest.
    pub settled: bool,
}

/// The foot of a point on a face that goes on beyond its edges; nothing if the face is degenerate at its centre.
pub fn foot<const D: usize>(shape: Shape, nodes: &[[f64; D]], point: &[f64; D]) -> Option<Foot> {
    let mut foot = Foot { xi: shape.centre(), settled: false };
    for count in 0..STEPS {
        let Some(step) = step(shape, nodes, point, foot.xi) else {
            // The map of a sound face may be singular somewhere beyond its edges.
            return (count > 0).then_some(Foot { settled: false, ..foot });
        };
        // Not clamped to the face on the way: the path to a point inside may lead outside.
        foot.xi = [foot.xi[0] + step[0], foot.xi[1] + step[1]].map(|x| x.clamp(-4.0, 4.0));
        let size = step[0].abs() + step[1].abs();
        foot.settled = size < 1e-8;
        if size < 1e-14 {
            break;
        }
    }
    Some(foot)
}

/// Parameters of the nearest point of the edge from the corner `a` to the corner `b`.
fn foot_on_edge<const D: usize>(
    shape: Shape,
    nodes: &[[f64; D]],
    point: &[f64; D],
    a: [f64; 2],
    b: [f64; 2],
) -> [f64; 2] {
    let along = |t: f64| [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])];
    let mut t = 0.5;
    for _ in 0..STEPS {
        let [r, x, y] = residual_and_tangents(shape, nodes, point, along(t));
        let slope = std::array::from_fn(|d| (b[0] - a[0]) * x[d] + (b[1] - a[1]) * y[d]);
        // Where two corners are one node, the edge is a point.
        let step = if dot(&slope, &slope) > 0.0 { dot(&slope, &r) / dot(&slope, &slope) } else { 0.0 };
        let next = (t + step).clamp(0.0, 1.0);
        let moved = (next - t).abs();
        t = next;
        if moved < 1e-14 {
            break;
        }
    }
    along(t)
}

/// `p - x`.
fn gap<const D: usize>(nodes: &[[f64; D]], point: &[f64; D], weights: &[f64]) -> [f64; D] {
    std::array::from_fn(|d| point[d] - nodes.iter().zip(weights).map(|(x, n)| n * x[d]).sum::<f64>())
}

/// `p - x`, `dx / dxi` and `dx / deta`.
fn residual_and_tangents<const D: usize>(
    shape: Shape,
    nodes: &[[f64; D]],
    point: &[f64; D],
    xi: [f64; 2],
) -> [[f64; D]; 3] {
    let n = shape.functions(xi);
    let part = |k: usize| n.iter().map(|n| n[k]).collect::<Vec<_>>();
    let tangent = |k: usize| gap(nodes, &[0.0; D], &part(k)).map(|x| -x);
    [gap(nodes, point, &part(0)), tangent(1), tangent(2)]
}

fn dot<const D: usize>(x: &[f64; D], y: &[f64; D]) -> f64 {
    x.iter().zip(y).map(|(x, y)| x * y).sum()
}

/// `J^T J step = J^T (p - x)` with `J = dx / dxi`.
fn step<const D: usize>(shape: Shape, nodes: &[[f64; D]], point: &[f64; D], xi: [f64; 2]) -> Option<[f64; 2]> {
    let [r, a, b] = residual_and_tangents(shape, nodes, point, xi);
    if shape.dimensions() == 1 {
        let aa = dot(&a, &a);
        return (aa > 0.0).then(|| [dot(&a, &r) / aa, 0.0]);
    }
    let (aa, ab, bb) = (dot(&a, &a), dot(&a, &b), dot(&b, &b));
    let determinant = aa * bb - ab * ab;
    let (ra, rb) = (dot(&a, &r), dot(&b, &r));
    (determinant > 1e-14 * aa * bb).then(|| [(bb * ra - ab * rb) / determinant, (aa * rb - ab * ra) / determinant])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Beyond an edge that is not perpendicular to the others, the foot is on that edge, not at the nearest parameters.
    #[test]
    fn nearest_point_of_a_skew_face_is_on_its_edge() {
        let triangle = [[0.0, 0.0], [1.0, 0.0], [3.0, 1.0]];
        let found = project(Shape::Tri3, &triangle, &[2.5, 0.0]).expect("not degenerate");
        assert!((found.distance - 0.45_f64.sqrt()).abs() < 1e-15, "{}", found.distance);
        assert!((found.weights[1] - 0.4).abs() < 1e-15 && (found.weights[2] - 0.6).abs() < 1e-15);
    }

    /// Whatever the shape and wherever the point, no point of a fine grid on the face is nearer.
    #[test]
    fn no_point_of_a_grid_is_nearer() {
        let quad = [[0.0, 0.0], [2.0, 0.2], [2.6, 1.6], [0.9, 1.1], [1.0, 0.05], [2.3, 0.9], [1.8, 1.4], [0.4, 0.5]];
        let triangle = [[0.0, 0.0], [2.0, 0.2], [2.6, 1.6], [1.0, 0.05], [2.3, 0.9], [1.3, 0.85]];
        for shape in [Shape::Tri3, Shape::Quad4, Shape::Tri6, Shape::Quad8] {
            let flat = if shape.corners().len() == 3 { &triangle[..shape.nodes()] } else { &quad[..shape.nodes()] };
            let nodes: Vec<[f64; 3]> = flat.iter().map(|&[x, y]| [x, y, 0.2 * x * y]).collect();
            for k in 0..225 {
                let point =
                    [f64::from(k % 15) * 0.4 - 1.5, f64::from(k / 15) * 0.3 - 1.5, f64::from(k % 7) * 0.2 - 0.6];
                let found = project(shape, &nodes, &point).expect("not degenerate").distance;
                let least = grid(shape).map(|xi| projection(shape, &nodes, &point, xi).distance).fold(9.0, f64::min);
                assert!(found < least + 1e-12 && least < found + 0.15, "{shape:?}, {point:?}: {found}, {least}");
            }
        }
    }

    fn grid(shape: Shape) -> impl Iterator<Item = [f64; 2]> {
        (0..41 * 41).map(|i| [i % 41, i / 41].map(|i| f64::from(i) / 20.0 - 1.0)).map(move |xi| shape.clamp(xi))
    }
}
