//! The point of an element nearest to a given point: `min_xi |x(xi) - p|`.
//!
//! Gauss-Newton finds a point inside the element, and a search of the sides finds a point on the boundary. If the element has as many
//! parameters as the space has dimensions, this inverts its map `x(xi)`. Affine elements take one step.

pub mod gauss_newton;
mod proof;

use super::bounds::bounds;
use super::node::relative;
use super::shape::{Shape, ShapeParameters};
use crate::scalar::{clean, complete};
use gauss_newton::{ClosestParameters, closest_parameters, descend};
use proof::is_nearest;

/// The point of an element nearest to a given point.
pub struct Projection {
    /// The shape functions `N_k` at the nearest point. They sum to one, and those that are only rounding are exactly zero.
    pub weights: Vec<f64>,
    /// Distance from the given point to the element.
    pub distance: f64,
}

/// Projects a point on an element. Returns `None` if the element is degenerate or folded.
///
/// All coordinates are taken relative to the point, so that elements far from the origin lose no digits.
pub fn project<const D: usize>(shape: Shape, nodes: &[[f64; D]], point: &[f64; D]) -> Option<Projection> {
    let found = nearest(shape, &relative(nodes, point))?;
    Some(Projection { weights: complete_weights(found.weights, 1.0), ..found })
}

/// The point of the element nearest to the origin.
fn nearest<const D: usize>(shape: Shape, nodes: &[[f64; D]]) -> Option<Projection> {
    let closest = inside_or_first(shape, nodes)?;
    let inside = shape.clamp(closest.xi);
    let has_one_minimum = shape.is_affine() || shape.dimensions() == D;
    if closest.converged && inside == closest.xi && (has_one_minimum || is_nearest(shape, nodes, inside)) {
        return Some(projection(nodes, shape.weights(inside)));
    }
    let near = about_the_boundary(shape, nodes, inside)?;
    if has_one_minimum {
        return Some(near);
    }
    let descend_from = |start: ShapeParameters| descend(shape, nodes, start);
    let (xi, at) = (descend_from(place(shape, &near.weights)), |xi| projection(nodes, shape.weights(xi)));
    let found = [near, at(xi)];
    if is_nearest(shape, nodes, xi) {
        return nearest_of(found.into_iter());
    }
    nearest_of(found.into_iter().chain(starts(shape).into_iter().map(|start| at(descend_from(start)))))
}

/// The point nearest to the origin among the points of the boundary and the point with the parameters `inside`.
///
/// For a skew element the clamped parameters are not the nearest boundary point. So each side is searched too.
fn about_the_boundary<const D: usize>(shape: Shape, nodes: &[[f64; D]], inside: ShapeParameters) -> Option<Projection> {
    let corners = if shape.dimensions() == 1 { shape.corners() } else { &[] };
    let own = std::iter::once(inside).chain(corners.iter().copied()).map(|xi| projection(nodes, shape.weights(xi)));
    nearest_of(own.chain(on_sides(shape, nodes)))
}

fn nearest_of(found: impl Iterator<Item = Projection>) -> Option<Projection> {
    found.filter(|found| found.distance.is_finite()).min_by(|a, b| a.distance.total_cmp(&b.distance))
}

/// Parameters of the point with these weights.
fn place(shape: Shape, weights: &[f64]) -> ShapeParameters {
    std::array::from_fn(|d| shape.places().iter().zip(weights).map(|(place, n)| n * place[d]).sum())
}

/// Starting points for curved lines and faces, which may have several local minima.
fn starts(shape: Shape) -> Vec<ShapeParameters> {
    [&[shape.centre()], &halfway(shape)[..], shape.corners()].concat()
}

/// Points halfway between the corners and the centre.
fn halfway(shape: Shape) -> Vec<ShapeParameters> {
    let centre = shape.centre();
    shape.corners().iter().map(|p| std::array::from_fn(|k| f64::midpoint(p[k], centre[k]))).collect()
}

/// Nearest points of the sides, with weights for the nodes of the whole element. Degenerate sides are skipped: their
/// neighbours share their points.
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

/// Sets weights of at most `8 blur` units in the last place of the largest weight to zero, where `blur` is the factor by which rounding
/// errors have grown. Then corrects the largest weight so that the sum is one.
pub fn complete_weights(mut weights: Vec<f64>, blur: f64) -> Vec<f64> {
    clean(weights.iter_mut(), blur);
    complete(weights.iter_mut(), 1.0);
    weights
}

