//! `sum_j D_ij u_j - sum_k M_ik u_k = 0`, `D_ij = int Phi_i N_j`, `M_ik = int Phi_i N_k`: a tie of lines or surfaces in the mean.
//!
//! Puso, Int. J. Numer. Meth. Engng, 2004; with segments as in Popp, Gitterle, Gee and Wall, ibid., 2010;
//! quadratic facets by parts as in Puso, Laursen and Solberg, Comput. Methods Appl. Mech. Engng, 2008.

mod cover;
mod matrices;
mod segment;

use std::collections::BTreeMap;

use rayon::prelude::*;

use crate::geometry::node::field_of_node;
use crate::geometry::search::FaceSearch;
use crate::geometry::shape::Shape;
use crate::geometry::surface::{Surface, SurfaceError};
use crate::{Constraint, Store};

/// The functions `Phi_i` of the multipliers of a mortar tie, one for each node of the slave side.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Multipliers {
    /// Those of the slave side, `Phi_i = N_i`. D is a mass matrix: each slave depends on all masters, the less the farther they are.
    #[default]
    Standard,
    /// Biorthogonal to those of the slave side, `int Phi_i N_j = 0` for `i != j`: D is diagonal, and a slave node depends on the masters
    /// over its own facets only. On quadratic facets the middle of an edge depends on those over the facets of its ends too.
    Dual,
}

/// `sum_j D_ij u_j - sum_k M_ik u_k = 0`: two meshes of one line or surface, tied in the mean, with F fields in D dimensions.
///
/// `D_ij = int Phi_i N_j` and `M_ik = int Phi_i N_k` with the functions `N_j` of the slave side, `N_k` of the master side and
/// `Phi_i` of the multipliers ([`Multipliers`]). One equation for each node i of a slave facet and each field, in the unit of a length
/// (lines) or an area (faces) times that of u; as many DOFs are removed. Rank is lost where a slave node is constrained otherwise, as
/// at the ends of two interfaces that meet, or where the slave side names a master node.
///
/// The integrals go over the segments in which a slave and a master facet lie over each other, seen along the normal of the mean
/// plane of the slave facet, where areas are measured, or perpendicular to its chord; both over the same ones, so that each row sums
/// to zero. What is only rounding of these sums is left out. Fields that are linear pass on a flat surface, whatever the shapes,
/// and a constant stress is transmitted. The rule has degree five on each piece: exact for lines, Tri3, Tri6 with straight
/// edges and Quad4 that are parallelograms; for a Quad4 whose coordinates are up to a tenth of its size off, entries are within 4e-5 of
/// the largest, for a fifth within 1e-3. The error is the same in D and in M, and turns with the model.
/// With n facets on a side near each other the cost is O(n log n).
///
#[doc = include_str!("../../../docs/pictures/mortar_tie.svg")]
///
#[doc = include_str!("../../../docs/types/mortar_tie.md")]
/// # Example
///
/// ```
/// use qless_constraints::{ConstraintSet, types::{MortarTie, Multipliers, Node, Surface}};
/// // Temperatures of a line of two elements, and of one of three.
/// let line = |first: usize, at: &[f64]| {
///     Surface::polyline(at.iter().enumerate().map(|(i, &x)| Node::of_field(first + i, [x, 0.0])).collect())
/// };
/// let (slave, master) = (line(0, &[0.0, 1.0, 2.0]), line(3, &[0.0, 0.5, 1.25, 2.0]));
/// let mut builder = ConstraintSet::builder(7);
/// builder.add("interface", MortarTie { slave, master, multipliers: Multipliers::Dual, tolerance: 1e-9 })?;
/// let set = builder.build()?;
/// // A temperature that is linear along the line satisfies all equations.
/// let mut quantities = set.allocate();
/// set.evaluate(&[0.0, 1.0, 2.0, 0.0, 0.5, 1.25, 2.0], &mut quantities)?;
/// assert!(quantities.c().iter().all(|c| c.abs() < 1e-15));
/// // Of the slaves, each row has its own node only.
/// assert_eq!(quantities.g().row(0).filter(|&(dof, _)| dof < 3).count(), 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct MortarTie<const D: usize, const F: usize = D> {
    /// The side that carries the multipliers.
    pub slave: Surface<D, F>,
    /// The other side.
    pub master: Surface<D, F>,
    /// `Phi_i`.
    pub multipliers: Multipliers,
    /// Farthest that the sides may be apart, a length; also how wide a border of a slave facet may have no master facet, up to half
    /// of its size.
    pub tolerance: f64,
}

