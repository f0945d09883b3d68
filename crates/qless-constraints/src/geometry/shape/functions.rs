//! Shape functions `N_k` and their derivatives. The derivatives come from the same formulas by dual numbers, exact to rounding.

use super::Shape;
use super::domain::ShapeParameters;
use crate::scalar::{Dual, Scalar};

impl Shape {
    /// `[N_k, dN_k / dxi, dN_k / deta, dN_k / dzeta]` of each node.
    pub(crate) fn slopes(self, xi: ShapeParameters) -> Vec<[f64; 4]> {
        let variables: [Dual<3>; 3] = std::array::from_fn(|k| Dual::variable(xi[k], k));
        self.weights(variables).iter().map(|n| [n.real, n.slope[0], n.slope[1], n.slope[2]]).collect()
    }

    /// The shape function `N_k` of each node.
    pub(crate) fn weights<S: Scalar>(self, xi: [S; 3]) -> Vec<S> {
        let one = S::from(1.0);
        let node =
            |function: fn(ShapeParameters, [S; 3]) -> S| self.places().iter().map(|&p| function(p, xi)).collect();
        match self {
            Self::Line2 => node(|[a, ..], [x, ..]| side(a, x)),
            Self::Line3 => node(|[a, ..], [x, ..]| quadratic(a, x)),
            Self::Quad4 => node(|[a, b, _], [x, y, _]| side(a, x) * side(b, y)),
            Self::Hex8 => node(|[a, b, c], [x, y, z]| side(a, x) * side(b, y) * side(c, z)),
            Self::Quad8 => node(|[a, b, _], [x, y, _]| serendipity([a, b], [x, y])),
            Self::Quad9 => node(|[a, b, _], [x, y, _]| quadratic(a, x) * quadratic(b, y)),
            Self::Hex27 => node(|[a, b, c], [x, y, z]| quadratic(a, x) * quadratic(b, y) * quadratic(c, z)),
            Self::Hex20 => node(|p, xi| serendipity(p, xi)),
            Self::Tri3 | Self::Tri6 => simplex(&[one - xi[0] - xi[1], xi[0], xi[1]], self),
            Self::Tet4 | Self::Tet10 => simplex(&[one - xi[0] - xi[1] - xi[2], xi[0], xi[1], xi[2]], self),
            Self::Wedge6 => {
                let l = [one - xi[0] - xi[1], xi[0], xi[1]];
                (0..6).map(|k| l[k % 3] * side(if k < 3 { -1.0 } else { 1.0 }, xi[2])).collect()
            }
            Self::Wedge15 => quadratic_wedge([one - xi[0] - xi[1], xi[0], xi[1]], xi[2]),
            Self::Pyramid5 => pyramid(xi),
            Self::Pyramid13 => quadratic_pyramid(xi),
        }
    }
}

/// `(1 + a x) / 2` for a = -1 or 1: 1 at x = a, and 0 at x = -a.
fn side<S: Scalar>(a: f64, x: S) -> S {
    (S::from(1.0) + S::from(a) * x) * S::from(0.5)
}

/// `1 - x^2`, factored so that it is exactly zero at both ends.
fn bubble<S: Scalar>(x: S) -> S {
    (S::from(1.0) - x) * (S::from(1.0) + x)
}

/// Quadratic Lagrange polynomial on the nodes -1, 0 and 1: 1 at x = a, and 0 at the others.
fn quadratic<S: Scalar>(a: f64, x: S) -> S {
    if a == 0.0 { bubble(x) } else { side(a, x) * S::from(a) * x }
}

/// The serendipity function of the node at `place` a in d dimensions. With `side_i = (1 + a_i x_i) / 2`, it is
/// `prod_i side_i * (sum_i a_i x_i - (d - 1))` at a corner; at a mid-edge node, it is `1 - x^2` along the edge times the sides in the other
/// directions.
fn serendipity<S: Scalar, const D: usize>(place: [f64; D], xi: [S; D]) -> S {
    let at_edge = place.contains(&0.0);
    let factor = |k: usize| if place[k] == 0.0 { bubble(xi[k]) } else { side(place[k], xi[k]) };
    let product = (1..D).fold(factor(0), |product, k| product * factor(k));
    let sum = (0..D).fold(S::from(1.0 - D as f64), |sum, k| sum + S::from(place[k]) * xi[k]);
    if at_edge { product } else { product * sum }
}

/// Shape functions of a triangle or tetrahedron in area or volume coordinates l: `l` for linear shapes; for quadratic ones `l (2 l - 1)` at
/// corners and `4 l_i l_j` at edges.
fn simplex<S: Scalar>(l: &[S], shape: Shape) -> Vec<S> {
    if shape.edges().is_empty() {
        return l.to_vec();
    }
    let corners = l.iter().map(|&l| l * (l + l - S::from(1.0)));
    corners.chain(shape.edges().iter().map(|&[_, i, j]| S::from(4.0) * l[i] * l[j])).collect()
}

