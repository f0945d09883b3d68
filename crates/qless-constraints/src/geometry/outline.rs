//! Outlines of facets: intervals of a line or convex polygons in a plane, with intersection, size and quadrature.

use crate::scalar::NO_EXTENT;

/// Outline of a facet in its mean plane: a polygon, or an interval of the points `[s, 0]` if the facet is a line.
pub enum Outline {
    /// Lower and upper end.
    Interval(f64, f64),
    /// Corners, counter-clockwise.
    Polygon(Vec<PlanePoint>),
}

impl Outline {
    /// The outline of a line with these ends, or of a face with these corners, in clockwise or counter-clockwise order.
    pub fn new(mut corners: Vec<PlanePoint>) -> Self {
        if let [a, b] = corners.as_slice() {
            return Self::Interval(a[0].min(b[0]), a[0].max(b[0]));
        }
        if area(&corners) < 0.0 {
            corners.reverse();
        }
        Self::Polygon(corners)
    }

    /// Length of an interval, or area of a polygon.
    pub fn size(&self) -> f64 {
        match self {
            Self::Interval(from, to) => to - from,
            Self::Polygon(corners) => area(corners),
        }
    }

    /// Size of the boundary: 2 for an interval, the perimeter of a polygon. Multiplied by a small width, it gives the size of a strip along
    /// the boundary.
    pub fn border(&self) -> f64 {
        match self {
            Self::Interval(..) => 2.0,
            Self::Polygon(corners) => perimeter(corners),
        }
    }

    pub fn is_convex(&self) -> bool {
        match self {
            Self::Interval(from, to) => to > from,
            Self::Polygon(corners) => is_convex(corners),
        }
    }

    /// Intersection of two outlines. Returns `None` if one is a line and the other a polygon.
    pub fn common(self, window: &Self) -> Option<Self> {
        match (self, window) {
            (Self::Interval(a, b), &Self::Interval(c, d)) => Some(Self::Interval(a.max(c), b.min(d))),
            (Self::Polygon(corners), Self::Polygon(window)) => Some(Self::Polygon(clip(corners, window))),
            _ => None,
        }
    }

    /// Quadrature points and weights, exact for polynomials up to degree five.
    pub fn quadrature(&self) -> Vec<(PlanePoint, f64)> {
        match *self {
            Self::Interval(from, to) => {
                let (middle, half) = (f64::midpoint(from, to), (to - from) / 2.0);
                gauss_points().map(|(xi, weight)| ([middle + xi * half, 0.0], weight * half)).to_vec()
            }
            Self::Polygon(ref corners) => quadrature(corners).collect(),
        }
    }
}

/// A point in the plane.
pub type PlanePoint = [f64; 2];

/// Twice the area of the triangle `a b p`: positive if p lies to the left of ab.
fn side(a: PlanePoint, b: PlanePoint, p: PlanePoint) -> f64 {
    (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])
}

/// The edges of a polygon.
fn edges(polygon: &[PlanePoint]) -> impl Iterator<Item = (PlanePoint, PlanePoint)> {
    polygon.iter().copied().zip(polygon.iter().copied().cycle().skip(1))
}

/// Triangles between the first corner and every edge that does not touch it; their signed areas sum to that of the polygon.
fn fan(polygon: &[PlanePoint]) -> impl Iterator<Item = [PlanePoint; 3]> {
    polygon.windows(2).skip(1).map(|ends| [polygon[0], ends[0], ends[1]])
}

/// The area, negative if the corners run clockwise.
pub fn area(polygon: &[PlanePoint]) -> f64 {
    fan(polygon).map(|[a, b, c]| side(a, b, c) / 2.0).sum()
}

pub fn perimeter(polygon: &[PlanePoint]) -> f64 {
    edges(polygon).map(|(a, b)| (b[0] - a[0]).hypot(b[1] - a[1])).sum()
}

