//! `int N_i N_j dA` and `int N_i N_k dA` over a segment: where two facets in space lie over each other.
//!
//! Both are seen along the normal of the mean plane of (a part of) the first. There the outlines are polygons, and the functions
//! at a point of the plane are those at the point of the facet that is seen there. Quadratic facets are cut into parts with
//! straight edges.

use super::clip::{Flat, area, clip, is_convex, perimeter, quadrature};
use super::project::foot;
use super::shape::Shape;
use crate::scalar::vector::{Vector, add, cross, dot, perpendicular, scale, sub, unit};

/// Segments below this part of the smaller of the two facets are left out: they are what rounding makes of shared edges.
const SLIVER: f64 = 1e-10;

/// A plane with axes, `x = origin + p axes[0] + q axes[1] + height normal`.
struct Plane {
    origin: Vector<f64>,
    axes: [Vector<f64>; 2],
    normal: Vector<f64>,
}

impl Plane {
    /// Through the mean of the corners, perpendicular to the sum of the normals at the edges; nothing without area.
    fn mean(corners: &[Vector<f64>]) -> Option<Self> {
        let origin = scale(1.0 / corners.len() as f64, corners.iter().fold([0.0; 3], |sum, &x| add(sum, x)));
        let arms: Vec<_> = corners.iter().map(|&x| sub(x, origin)).collect();
        let edges = arms.iter().zip(arms.iter().cycle().skip(1));
        let normal = unit(edges.fold([0.0; 3], |sum, (&a, &b)| add(sum, cross(a, b))))?;
        Some(Self { origin, axes: perpendicular(normal), normal })
    }
}

/// A facet as it is seen along the normal of a plane.
struct View {
    shape: Shape,
    places: Vec<Flat>,
    heights: Vec<f64>,
}

impl View {
    fn new(plane: &Plane, shape: Shape, places: &[Vector<f64>]) -> Self {
        let arms: Vec<_> = places.iter().map(|&x| sub(x, plane.origin)).collect();
        let heights = arms.iter().map(|&arm| dot(arm, plane.normal)).collect();
        Self { shape, places: arms.iter().map(|&arm| plane.axes.map(|axis| dot(arm, axis))).collect(), heights }
    }

    /// The outline of a part, counter-clockwise: a facet that faces the plane is seen from behind.
    fn outline(&self, part: &[usize]) -> Vec<Flat> {
        let mut outline: Vec<Flat> = part.iter().map(|&node| self.places[node]).collect();
        if area(&outline) < 0.0 {
            outline.reverse();
        }
        outline
    }

    /// `N_k` and the height of the facet over a point of the plane. Not clamped: what is linear stays so beyond curved edges.
    fn functions(&self, point: &Flat) -> Option<(Vec<f64>, f64)> {
        let foot = foot(self.shape, &self.places, point).filter(|foot| foot.settled)?;
        let n: Vec<f64> = self.shape.functions(foot.xi).iter().map(|n| n[0]).collect();
        let height = n.iter().zip(&self.heights).map(|(n, h)| n * h).sum();
        Some((n, height))
    }
}

/// Integrals over a segment.
pub struct Segment {
    /// `int N_i N_j dA` of the first facet, n x n by rows.
    pub own: Vec<f64>,
    /// `int N_i N_k dA` with the functions of the other facet, n x m by rows.
    pub other: Vec<f64>,
    /// Its area in the plane.
    pub area: f64,
    /// The largest distance between the facets along the normal.
    pub gap: f64,
}

/// A part of a facet in its mean plane.
pub struct Part {
    plane: Plane,
    view: View,
    outline: Vec<Flat>,
}

impl Part {
    /// The parts of a facet; nothing if one has no area or a corner that points inwards.
    pub fn all(shape: Shape, places: &[Vector<f64>]) -> Option<Vec<Self>> {
        let part = |nodes: &&[usize]| {
            let corners: Vec<_> = nodes.iter().map(|&node| places[node]).collect();
            let plane = Plane::mean(&corners)?;
            let view = View::new(&plane, shape, places);
            let outline = view.outline(nodes);
            is_convex(&outline).then_some(Self { plane, view, outline })
        };
        parts(shape).iter().map(part).collect()
    }

    pub fn area(&self) -> f64 {
        area(&self.outline)
    }

    pub fn perimeter(&self) -> f64 {
        perimeter(&self.outline)
    }

    /// The segments with the parts of another facet.
    pub fn segments(&self, shape: Shape, places: &[Vector<f64>]) -> Vec<Segment> {
        let other = View::new(&self.plane, shape, places);
        let segment = |nodes: &&[usize]| {
            let outline = other.outline(nodes);
            let least = SLIVER * area(&outline).min(self.area());
            let common = clip(outline, &self.outline);
            // Not `<=`: areas that are not numbers are left out too.
            if area(&common) > least { integrate(&self.view, &other, &common) } else { None }
        };
        parts(shape).iter().filter_map(segment).collect()
    }
}

/// Nothing where the functions of a facet cannot be found.
fn integrate(view: &View, other: &View, polygon: &[Flat]) -> Option<Segment> {
    let (n, m) = (view.places.len(), other.places.len());
    let mut sums = Segment { own: vec![0.0; n * n], other: vec![0.0; n * m], area: 0.0, gap: 0.0 };
    for (point, weight) in quadrature(polygon) {
        let ((own, height), (others, above)) = (view.functions(&point)?, other.functions(&point)?);
        sums.area += weight;
        sums.gap = sums.gap.max((above - height).abs());
        for (i, n_i) in own.iter().enumerate() {
            own.iter().enumerate().for_each(|(j, n_j)| sums.own[i * n + j] += weight * n_i * n_j);
            others.iter().enumerate().for_each(|(k, n_k)| sums.other[i * m + k] += weight * n_i * n_k);
        }
    }
    Some(sums)
}

/// Nodes of the parts of a facet, in order around.
fn parts(shape: Shape) -> &'static [&'static [usize]] {
    match shape {
        Shape::Line2 => &[],
        Shape::Tri3 => &[&[0, 1, 2]],
        Shape::Quad4 => &[&[0, 1, 2, 3]],
        Shape::Tri6 => &[&[0, 3, 5], &[3, 1, 4], &[5, 4, 2], &[3, 4, 5]],
        Shape::Quad8 => &[&[0, 4, 7], &[4, 1, 5], &[5, 2, 6], &[6, 3, 7], &[4, 5, 6, 7]],
    }
}
