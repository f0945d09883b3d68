//! The point of an element nearest to a given one: `min_xi |x(xi) - p|`, by Gauss-Newton inside of it, or else on its boundary.
//!
//! In a solid, or a face of the plane, that is the inverse `xi(p)` of its map. A map that is affine takes one step.

use super::bounds::bounds;
use super::shape::{Parameters, Shape};

/// Steps before giving up; an element that is not folded needs fewer than ten.
const STEPS: usize = 50;
/// Of the largest coordinate: what sums of a few rounded products may be off.
pub(crate) const ROUNDING: f64 = 64.0 * f64::EPSILON;
/// Tangents that are dependent to this sine make no face.
const DEPENDENT: f64 = 1e-7;

/// Where a point meets an element.
pub struct Projection {
    /// N_k at the nearest point: exactly zero where they are rounding, and with a sum of one.
    pub weights: Vec<f64>,
    /// From the point to the element, a length.
    pub distance: f64,
}

/// Projects; nothing if the element is degenerate or folded.
///
/// Coordinates relative to the point are exact to their own rounding, however far from the origin the element is.
pub fn project<const D: usize>(shape: Shape, nodes: &[[f64; D]], point: &[f64; D]) -> Option<Projection> {
    let found = nearest(shape, &relative(nodes, point))?;
    Some(Projection { weights: cleaned(found.weights), ..found })
}

/// `x_k - p`.
pub fn relative<const D: usize>(nodes: &[[f64; D]], point: &[f64; D]) -> Vec<[f64; D]> {
    nodes.iter().map(|x| std::array::from_fn(|d| x[d] - point[d])).collect()
}

/// How far a point that lies on an element may seem to be away from it, for the rounding of its coordinates.
pub fn rounding<const D: usize>(nodes: &[[f64; D]], point: &[f64; D]) -> f64 {
    ROUNDING * nodes.iter().flatten().chain(point).fold(0.0, |most: f64, x| most.max(x.abs()))
}

/// The point nearest to the origin.
///
/// Beyond the boundary of a skew element the nearest parameters are not those of the nearest point, so that each side is asked too.
fn nearest<const D: usize>(shape: Shape, nodes: &[[f64; D]]) -> Option<Projection> {
    let foot = inside_or_first(shape, nodes)?;
    let inside = shape.clamp(foot.xi);
    if foot.settled && inside == foot.xi {
        return Some(projection(nodes, shape.weights(inside)));
    }
    let own =
        || std::iter::once(inside).chain(if shape.dimensions() == 1 { shape.corners() } else { &[] }.iter().copied());
    let candidates = own().map(|xi| projection(nodes, shape.weights(xi))).chain(on_sides(shape, nodes));
    candidates.filter(|found| found.distance.is_finite()).min_by(|a, b| a.distance.total_cmp(&b.distance))
}

/// The nearest points of the sides, with the weights of the whole. A side that is a point is that of the others that meet there.
fn on_sides<const D: usize>(shape: Shape, nodes: &[[f64; D]]) -> impl Iterator<Item = Projection> {
    shape.boundary().iter().filter_map(|&(side, numbers)| {
        let own: Vec<_> = numbers.iter().map(|&i| nodes[i]).collect();
        let found = nearest(side, &own)?;
        let mut weights = vec![0.0; nodes.len()];
        numbers.iter().zip(found.weights).for_each(|(&i, n)| weights[i] = n);
        Some(Projection { weights, ..found })
    })
}

fn projection<const D: usize>(nodes: &[[f64; D]], weights: Vec<f64>) -> Projection {
    let place: [f64; D] = std::array::from_fn(|d| nodes.iter().zip(&weights).map(|(x, n)| n * x[d]).sum());
    Projection { distance: place.iter().fold(0.0, |sum: f64, x| sum.hypot(*x)), weights }
}

/// Weights below 8 units in the last place of the largest are zero; what is missing to a sum of one goes to the largest.
fn cleaned(mut weights: Vec<f64>) -> Vec<f64> {
    let largest = weights.iter().fold(0.0, |most: f64, n| most.max(n.abs()));
    weights.iter_mut().filter(|n| n.abs() < 8.0 * f64::EPSILON * largest).for_each(|n| *n = 0.0);
    let missing = 1.0 - weights.iter().sum::<f64>();
    if let Some(most) = weights.iter_mut().max_by(|a, b| a.abs().total_cmp(&b.abs())) {
        *most += missing;
    }
    weights
}