/// Whether every corner is convex, up to rounding.
pub fn is_convex(polygon: &[PlanePoint]) -> bool {
    let rounding = NO_EXTENT * area(polygon);
    let after = edges(polygon).skip(1).chain(edges(polygon));
    edges(polygon).zip(after).all(|((a, b), (_, c))| side(a, b, c) >= -rounding)
}

/// The intersection of a polygon with a convex window (Sutherland and Hodgman, Commun. ACM, 1974).
pub fn clip(polygon: Vec<PlanePoint>, window: &[PlanePoint]) -> Vec<PlanePoint> {
    edges(window).fold(polygon, |left, (a, b)| cut(&left, a, b))
}

/// The part of a polygon to the left of the line ab.
fn cut(polygon: &[PlanePoint], a: PlanePoint, b: PlanePoint) -> Vec<PlanePoint> {
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (p, q) in edges(polygon) {
        let (from, to) = (side(a, b, p), side(a, b, q));
        if from >= 0.0 {
            kept.push(p);
        }
        if (from > 0.0 && to < 0.0) || (from < 0.0 && to > 0.0) {
            let t = from / (from - to);
            kept.push([p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])]);
        }
    }
    kept
}

/// An area below this share of a polygon's area counts as rounding. Rounding makes such areas if a corner lies almost on an edge or at
/// another corner, or if two polygons share an edge.
pub const SLIVER: f64 = 1e-10;

/// The corners of a polygon, without those that rounding made: corners whose triangle with both neighbours has almost no area.
fn true_corners(polygon: &[PlanePoint]) -> Vec<PlanePoint> {
    let least = 2.0 * SLIVER * area(polygon);
    let mut corners = polygon.to_vec();
    let mut k = 0;
    while k < corners.len() && corners.len() > 3 {
        let n = corners.len();
        if side(corners[(k + n - 1) % n], corners[k], corners[(k + 1) % n]) < least {
            corners.remove(k);
        } else {
            k += 1;
        }
    }
    corners
}

/// The centroid of the area.
fn centroid(polygon: &[PlanePoint]) -> PlanePoint {
    let parts = || fan(polygon).map(|[a, b, c]| (side(a, b, c), [a[0] + b[0] + c[0], a[1] + b[1] + c[1]]));
    let whole: f64 = parts().map(|(twice, _)| twice).sum();
    // Dividing first avoids underflow of products of areas and lengths in small units.
    [0, 1].map(|k| parts().map(|(twice, sum)| twice / whole * sum[k]).sum::<f64>() / 3.0)
}

/// Triangulation that does not depend on the first corner: the triangle itself, or triangles from the centroid to
/// every edge.
fn triangles(polygon: &[PlanePoint]) -> Vec<[PlanePoint; 3]> {
    match *true_corners(polygon) {
        [a, b, c] => vec![[a, b, c]],
        ref corners => {
            let middle = centroid(corners);
            edges(corners).map(|(a, b)| [middle, a, b]).collect()
        }
    }
}

/// Quadrature points and weights for a polygon, exact up to degree five. They do not depend on the first corner, so
/// that they rotate with the model.
pub fn quadrature(polygon: &[PlanePoint]) -> impl Iterator<Item = (PlanePoint, f64)> {
    triangles(polygon).into_iter().flat_map(|triangle| {
        let whole = side(triangle[0], triangle[1], triangle[2]) / 2.0;
        seven_points().map(|(l, weight)| {
            let at = |k: usize| (0..3).map(|i| l[i] * triangle[i][k]).sum();
            ([at(0), at(1)], whole * weight)
        })
    })
}

/// The three Gauss points and weights on [-1, 1], exact up to degree five.
pub fn gauss_points() -> [(f64, f64); 3] {
    let root = 0.6_f64.sqrt();
    [(-root, 5.0 / 9.0), (0.0, 8.0 / 9.0), (root, 5.0 / 9.0)]
}

