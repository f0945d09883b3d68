//! `int N_i N_j` and `int N_i N_k` over a segment, the overlap of two facets in space, with the shape functions `N_i` of the first facet
//! and `N_k` of the second.
//!
//! Both facets are projected on the mean plane of the first (on its chord, if the facets are lines). In this plane their
//! outlines are polygons or intervals. The value of a shape function at a point of the plane is its value at the point of
//! the facet that projects onto this point. Quadratic facets are cut into pieces with straight edges.

use crate::geometry::closest_point::gauss_newton::closest_parameters;
use crate::geometry::node::relative;
use crate::geometry::outline::{Outline, PlanePoint, SLIVER};
use crate::geometry::shape::Shape;
use crate::scalar::vector::{Vector, add, cross, dot, norm, perpendicular, scale, sub, unit};

/// A plane `x = origin + p axes[0] + q axes[1]`, or a line if the second axis is zero.
struct MeanPlane {
    origin: Vector<f64>,
    axes: [Vector<f64>; 2],
}

impl MeanPlane {
    /// The plane through the mean of the corners. Its normal is along the sum of `r_i x r_(i+1)`, where `r_i` are the corners relative to
    /// their mean. Two corners give their chord. Returns `None` if the corners have no area or length.
    fn mean(corners: &[Vector<f64>]) -> Option<Self> {
        let origin = scale(1.0 / corners.len() as f64, corners.iter().fold([0.0; 3], |sum, &x| add(sum, x)));
        if let &[a, b] = corners {
            return Some(Self { origin, axes: [unit(sub(b, a))?, [0.0; 3]] });
        }
        let arms: Vec<_> = corners.iter().map(|&x| sub(x, origin)).collect();
        let edges = arms.iter().zip(arms.iter().cycle().skip(1));
        let normal = unit(edges.fold([0.0; 3], |sum, (&a, &b)| add(sum, cross(a, b))))?;
        Some(Self { origin, axes: perpendicular(normal) })
    }
}

/// A facet projected on a plane.
struct FacetView {
    shape: Shape,
    flat: Vec<PlanePoint>,
    /// Coordinates of the nodes relative to the origin of the plane.
    arms: Vec<Vector<f64>>,
}

impl FacetView {
    fn new(plane: &MeanPlane, shape: Shape, places: &[Vector<f64>]) -> Self {
        let arms: Vec<_> = places.iter().map(|&x| sub(x, plane.origin)).collect();
        Self { shape, flat: arms.iter().map(|&arm| plane.axes.map(|axis| dot(arm, axis))).collect(), arms }
    }

    fn outline(&self, piece: &[usize]) -> Outline {
        Outline::new(piece.iter().map(|&node| self.flat[node]).collect())
    }

    /// The shape functions `N_k` and the position on the facet for a point of the plane. Parameters are not clamped, so that linear fields
    /// stay linear beyond curved edges.
    fn functions(&self, point: &PlanePoint) -> Option<(Vec<f64>, Vector<f64>)> {
        let foot = closest_parameters(self.shape, &relative(&self.flat, point), self.shape.centre())
            .filter(|foot| foot.converged)?;
        let n = self.shape.weights(foot.xi);
        let place = n.iter().zip(&self.arms).fold([0.0; 3], |sum, (&n, &arm)| add(sum, scale(n, arm)));
        Some((n, place))
    }
}

/// Integrals over a segment.
pub struct MortarSegment {
    /// `int N_i N_j` of the first facet, n x n by rows.
    pub own: Vec<f64>,
    /// `int N_i N_k` with the functions of the other facet, n x m by rows.
    pub other: Vec<f64>,
    /// For each entry of `other`, the sum of the absolute values of its terms.
    pub terms: Vec<f64>,
    /// Area or length of the segment.
    pub size: f64,
    /// The largest distance between the facets at quadrature points.
    pub gap: f64,
}

/// A piece of a facet with its mean plane.
pub struct FacetPiece {
    plane: MeanPlane,
    view: FacetView,
    pub outline: Outline,
}

impl FacetPiece {
    /// All pieces of a facet. Returns `None` if a piece has no size or is not convex.
    pub fn all(shape: Shape, places: &[Vector<f64>]) -> Option<Vec<Self>> {
        let piece = |nodes: &&[usize]| {
            let corners: Vec<_> = nodes.iter().map(|&node| places[node]).collect();
            let plane = MeanPlane::mean(&corners)?;
            let view = FacetView::new(&plane, shape, places);
            let outline = view.outline(nodes);
            outline.is_convex().then_some(Self { plane, view, outline })
        };
        pieces(shape).iter().map(piece).collect()
    }

    /// The overlaps with the pieces of another facet.
    pub fn segments(&self, shape: Shape, places: &[Vector<f64>]) -> Vec<MortarSegment> {
        let other = FacetView::new(&self.plane, shape, places);
        let segment = |nodes: &&[usize]| {
            let outline = other.outline(nodes);
            let least = SLIVER * outline.size().min(self.outline.size());
            let common = outline.common(&self.outline)?;
            // Written so that NaN is left out.
            if common.size() > least { integrate(&self.view, &other, &common) } else { None }
        };
        pieces(shape).iter().filter_map(segment).collect()
    }
}

/// Integrates over the common outline. Returns `None` if the shape functions cannot be evaluated at a quadrature point.
fn integrate(view: &FacetView, other: &FacetView, outline: &Outline) -> Option<MortarSegment> {
    let (n, m) = (view.flat.len(), other.flat.len());
    let [own, pairs, terms] = [n * n, n * m, n * m].map(|count| vec![0.0; count]);
    let mut sums = MortarSegment { own, other: pairs, terms, size: 0.0, gap: 0.0 };
    for (point, weight) in outline.quadrature() {
        let ((own, here), (others, there)) = (view.functions(&point)?, other.functions(&point)?);
        sums.size += weight;
        sums.gap = sums.gap.max(norm(sub(there, here)));
        for (i, n_i) in own.iter().enumerate() {
            own.iter().enumerate().for_each(|(j, n_j)| sums.own[i * n + j] += weight * n_i * n_j);
            for (k, n_k) in others.iter().enumerate() {
                sums.other[i * m + k] += weight * n_i * n_k;
                sums.terms[i * m + k] += (weight * n_i * n_k).abs();
            }
        }
    }
    Some(sums)
}

/// Nodes of the pieces of a facet, in cyclic order; empty for solids.
fn pieces(shape: Shape) -> &'static [&'static [usize]] {
    match shape {
        Shape::Line2 => &[&[0, 1]],
        Shape::Line3 => &[&[0, 2], &[2, 1]],
        Shape::Tri3 => &[&[0, 1, 2]],
        Shape::Quad4 => &[&[0, 1, 2, 3]],
        Shape::Tri6 => &[&[0, 3, 5], &[3, 1, 4], &[5, 4, 2], &[3, 4, 5]],
        Shape::Quad8 => &[&[0, 4, 7], &[4, 1, 5], &[5, 2, 6], &[6, 3, 7], &[4, 5, 6, 7]],
        Shape::Quad9 => &[&[0, 4, 8, 7], &[4, 1, 5, 8], &[8, 5, 2, 6], &[7, 8, 6, 3]],
        _ => &[],
    }
}
