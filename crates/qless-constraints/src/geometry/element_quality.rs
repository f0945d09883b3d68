//! Detects elements without size and elements that fold over themselves.

use super::closest_point::gauss_newton::{DEPENDENT, dot, step, tangents};
use super::shape::Shape;

/// Whether an element is degenerate: its tangents at the centre are dependent, or a solid is inverted at some of its corners and not at
/// others, or the normal of a face turns over at a corner, or a line folds back.
pub fn is_degenerate<const D: usize>(shape: Shape, nodes: &[[f64; D]]) -> bool {
    if step(shape, nodes, shape.centre()).is_none() {
        return true;
    }
    match shape.dimensions() {
        1 => return turns_back(shape, nodes),
        2 => return turns_over(shape, nodes),
        _ => (),
    }
    let all: Vec<_> = shape.corners().iter().map(|&xi| tangents(shape, nodes, xi).1).collect();
    // The volume at a corner is divided by the product of the longest tangents in the three directions. The tangents at the corner itself
    // would not do: they may vanish, at collapsed corners and at corners next to quarter-point nodes.
    let longest = |k: usize| all.iter().map(|t| length(&t[k])).fold(0.0, f64::max);
    let unit: f64 = (0..3).map(longest).product();
    let volumes = || all.iter().map(|t| determinant(t) / unit);
    volumes().any(|v| v > DEPENDENT) && volumes().any(|v| v < -DEPENDENT)
}

/// Whether the normal at a corner of a face points against the normal at the centre. The formula needs no cross product, so that it holds
/// in any dimension: `(a x b) . (c x d) = (a . c)(b . d) - (a . d)(b . c)`.
fn turns_over<const D: usize>(shape: Shape, nodes: &[[f64; D]]) -> bool {
    let [c, d, _] = tangents(shape, nodes, shape.centre()).1;
    let all: Vec<_> = shape.corners().iter().map(|&xi| tangents(shape, nodes, xi).1).collect();
    let longest = |k: usize| all.iter().map(|t| length(&t[k])).fold(0.0, f64::max);
    let unit = longest(0) * longest(1) * length(&c) * length(&d);
    all.iter().any(|[a, b, _]| (dot(a, &c) * dot(b, &d) - dot(a, &d) * dot(b, &c)) / unit < -DEPENDENT)
}

/// Whether the tangent `a + xi b` of a line vanishes between its ends, so that the line folds back.
fn turns_back<const D: usize>(shape: Shape, nodes: &[[f64; D]]) -> bool {
    let [from, to] = [0, 1].map(|end| tangents(shape, nodes, shape.corners()[end]).1[0]);
    let (a, b): ([f64; D], [f64; D]) =
        (std::array::from_fn(|k| f64::midpoint(from[k], to[k])), std::array::from_fn(|k| (to[k] - from[k]) / 2.0));
    let xi = -dot(&a, &b) / dot(&b, &b);
    let least: [f64; D] = std::array::from_fn(|k| a[k] + xi * b[k]);
    xi.abs() < 1.0 - DEPENDENT && length(&least) < DEPENDENT * length(&a)
}

fn length<const D: usize>(x: &[f64; D]) -> f64 {
    dot(x, x).sqrt()
}

/// Determinant of three columns; D is 3.
fn determinant<const D: usize>([a, b, c]: &[[f64; D]; 3]) -> f64 {
    (0..3).map(|k| a[k] * (b[(k + 1) % 3] * c[(k + 2) % 3] - b[(k + 2) % 3] * c[(k + 1) % 3])).sum()
}

#[cfg(test)]
mod tests {
    use super::super::shape::tests::random;
    use super::*;

    /// The result for a face or a line depends neither on the plane in space nor on the unit of length.
    #[test]
    fn folds_do_not_depend_on_the_plane() {
        let (mut folded, mut sound) = (0, 0);
        let shapes = || Shape::ALL.into_iter().filter(|shape| shape.dimensions() < 3);
        for (shape, seed) in shapes().flat_map(|shape| (0..300).map(move |seed| (shape, seed))) {
            let most = 0.02 * (seed % 100) as f64;
            let off =
                |k: usize, d: usize| if d < shape.dimensions() { most * (random(seed + 7 * k + d) - 0.5) } else { 0.0 };
            let place = |(k, p): (usize, &[f64; 3])| [p[0] + off(k, 0), p[1] + off(k, 1)];
            let flat: Vec<[f64; 2]> = shape.places().iter().enumerate().map(place).collect();
            let truth = is_degenerate(shape, &flat);
            for unit in [1e-6, 1.0, 1e6] {
                let lift = |&[x, y]: &[f64; 2]| [0.6 * x, y, 0.8 * x].map(|x| unit * x);
                let nodes: Vec<[f64; 3]> = flat.iter().map(lift).collect();
                assert_eq!(is_degenerate(shape, &nodes), truth, "{shape:?}, {seed}, {unit}");
            }
            if truth { folded += 1 } else { sound += 1 }
        }
        assert!(folded > 100 && sound > 1000, "{folded}, {sound}");
    }

    /// The middle node of a straight line may lie up to a quarter of the line's length off the centre, as in crack-tip
    /// elements. A bent line never folds.
    #[test]
    fn lines_turn_back_beyond_a_quarter() {
        let with = |x: f64, y: f64| is_degenerate(Shape::Line3, &[[0.0, 0.0], [1.0, 0.0], [x, y]]);
        assert!(!with(0.25, 0.0) && !with(0.75, 0.0) && !with(0.3, 0.0) && !with(0.1, 0.05) && !with(0.5, 2.0));
        assert!(with(0.24, 0.0) && with(0.9, 0.0) && with(1.5, 0.0));
    }
}