/// Where the steps to the foot of a point ended.
pub struct Foot {
    /// Parameters, inside of the element or not.
    pub xi: Parameters,
    /// Whether the steps came to rest.
    pub settled: bool,
}

/// The foot that the steps from the centre find, or one inside that other starts find.
///
/// Where an element fills its space, one point of it at most is the origin; the steps may still go to one of its map beyond it.
fn inside_or_first<const D: usize>(shape: Shape, nodes: &[[f64; D]]) -> Option<Foot> {
    let first = foot(shape, nodes)?;
    let inside = |foot: &Foot| foot.settled && shape.clamp(foot.xi) == foot.xi;
    let [low, high] = bounds(shape, nodes);
    let may_hold = (0..D).all(|d| low[d] <= 0.0 && high[d] >= 0.0);
    if inside(&first) || shape.is_affine() || shape.dimensions() < D || !may_hold {
        return Some(first);
    }
    let centre = shape.centre();
    let starts = shape.corners().iter().map(|p| std::array::from_fn(|k| f64::midpoint(p[k], centre[k])));
    let another = starts.filter_map(|start| foot_from(shape, nodes, start)).find(inside);
    Some(another.unwrap_or(first))
}

/// The foot of the origin on an element that goes on beyond its boundary; nothing if the element is degenerate at its centre.
pub fn foot<const D: usize>(shape: Shape, nodes: &[[f64; D]]) -> Option<Foot> {
    foot_from(shape, nodes, shape.centre())
}

fn foot_from<const D: usize>(shape: Shape, nodes: &[[f64; D]], start: Parameters) -> Option<Foot> {
    let (mut foot, mut before) = (Foot { xi: start, settled: false }, f64::INFINITY);
    for count in 0..STEPS {
        let Some(step) = step(shape, nodes, foot.xi) else {
            // The map of a sound element may be singular somewhere beyond its boundary.
            return (count > 0).then_some(Foot { settled: false, ..foot });
        };
        // Not clamped to the element on the way: the path to a point inside may lead outside.
        foot.xi = std::array::from_fn(|k| (foot.xi[k] + step[k]).clamp(-4.0, 4.0));
        let size: f64 = step.iter().map(|x| x.abs()).sum();
        foot.settled = size < 1e-8;
        // To rest, or to where steps are rounding.
        if size < f64::EPSILON || (size < 1e-12 && size >= before) {
            break;
        }
        before = size;
    }
    Some(foot)
}

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

/// `x` and `dx / dxi_k`.
fn tangents<const D: usize>(shape: Shape, nodes: &[[f64; D]], xi: Parameters) -> ([f64; D], [[f64; D]; 3]) {
    let n = shape.slopes(xi);
    let part = |k: usize| std::array::from_fn(|d| nodes.iter().zip(&n).map(|(x, n)| n[k] * x[d]).sum());
    (part(0), [part(1), part(2), part(3)])
}

fn dot<const D: usize>(x: &[f64; D], y: &[f64; D]) -> f64 {
    x.iter().zip(y).map(|(x, y)| x * y).sum()
}

/// `min |x + J step|` with `J = dx / dxi`, by modified Gram-Schmidt; nothing if the columns of J are dependent.
fn step<const D: usize>(shape: Shape, nodes: &[[f64; D]], xi: Parameters) -> Option<Parameters> {
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
        if !(r[k][k] > DEPENDENT * before) {
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
                let least = grid(shape)
                    .map(|xi| projection(&relative(&nodes, &point), shape.weights(xi)).distance)
                    .fold(9.0, f64::min);
                assert!(found < least + 1e-12 && least < found + 0.15, "{shape:?}, {point:?}: {found}, {least}");
            }
        }
    }

    fn grid(shape: Shape) -> impl Iterator<Item = Parameters> {
        let at = |i: i32| f64::from(i) / 20.0 - 1.0;
        (0..41 * 41).map(move |i| shape.clamp([at(i % 41), at(i / 41), 0.0]))
    }
}
