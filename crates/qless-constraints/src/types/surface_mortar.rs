//! `sum_j D_ij u_j - sum_k M_ik u_k = 0`, `D_ij = int N_i N_j dA`, `M_ik = int N_i N_k dA`: a tie of surfaces in the mean.
//!
//! Puso, Int. J. Numer. Meth. Engng 59 (2004) 315; with segments as in Popp, Gitterle, Gee and Wall, ibid. 83 (2010) 1428;
//! quadratic facets by parts as in Puso, Laursen and Solberg, Comput. Methods Appl. Mech. Engng 197 (2008) 555.

use std::collections::BTreeMap;

use rayon::prelude::*;

use crate::geometry::node::{AXES, within};
use crate::geometry::search::FaceSearch;
use crate::geometry::segment::{Part, Segment};
use crate::geometry::shape::Shape;
use crate::geometry::surface::{Face, Surface, SurfaceError};
use crate::{Constraint, Store};

/// Part of the area of a facet that may be lost to rounding.
const ROUNDING: f64 = 1e-8;

/// `sum_j D_ij u_j - sum_k M_ik u_k = 0`: two meshes of the same surface in space, tied in the mean.
///
/// `D_ij = int N_i N_j dA` and `M_ik = int N_i N_k dA` with the functions `N_i`, `N_j` of the slave side, which are the
/// multipliers too, and `N_k` of the master side. One equation for each node i of a slave facet and each component, in the unit
/// of an area times that of u (Puso 2004; Popp et al. 2010).
///
/// The integrals go over the segments in which a slave and a master facet lie over each other, seen along the normal of the mean
/// plane of the slave facet, where areas are measured; both over the same ones, so that each row sums to zero. Fields that are
/// linear pass on a flat surface, whatever the shapes. The rule has degree five on each triangle of a segment: exact for Tri3,
/// for Tri6 with straight edges and for Quad4 that are parallelograms; for a Quad4 whose corners are a fifth of its size off,
/// the error is some 1e-5 of them. With n facets on a side near each other the cost is O(n log n).
///
/// ```
/// use qless_constraints::{ConstraintSet, types::{Face, Point, Shape, Surface, SurfaceMortarTie}};
/// let at = |i: usize, x: f64, y: f64| Point::new([3 * i, 3 * i + 1, 3 * i + 2], [x, y, 0.0]);
/// let corners = |i: usize| vec![at(i, 0.0, 0.0), at(i + 1, 1.0, 0.0), at(i + 2, 1.0, 1.0), at(i + 3, 0.0, 1.0)];
/// let slave = Surface { nodes: corners(0), faces: vec![Face::new(Shape::Quad4, [0, 1, 2, 3])] };
/// let halves = vec![Face::new(Shape::Tri3, [0, 1, 2]), Face::new(Shape::Tri3, [0, 2, 3])];
/// let master = Surface { nodes: corners(4), faces: halves };
/// let mut builder = ConstraintSet::builder(24);
/// builder.add("interface", SurfaceMortarTie { slave, master, tolerance: 1e-9 })?;
/// let set = builder.build()?;
/// // Row sums of D, here those of the node at (0, 0): the integral of its function.
/// let d: f64 = set.allocate().g().row(0).filter(|&(dof, _)| dof < 12).map(|(_, value)| value).sum();
/// assert!((d - 0.25).abs() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceMortarTie {
    /// The side that carries the multipliers.
    pub slave: Surface<3>,
    /// The other side.
    pub master: Surface<3>,
    /// Farthest that the sides may be apart, a length; also how wide a border of a slave facet may have no master facet, up to half
    /// of its area.
    pub tolerance: f64,
}

/// What can be wrong with a mortar tie of surfaces.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SurfaceMortarError {
    /// A side is not a surface.
    #[error("{side} side: {source}")]
    Surface {
        /// "slave" or "master".
        side: &'static str,
        /// What is wrong with it.
        source: SurfaceError,
    },
    /// A facet is a line, or has no area or a corner that points inwards.
    #[error(
        "facet {facet}, from 1, of the {side} side is a line, has no area, or points inwards at a corner; correct it"
    )]
    Facet {
        /// "slave" or "master".
        side: &'static str,
        /// The facet, from 1.
        facet: usize,
    },
    /// Part of a slave facet has no master facet over it, or only one that is too far away.
    #[error(
        "no master facet lies within the tolerance {tolerance} over {bare} of the area {area} of slave facet {facet}, from 1; {}",
        beyond(*gap)
    )]
    NotCovered {
        /// The slave facet, from 1.
        facet: usize,
        /// The area without a master facet.
        bare: f64,
        /// The area of the facet, or of the part of a quadratic one.
        area: f64,
        /// How far the sides may be apart.
        tolerance: f64,
        /// How far the nearest master facet is that lies over the facet beyond the tolerance, if one does.
        gap: Option<f64>,
    },
    /// Several master facets lie over the same place.
    #[error(
        "master facets lie over {covered}, more than the area {area} of slave facet {facet}, from 1: \
         take out those that are there twice or lie behind others"
    )]
    Overlap {
        /// The slave facet, from 1.
        facet: usize,
        /// The sum of the areas of the segments.
        covered: f64,
        /// The area of the facet, or of the part of a quadratic one.
        area: f64,
    },
}

/// What to do about a facet that is not covered.
fn beyond(gap: Option<f64>) -> String {
    match gap {
        Some(gap) => format!("one that lies over it is {gap} away: bring the sides together, or raise the tolerance"),
        None => "nothing lies over it: extend the master side, shorten the slave side, or exchange the two".to_owned(),
    }
}