/// Area coordinates and weights of Radon's rule of degree five (Monatsh. Math., 1948).
pub fn seven_points() -> [([f64; 3], f64); 7] {
    let root = 15.0_f64.sqrt();
    let [(a, u), (b, v)] = [-root, root].map(|root| ((6.0 + root) / 21.0, (155.0 + root) / 1200.0));
    let [c, d] = [a, b].map(|x| 1.0 - 2.0 * x);
    [
        ([1.0 / 3.0; 3], 0.225),
        ([c, a, a], u),
        ([a, c, a], u),
        ([a, a, c], u),
        ([d, b, b], v),
        ([b, d, b], v),
        ([b, b, d], v),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Checks `int x^p dx = (b^(p + 1) - a^(p + 1)) / (p + 1)` on the interval [a, b].
    #[test]
    fn rule_of_lines_is_exact_up_to_degree_five() {
        let line = Outline::new(vec![[1.5, 0.0], [-0.25, 0.0]]);
        assert_eq!((line.size(), line.border()), (1.75, 2.0));
        for p in 0..=5 {
            let sum: f64 = line.quadrature().iter().map(|([x, _], weight)| weight * x.powi(p)).sum();
            let truth = (1.5_f64.powi(p + 1) - (-0.25_f64).powi(p + 1)) / f64::from(p + 1);
            assert!((sum - truth).abs() < 1e-15 * 8.0, "x^{p}: {sum}, {truth}");
        }
        let apart = Outline::Interval(2.0, 3.0).common(&line).expect("both are lines");
        assert!(apart.size() < 0.0);
    }

    /// A convex polygon with its corners on an ellipse.
    fn polygon(corners: u32, centre: PlanePoint, size: f64) -> Vec<PlanePoint> {
        let angle = |k: u32| std::f64::consts::TAU * (f64::from(k) + 0.3 * f64::from(k % 2)) / f64::from(corners);
        (0..corners).map(|k| [centre[0] + size * angle(k).cos(), centre[1] + 0.7 * size * angle(k).sin()]).collect()
    }

    #[test]
    fn intersections_have_one_area_whichever_is_the_window() {
        let window = polygon(5, [0.0, 0.0], 1.0);
        assert!(is_convex(&window) && !is_convex(&[[0.0, 0.0], [1.0, 0.0], [0.2, 0.2], [0.0, 1.0]]));
        for k in 0..40 {
            let other = polygon(3 + k % 4, [f64::from(k % 7) * 0.3 - 1.0, f64::from(k % 5) * 0.2], 0.8);
            let (one, two) = (area(&clip(other.clone(), &window)), area(&clip(window.clone(), &other)));
            let most = area(&other).min(area(&window)) + 1e-15;
            assert!((one - two).abs() < 1e-15 && (0.0..=most).contains(&one), "{one}, {two}");
        }
        assert_eq!(clip(window.clone(), &window), window);
        assert_eq!(area(&clip(polygon(4, [3.0, 0.0], 1.0), &window)), 0.0);
        assert!((perimeter(&[[0.0, 0.0], [3.0, 0.0], [3.0, 4.0]]) - 12.0).abs() < 1e-15);
    }

    /// `int x^p y^q dA = p! q! / (p + q + 2)!` on the unit triangle.
    #[test]
    fn rule_is_exact_up_to_degree_five() {
        let factorial = |n: i32| (1..=n).map(f64::from).product::<f64>();
        for (p, q) in (0..=5).flat_map(|p| (0..=5 - p).map(move |q| (p, q))) {
            let rule = quadrature(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]);
            let sum: f64 = rule.map(|([x, y], weight)| weight * x.powi(p) * y.powi(q)).sum();
            let truth = factorial(p) * factorial(q) / factorial(p + q + 2);
            assert!((sum - truth).abs() < 1e-15, "x^{p} y^{q}: {sum}, {truth}");
        }
    }
}