/// Runs Gauss-Newton from the centre of the element. If the result lies outside the element, returns a result inside it from another start,
/// or the first result if there is none.
///
/// Other starts are tried only if the element has as many dimensions as the space and may contain the origin: then the iteration from the
/// centre may have missed the solution inside, and found another one outside.
fn inside_or_first<const D: usize>(shape: Shape, nodes: &[[f64; D]]) -> Option<ClosestParameters> {
    let first = closest_parameters(shape, nodes, shape.centre())?;
    let inside = |closest: &ClosestParameters| closest.converged && shape.clamp(closest.xi) == closest.xi;
    if inside(&first) || shape.is_affine() || shape.dimensions() < D || !may_hold(shape, nodes) {
        return Some(first);
    }
    let another = halfway(shape).into_iter().filter_map(|start| closest_parameters(shape, nodes, start)).find(inside);
    Some(another.unwrap_or(first))
}

/// Whether the bounding box of the element contains the origin.
fn may_hold<const D: usize>(shape: Shape, nodes: &[[f64; D]]) -> bool {
    let [low, high] = bounds(shape, nodes);
    (0..D).all(|d| low[d] <= 0.0 && high[d] >= 0.0)
}

#[cfg(test)]
mod tests {
    use super::super::shape::ShapeParameters;
    use super::super::shape::tests::{inside, random};
    use super::*;

    /// Projection inverts the map, `xi(x(xi)) = xi`, for every distorted shape, in every unit of length, also far from the origin. At a
    /// corner, the weights of all other nodes are exactly zero.
    #[test]
    fn maps_are_inverted() {
        for (shape, seed) in Shape::ALL.into_iter().flat_map(|shape| (0..20).map(move |seed| (shape, seed))) {
            let off =
                |k: usize, d: usize| if d < shape.dimensions() { 0.1 * (random(seed + 3 * k + d) - 0.5) } else { 0.0 };
            for (unit, far) in [(1.0, 0.0), (1e-6, 0.0), (1e6, 0.0), (1.0, 1e6)] {
                let place =
                    |(k, p): (usize, &ShapeParameters)| std::array::from_fn(|d| unit * (p[d] + off(k, d)) + far);
                let nodes: Vec<[f64; 3]> = shape.places().iter().enumerate().map(place).collect();
                let truth = shape.weights(inside(shape, seed));
                let arms = relative(&nodes, &nodes[0]);
                let at =
                    std::array::from_fn(|d| nodes[0][d] + arms.iter().zip(&truth).map(|(x, n)| n * x[d]).sum::<f64>());
                let found = project(shape, &nodes, &at).expect("not degenerate");
                let worst = found.weights.iter().zip(&truth).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
                assert!(worst < 1e-14 * (2.0 + far), "{shape:?}, {seed}, {unit}, {far}: {worst}");
                for corner in 0..shape.corners().len() {
                    let found = project(shape, &nodes, &nodes[corner]).expect("not degenerate");
                    let truth = (0..nodes.len()).map(|k| f64::from(u8::from(k == corner)));
                    assert!(
                        found.weights.iter().copied().eq(truth),
                        "{shape:?}, {seed}, {corner}: {:?}",
                        found.weights
                    );
                }
            }
        }
    }

    /// For a point beyond an oblique edge, the nearest point of the face is on that edge; clamping the parameters gives another point.
    #[test]
    fn nearest_point_of_a_skew_face_is_on_its_edge() {
        let triangle = [[0.0, 0.0], [1.0, 0.0], [3.0, 1.0]];
        let found = project(Shape::Tri3, &triangle, &[2.5, 0.0]).expect("not degenerate");
        assert!((found.distance - 0.45_f64.sqrt()).abs() < 1e-15, "{}", found.distance);
        assert!((found.weights[1] - 0.4).abs() < 1e-15 && (found.weights[2] - 0.6).abs() < 1e-15);
    }

    fn grid(shape: Shape) -> impl Iterator<Item = ShapeParameters> {
        let at = |i: i32| f64::from(i) / 20.0 - 1.0;
        (0..41 * 41).map(move |i| shape.clamp([at(i % 41), at(i / 41), 0.0]))
    }