/// Shape functions of the wedge with 15 nodes, in area coordinates l and with `side = (1 + a z) / 2` of the triangle at `z = a`, which is
/// -1 or 1: `l side (2 l - 2 + a z)` at corners, `4 l_i l_j side` amid the edges of the triangles, `l (1 - z^2)` amid the edges that join
/// them.
fn quadratic_wedge<S: Scalar>(l: [S; 3], z: S) -> Vec<S> {
    let [two, four] = [2.0, 4.0].map(S::from);
    let ends = || [-1.0, 1.0].into_iter().flat_map(|a| (0..3).map(move |i| (a, i)));
    let corners = ends().map(|(a, i)| l[i] * side(a, z) * (two * l[i] - two + S::from(a) * z));
    let around = ends().map(|(a, i)| four * l[i] * l[(i + 1) % 3] * side(a, z));
    corners.chain(around).chain((0..3).map(|i| l[i] * bubble(z))).collect()
}

/// Shape functions of the pyramid with 5 nodes: a quarter of [`corner`] at the nodes of the base, z at the tip.
fn pyramid<S: Scalar>(xi: [S; 3]) -> Vec<S> {
    let base = |&[a, b, _]: &ShapeParameters| corner([a, b], xi) * S::from(0.25);
    Shape::Quad4.places().iter().map(base).chain([xi[2]]).collect()
}

/// `(q + a x)(q + b y) / q` with `q = 1 - z`: four times the linear shape function of the corner `(a, b)` of a pyramid's base.
fn corner<S: Scalar>([a, b]: [f64; 2], [x, y, z]: [S; 3]) -> S {
    let q = S::from(1.0) - z;
    // x y / q tends to zero at the tip on every path inside the pyramid.
    let twist = if q.real() == 0.0 { S::from(0.0) } else { x * y / q };
    q + S::from(a) * x + S::from(b) * y + S::from(a * b) * twist
}

/// Shape functions of the pyramid with 13 nodes, with `q = 1 - z` and [`corner`]: `corner (a x + b y - 1) / 4` at corners of the base,
/// `z (2 z - 1)` at the tip, `(q - x)(q + x)(q + b y) / (2 q)` at edges of the base along x, `z corner` at edges to the tip.
fn quadratic_pyramid<S: Scalar>([x, y, z]: [S; 3]) -> Vec<S> {
    let (q, [quarter, half]) = (S::from(1.0) - z, [0.25, 0.5].map(S::from));
    let base = |a: f64, b: f64| corner([a, b], [x, y, z]);
    let at = |&[a, b, _]: &ShapeParameters| match (a == 0.0, b == 0.0) {
        (true, _) => (q - x) * base(1.0, b) * half,
        (_, true) => (q - y) * base(a, 1.0) * half,
        _ => base(a, b) * (S::from(a) * x + S::from(b) * y - S::from(1.0)) * quarter,
    };
    let (corners, middles) = Shape::Quad8.places().split_at(4);
    let rising = corners.iter().map(|&[a, b, _]| z * base(a, b));
    corners.iter().map(at).chain([z * (z + z - S::from(1.0))]).chain(middles.iter().map(at)).chain(rising).collect()
}

#[cfg(test)]
mod tests {
    use super::super::tests::inside;
    use super::*;

    /// `N_k` is 1 at node k and exactly 0 at the others.
    #[test]
    fn functions_interpolate() {
        for shape in Shape::ALL {
            assert_eq!(shape.places().len(), shape.nodes());
            for (k, &at) in shape.places().iter().enumerate() {
                for (l, n) in shape.weights(at).into_iter().enumerate() {
                    assert_eq!(n, f64::from(u8::from(k == l)), "{shape:?}: {l} at {k}");
                }
            }
        }
    }

    #[test]
    fn functions_sum_to_one_and_slopes_are_differences() {
        for (shape, seed) in Shape::ALL.into_iter().flat_map(|shape| (0..20).map(move |seed| (shape, seed))) {
            let at = inside(shape, seed);
            assert!((shape.weights(at).iter().sum::<f64>() - 1.0).abs() < 1e-14, "{shape:?}");
            let slopes = shape.slopes(at);
            for k in 0..shape.dimensions() {
                let moved = |step: f64| {
                    let mut at = at;
                    at[k] += step;
                    shape.weights(at)
                };
                for (n, (more, less)) in slopes.iter().zip(moved(1e-6).iter().zip(moved(-1e-6))) {
                    assert!(((more - less) / 2e-6 - n[1 + k]).abs() < 1e-7, "{shape:?} at {at:?}");
                }
            }
        }
    }

    /// All shapes reproduce linear fields; quadratic shapes reproduce all polynomials of degree two.
    #[test]
    fn functions_are_complete() {
        for (shape, seed) in Shape::ALL.into_iter().flat_map(|shape| (0..20).map(move |seed| (shape, seed))) {
            let (at, quadratic) = (inside(shape, seed), !shape.edges().is_empty());
            let field = |[x, y, z]: ShapeParameters| {
                let square = 0.3 * x * x - 0.6 * y * y + z * z + 0.2 * x * y - 0.4 * y * z + 0.7 * z * x;
                0.4 + x - 2.0 * y + 0.5 * z + if quadratic { square } else { 0.0 }
            };
            let sum: f64 = shape.weights(at).iter().zip(shape.places()).map(|(n, &p)| n * field(p)).sum();
            assert!((sum - field(at)).abs() < 1e-14, "{shape:?}: {sum}, {}", field(at));
        }
    }
}