impl<const D: usize, const F: usize> MortarTie<D, F> {
    /// The rows of D and M, by slave nodes.
    fn rows(&self) -> Result<BTreeMap<usize, matrices::MortarRow>, MortarError> {
        let search = FaceSearch::new(&self.master).map_err(|source| MortarError::Surface { side: "master", source })?;
        let facets = 0..self.slave.faces.len();
        let facets: Vec<_> = facets.into_par_iter().map(|facet| self.segments(facet, &search)).collect();
        let mut rows = BTreeMap::new();
        for (number, (face, segments)) in self.slave.faces.iter().zip(facets).enumerate() {
            let segments = segments.map_err(|error| self.with_gap(error))?;
            matrices::add_facet(&mut rows, self.multipliers, face, &self.master.faces, &segments)
                .ok_or(MortarError::Facet { side: "slave", facet: number + 1 })?;
        }
        Ok(rows)
    }
}

impl<const D: usize, const F: usize> Constraint for MortarTie<D, F> {
    const NAME: &'static str = "mortar tie";
    type Error = MortarError;

    fn process(self, store: &mut Store) -> Result<(), MortarError> {
        self.check()?;
        let (slave, master) = (&self.slave.nodes, &self.master.nodes);
        for (i, row) in self.rows()? {
            for k in 0..F {
                let d = row.slaves().map(|(j, v)| (slave[j].dofs[k], v));
                let m = row.masters().map(|(j, v)| (master[j].dofs[k], v));
                store.equation(field_of_node::<D, F>(i, k), d.chain(m), 0.0);
            }
        }
        Ok(())
    }
}

/// What can be wrong with a mortar tie.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MortarError {
    /// A side is not a surface.
    #[error("{side} side: {source}")]
    Surface {
        /// "slave" or "master".
        side: &'static str,
        /// What is wrong with it.
        source: SurfaceError,
    },
    /// A facet has another dimension than it must have.
    #[error(
        "facet {facet}, from 1, of the {side} side is a {shape:?}; the facets of both sides must be lines, or in space all faces"
    )]
    Dimension {
        /// "slave" or "master".
        side: &'static str,
        /// The facet, from 1.
        facet: usize,
        /// What it is.
        shape: Shape,
    },
    /// A facet has no size or a corner that points inwards.
    #[error("facet {facet}, from 1, of the {side} side has no area, or points inwards at a corner; correct it")]
    Facet {
        /// "slave" or "master".
        side: &'static str,
        /// The facet, from 1.
        facet: usize,
    },
    /// Part of a slave facet has no master facet over it, or only one that is too far away.
    #[error(
        "no master facet lies within the tolerance {tolerance} over {bare} of the size {size} of slave facet {facet}, from 1; {}",
        beyond(*gap)
    )]
    NotCovered {
        /// The slave facet, from 1.
        facet: usize,
        /// The area or length without a master facet.
        bare: f64,
        /// That of the facet, or of the part of a quadratic one.
        size: f64,
        /// How far the sides may be apart.
        tolerance: f64,
        /// How far the nearest master facet is that lies over the facet beyond the tolerance, if one does.
        gap: Option<f64>,
    },
    /// Several master facets lie over the same place.
    #[error(
        "master facets lie over {covered}, more than the size {size} of slave facet {facet}, from 1: \
         take out those that are there twice or lie behind others"
    )]
    Overlap {
        /// The slave facet, from 1.
        facet: usize,
        /// The sum of the areas or lengths of the segments.
        covered: f64,
        /// That of the facet, or of the part of a quadratic one.
        size: f64,
    },
}

/// What to do about a facet that is not covered.
fn beyond(gap: Option<f64>) -> String {
    match gap {
        Some(gap) => format!("one that lies over it is {gap} away: bring the sides together, or raise the tolerance"),
        None => "nothing lies over it: extend the master side, shorten the slave side, or exchange the two".to_owned(),
    }
}
