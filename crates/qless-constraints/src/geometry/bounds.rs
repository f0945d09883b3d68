//! Bounding boxes of elements.

use super::shape::Shape;

/// Lower and upper corner of a box that contains an element, also if a curved one bulges beyond its nodes.
///
/// It is the bounding box of the Bernstein control points, whose convex hull contains all edges and faces. A solid that
/// is not folded lies within its faces.
pub(crate) fn bounds<const D: usize>(shape: Shape, places: &[[f64; D]]) -> [[f64; D]; 2] {
    let mut control = Vec::new();
    add_control_points(shape, places, &mut control);
    let extreme = |worst: f64, pick: fn(f64, f64) -> f64| {
        std::array::from_fn(|k| control.iter().fold(worst, |found, x| pick(found, x[k])))
    };
    [extreme(f64::INFINITY, f64::min), extreme(f64::NEG_INFINITY, f64::max)]
}

/// Adds the control points: the corners a; `2 m - (a + b) / 2` for each edge ab with the middle node m; and for the centre
/// `sum m - 3/4 sum a` of a Quad8, or `4 c - sum m + 1/4 sum a` of a Quad9 with the centre node c.
fn add_control_points<const D: usize>(shape: Shape, places: &[[f64; D]], control: &mut Vec<[f64; D]>) {
    let corners = shape.corners().len();
    control.extend(&places[..corners]);
    let edge = |&[m, a, b]: &[usize; 3]| {
        std::array::from_fn(|d| 2.0 * places[m][d] - f64::midpoint(places[a][d], places[b][d]))
    };
    control.extend(shape.edges().iter().map(edge));
    let sum = |points: &[[f64; D]], d: usize| points.iter().map(|x| x[d]).sum::<f64>();
    let middle = |places: &[[f64; D]]| {
        std::array::from_fn(|d| {
            let (corners, middles) = (sum(&places[..4], d), sum(&places[4..8], d));
            places.get(8).map_or(middles - 0.75 * corners, |c| 4.0 * c[d] - middles + 0.25 * corners)
        })
    };
    let is_curved = |side: &Shape| matches!(side, Shape::Quad8 | Shape::Quad9);
    if is_curved(&shape) {
        control.push(middle(places));
    }
    let curved = shape.boundary().iter().filter(|(side, _)| is_curved(side));
    control.extend(curved.map(|(_, nodes)| middle(&nodes.iter().map(|&i| places[i]).collect::<Vec<_>>())));
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Curved faces stay within their boxes. The box of a line is exact.
    #[test]
    fn faces_stay_within_their_bounds() {
        let at = |seed: u32| f64::from(seed.wrapping_mul(2_654_435_761) >> 8) / f64::from(1_u32 << 24);
        for (shape, seed) in
            [Shape::Tri6, Shape::Quad8, Shape::Quad9].into_iter().flat_map(|s| (0..50).map(move |k| (s, k)))
        {
            let places: Vec<[f64; 2]> =
                (0..shape.nodes() as u32).map(|k| [at(97 * seed + 2 * k), at(97 * seed + 2 * k + 1)]).collect();
            let [low, high] = bounds(shape, &places);
            for i in 0..441 {
                let [xi, eta] = [i % 21, i / 21].map(|i| f64::from(i) / 10.0 - 1.0);
                let xi = shape.clamp([xi, eta, 0.0]);
                for d in 0..2 {
                    let x: f64 = shape.weights(xi).iter().zip(&places).map(|(n, x)| n * x[d]).sum();
                    assert!(low[d] - 1e-14 <= x && x <= high[d] + 1e-14, "{shape:?} at {xi:?}: {x}");
                }
            }
        }
        let line = bounds(Shape::Line2, &[[1.0, 0.0], [0.0, 2.0]]);
        assert_eq!(line, [[0.0, 0.0], [1.0, 2.0]]);
    }
}