/// The segments of a slave facet, each with its master facet.
type Segments = Vec<(usize, Segment)>;

impl SurfaceMortarTie {
    /// Both sides are surfaces of sound facets.
    fn check(&self) -> Result<(), SurfaceMortarError> {
        for (side, surface) in [("slave", &self.slave), ("master", &self.master)] {
            surface.check().map_err(|source| SurfaceMortarError::Surface { side, source })?;
            let sound = |&facet: &usize| {
                let shape = surface.faces[facet].shape;
                shape != Shape::Line2 && Part::all(shape, &surface.places(facet)).is_some()
            };
            if let Some(facet) = (0..surface.faces.len()).find(|facet| !sound(facet)) {
                return Err(SurfaceMortarError::Facet { side, facet: facet + 1 });
            }
        }
        Ok(())
    }

    /// The segments of one slave facet, which must cover it once.
    fn segments(&self, facet: usize, search: &FaceSearch<3>) -> Result<Segments, SurfaceMortarError> {
        let (shape, places) = (self.slave.faces[facet].shape, self.slave.places(facet));
        let near = search.touching(shape, &places, self.tolerance);
        let mut segments = Vec::new();
        for part in Part::all(shape, &places).unwrap_or_default() {
            let first = segments.len();
            let over = near.iter().flat_map(|&master| self.over(&part, master).map(move |segment| (master, segment)));
            segments.extend(over.filter(|(_, segment)| within(segment.gap, self.tolerance)));
            let covered = segments[first..].iter().map(|(_, segment)| segment.area).sum();
            self.check_cover(facet + 1, &part, covered)?;
        }
        Ok(segments)
    }

    /// The segments of a part with a master facet, however far.
    fn over(&self, part: &Part, master: usize) -> impl Iterator<Item = Segment> + use<> {
        part.segments(self.master.faces[master].shape, &self.master.places(master)).into_iter()
    }

    fn check_cover(&self, facet: usize, part: &Part, covered: f64) -> Result<(), SurfaceMortarError> {
        let (area, tolerance) = (part.area(), self.tolerance);
        let bare = area - covered;
        // However large the tolerance, a facet that is bare for the most part is not tied.
        let allowed = (tolerance * part.perimeter()).min(area / 2.0) + ROUNDING * area;
        if within(bare.abs(), allowed) {
            Ok(())
        } else if bare < 0.0 {
            Err(SurfaceMortarError::Overlap { facet, covered, area })
        } else {
            Err(SurfaceMortarError::NotCovered { facet, bare, area, tolerance, gap: None })
        }
    }

    /// Adds the gap to the error, by asking all master facets: too slow to be done for each slave facet that has an error.
    fn with_gap(&self, error: SurfaceMortarError) -> SurfaceMortarError {
        let SurfaceMortarError::NotCovered { facet, bare, area, tolerance, .. } = error else { return error };
        let places = self.slave.places(facet - 1);
        let parts = Part::all(self.slave.faces[facet - 1].shape, &places).unwrap_or_default();
        let masters = || 0..self.master.faces.len();
        let gaps = parts.iter().flat_map(|part| masters().flat_map(|master| self.over(part, master)));
        let gap = gaps.map(|segment| segment.gap).filter(|&gap| !within(gap, tolerance)).min_by(f64::total_cmp);
        SurfaceMortarError::NotCovered { facet, bare, area, tolerance, gap }
    }
}

/// A row of D and of M, by nodes.
#[derive(Default)]
struct Row {
    d: BTreeMap<usize, f64>,
    m: BTreeMap<usize, f64>,
}

/// Adds the integrals over a segment to the rows of the nodes of its slave facet.
fn add(rows: &mut BTreeMap<usize, Row>, slave: &Face, master: &Face, segment: &Segment) {
    let (n, m) = (slave.nodes.len(), master.nodes.len());
    for ((&i, own), other) in slave.nodes.iter().zip(segment.own.chunks(n)).zip(segment.other.chunks(m)) {
        let row = rows.entry(i).or_default();
        slave.nodes.iter().zip(own).for_each(|(&j, v)| *row.d.entry(j).or_default() += v);
        master.nodes.iter().zip(other).for_each(|(&k, v)| *row.m.entry(k).or_default() += v);
    }
}

impl Constraint for SurfaceMortarTie {
    const NAME: &'static str = "mortar tie of surfaces";
    type Error = SurfaceMortarError;

    fn process(self, store: &mut Store) -> Result<(), SurfaceMortarError> {
        self.check()?;
        let search =
            FaceSearch::new(&self.master).map_err(|source| SurfaceMortarError::Surface { side: "master", source })?;
        let (slave, master) = (&self.slave, &self.master);
        let facets: Vec<_> =
            (0..slave.faces.len()).into_par_iter().map(|facet| self.segments(facet, &search)).collect();
        let mut rows = BTreeMap::new();
        for (face, segments) in slave.faces.iter().zip(facets) {
            let segments = segments.map_err(|error| self.with_gap(error))?;
            segments.iter().for_each(|(other, segment)| add(&mut rows, face, &master.faces[*other], segment));
        }
        for (i, row) in rows {
            for axis in 0..3 {
                let d = row.d.iter().map(|(&j, &v)| (slave.nodes[j].dofs[axis], v));
                let m = row.m.iter().map(|(&k, &v)| (master.nodes[k].dofs[axis], -v));
                store.equation(format!("node {}, {}", i + 1, AXES[axis]), d.chain(m), 0.0);
            }
        }
        Ok(())
    }
}