    /// On distorted curved lines and faces, in every unit, no grid point is nearer than the result. For a point of the face, the distance
    /// is zero.
    #[test]
    fn no_point_of_a_distorted_face_is_nearer() {
        let faces = || Shape::ALL.into_iter().filter(|shape| shape.dimensions() < 3);
        let (mut checked, mut wrong) = (0, Vec::new());
        for (shape, seed) in faces().flat_map(|shape| (0..400_usize).map(move |seed| (shape, 977 * seed))) {
            let (unit, off) = ([1e-6, 1.0, 1e6][seed % 3], 0.3 * random(seed));
            let place = |(k, p): (usize, &ShapeParameters)| {
                std::array::from_fn(|d| unit * (p[d] + off * (2.0 * random(seed + 3 * k + d + 1) - 1.0)))
            };
            let nodes: Vec<[f64; 3]> = shape.places().iter().enumerate().map(place).collect();
            let truth = shape.weights(inside(shape, seed));
            let on: [f64; 3] = std::array::from_fn(|d| nodes.iter().zip(&truth).map(|(x, n)| n * x[d]).sum());
            for gap in [0.0, 0.1, 0.5, 2.0] {
                let point: [f64; 3] =
                    std::array::from_fn(|d| on[d] + unit * gap * (2.0 * random(seed + 400 + d) - 1.0));
                let Some(found) = project(shape, &nodes, &point) else { continue };
                let arms = relative(&nodes, &point);
                let grid = grid(shape).step_by(3).map(|xi| projection(&arms, shape.weights(xi)).distance);
                let least = if gap == 0.0 { 0.0 } else { grid.fold(f64::INFINITY, f64::min) };
                checked += 1;
                if found.distance > least * (1.0 + 1e-9) + 1e-14 * unit {
                    wrong.push((shape, seed, gap, found.distance / unit, least / unit));
                }
            }
        }
        assert!(
            checked > 5000 && wrong.is_empty(),
            "{} of {checked}: {:?}",
            wrong.len(),
            wrong.iter().take(20).collect::<Vec<_>>()
        );
    }

    /// For a point beyond the centre of curvature of an arc, the middle of the arc is stationary but farthest; the ends are nearest.
    #[test]
    fn the_farthest_point_nearby_is_not_the_nearest() {
        for (height, nearest) in [(3.0, 10.0_f64.sqrt()), (-3.0, 2.8)] {
            let bow = [[-1.0, 0.0], [1.0, 0.0], [0.0, -0.2]];
            let found = project(Shape::Line3, &bow, &[0.0, height]).expect("not degenerate");
            assert!((found.distance - nearest).abs() < 4e-15, "{}", found.distance);
        }
    }

    /// In warped and curved solids, no grid point is nearer than the result, up to the spacing of the grid.
    #[test]
    fn no_point_of_a_solid_is_nearer() {
        let solids = Shape::ALL.into_iter().filter(|shape| shape.dimensions() == 3);
        for (shape, seed) in solids.flat_map(|shape| (0..4).map(move |seed| (shape, 1000 * seed))) {
            let most = if shape.edges().is_empty() { 0.3 } else { 0.1 };
            let off = |k: usize, d: usize| most * (random(seed + 3 * k + d) - 0.5);
            let place = |(k, p): (usize, &ShapeParameters)| std::array::from_fn(|d| p[d] + off(k, d));
            let nodes: Vec<[f64; 3]> = shape.places().iter().enumerate().map(place).collect();
            let at = |i: usize| i as f64 / 6.0 - 1.0;
            let grid: Vec<_> =
                (0..13_usize.pow(3)).map(|i| shape.clamp([at(i % 13), at(i / 13 % 13), at(i / 169)])).collect();
            for k in 0..60 {
                let point = std::array::from_fn(|d| 4.0 * random(seed + 500 + 3 * k + d) - 2.0);
                let found = project(shape, &nodes, &point).expect("not degenerate");
                let arms = relative(&nodes, &point);
                let least = grid.iter().map(|&xi| projection(&arms, shape.weights(xi)).distance).fold(9.0, f64::min);
                let (found, own) = (found.distance, projection(&arms, found.weights).distance);
                assert!(found < least + 1e-12 && least < found + 0.35, "{shape:?}, {point:?}: {found}, {least}");
                assert!((found - own).abs() < 1e-14, "{shape:?}, {point:?}: {found}, {own}");
            }
        }
    }
}
