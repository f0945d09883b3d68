//! `argmin_f |x_f(xi) - p|`: the face of a surface, or the solid of a mesh, nearest to a point.
//!
//! An R*-tree yields the faces in the order of the distances of their bounding boxes. The point is projected on each
//! face, until a box is farther away than the nearest face so far. Cost for n faces and m points near them: O((n + m) log n).

use rayon::prelude::*;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};

use super::bounds::bounds;
use super::closest_point::project;
use super::node::{ROUNDING, rounding, within};
use super::shape::Shape;
use super::surface::{Surface, SurfaceError};

/// Finds the nearest faces of a surface, or the solids of a mesh that contain points, in two or more dimensions:
/// `argmin_f |x_f(xi) - p|`.
///
/// On a curved face, the search starts from its corners, its centre and the points halfway between, and takes the
/// nearest result.
///
/// Among faces at the same distance, up to rounding, the face with the smallest number wins. So the face of a point on
/// an edge or a corner is unique.
///
/// ```
/// use qless_constraints::types::{Face, FaceSearch, PlanarPoint, Shape, Surface};
/// let at = |i: usize| PlanarPoint::new([2 * i, 2 * i + 1], [i as f64, 0.0]);
/// let faces = (0..4).map(|i| Face::new(Shape::Line2, [i, i + 1])).collect();
/// let line = Surface { nodes: (0..5).map(at).collect(), faces };
/// let search = FaceSearch::new(&line)?;
/// let found = search.within(&[[2.25, 0.5], [3.0, 0.0]], 0.5)?;
/// assert_eq!((found[0].face, found[0].distance, &found[0].weights[..]), (2, 0.5, &[0.75, 0.25][..]));
/// // The second point belongs to faces 2 and 3.
/// assert_eq!(found[1].face, 2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct FaceSearch<'a, const D: usize, const F: usize = D> {
    surface: &'a Surface<D, F>,
    tree: RTree<GeomWithData<Rectangle<[f64; D]>, usize>>,
    /// Largest absolute coordinate of the surface.
    size: f64,
}

impl<const D: usize, const F: usize> std::fmt::Debug for FaceSearch<'_, D, F> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("FaceSearch").field("faces", &self.tree.size()).finish_non_exhaustive()
    }
}

/// The face nearest to a point.
#[derive(Clone, Debug, PartialEq)]
pub struct Nearest {
    /// Number of the face, counted from 0.
    pub face: usize,
    /// Distance from the point to the face. In a solid that contains the point it is zero up to rounding.
    pub distance: f64,
    /// The shape functions `N_k` at the nearest point, one for each node of the face. Weights below 8 units in the last place of the
    /// largest are exactly zero; the sum is one, up to two units of rounding per weight.
    pub weights: Vec<f64>,
}

/// Why no face was found for a point.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SearchError {
    /// The surface cannot be searched.
    #[error(transparent)]
    Surface(#[from] SurfaceError),
    /// The coordinates of a point are not finite, or so large that distances overflow.
    #[error("the coordinates of node {node}, from 1, are not finite or too large; correct them")]
    NoPlace {
        /// Number of the node, counted from 1.
        node: usize,
    },
    /// The nearest face is too far away.
    #[error(
        "node {node}, from 1, is {distance} away from the nearest face, {face}, from 1, more than the tolerance \
         {tolerance}: correct the node, add the face that it belongs to, or raise the tolerance"
    )]
    TooFar {
        /// Number of the node, counted from 1.
        node: usize,
        /// Number of the nearest face, counted from 1.
        face: usize,
        /// Distance from the node to this face.
        distance: f64,
        /// Largest allowed distance.
        tolerance: f64,
    },
}

impl<'a, const D: usize, const F: usize> FaceSearch<'a, D, F> {
    /// Builds the tree of bounding boxes.
    ///
    /// # Errors
    /// [`SurfaceError`]: the surface has no faces, or a face is degenerate, has a wrong number of nodes, or names a
    /// missing node.
    pub fn new(surface: &'a Surface<D, F>) -> Result<Self, SurfaceError> {
        const { assert!(D > 1, "a search needs two dimensions") };
        surface.check()?;
        let boxes: Vec<_> =
            surface.faces.iter().enumerate().map(|(i, face)| bounds(face.shape, &surface.places(i))).collect();
        let size = boxes.iter().flatten().flatten().fold(0.0, |most: f64, x| most.max(x.abs()));
        let leaves = boxes.iter().enumerate().map(|(i, &[a, b])| GeomWithData::new(Rectangle::from_corners(a, b), i));
        Ok(Self { surface, tree: RTree::bulk_load(leaves.collect()), size })
    }

    /// The face nearest to a point. Returns `None` if the coordinates are not finite, or if squares of distances would
    /// overflow.
    pub fn nearest(&self, point: &[f64; D]) -> Option<Nearest> {
        let size = point.iter().fold(self.size, |most, x| most.max(x.abs()));
        // The tree compares sums of squares, which must not overflow. (`max` ignores NaN.)
        if size > 1e150 || point.iter().any(|x| x.is_nan()) {
            return None;
        }
        let (rounding, mut least, mut found) = (ROUNDING * size, f64::INFINITY, Vec::new());
        for (leaf, square) in self.tree.nearest_neighbor_iter_with_distance_2(*point) {
            if square.sqrt() > least + rounding {
                break;
            }
            let shape = self.surface.faces[leaf.data].shape;
            if let Some(at) = project(shape, &self.surface.places(leaf.data), point) {
                least = least.min(at.distance);
                found.push(Nearest { face: leaf.data, distance: at.distance, weights: at.weights });
            }
        }
        found.into_iter().filter(|face| face.distance <= least + rounding).min_by_key(|face| face.face)
    }

    /// The nearest face of each point, if its distance is at most the tolerance (a length) plus the rounding of the
    /// coordinates.
    ///
    /// # Errors
    /// [`SearchError`] for the first point that is too far away or whose coordinates are not finite.
    pub fn within(&self, points: &[[f64; D]], tolerance: f64) -> Result<Vec<Nearest>, SearchError> {
        let found: Vec<_> = points.par_iter().map(|point| self.nearest(point)).collect();
        let check = |(i, nearest): (usize, Option<Nearest>)| {
            let nearest = nearest.ok_or(SearchError::NoPlace { node: i + 1 })?;
            let (face, distance) = (nearest.face + 1, nearest.distance);
            let rounding = rounding(&self.surface.places(nearest.face), &points[i]);
            if !within(distance - rounding, tolerance) {
                return Err(SearchError::TooFar { node: i + 1, face, distance, tolerance });
            }
            Ok(nearest)
        };
        found.into_iter().enumerate().map(check).collect()
    }

    /// Faces whose bounding boxes are within a distance of the box of this face, ascending.
    pub(crate) fn faces_near(&self, shape: Shape, places: &[[f64; D]], distance: f64) -> Vec<usize> {
        let [low, high] = bounds(shape, places);
        let reach = distance.max(0.0) + ROUNDING * self.size;
        let around = AABB::from_corners(low.map(|x| x - reach), high.map(|x| x + reach));
        let mut found: Vec<_> = self.tree.locate_in_envelope_intersecting(around).map(|leaf| leaf.data).collect();
        found.sort_unstable();
        found
    }
}
