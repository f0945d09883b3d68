//! Mortar ties of lines or surfaces: `sum_j D_ij u_j - sum_k M_ik u_k = 0` with `D_ij = int Phi_i N_j` and `M_ik = int Phi_i N_k`. `Phi_i`
//! are the functions of the multipliers, `N_j` the shape functions of the slave side, `N_k` those of the master side.
//!
//! The method is that of Puso, Int. J. Numer. Meth. Engng, 2004. Segments are as in Popp, Gitterle, Gee and Wall, ibid., 2010; pieces of
//! quadratic facets as in Puso, Laursen and Solberg, Comput. Methods Appl. Mech. Engng, 2008.

mod cover;
mod matrices;
mod segment;

use std::collections::BTreeMap;

use rayon::prelude::*;

use crate::geometry::node::field_of_node;
use crate::geometry::search::FaceSearch;
use crate::geometry::shape::Shape;
use crate::geometry::surface::{Surface, SurfaceError};
use crate::{Constraint, EquationSink};

/// The functions `Phi_i` of the multipliers of a mortar tie, one for each slave node.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Multipliers {
    /// The shape functions of the slave side, `Phi_i = N_i`. D is a mass matrix: each slave depends on all masters,
    /// with weights that decay with distance.
    #[default]
    Standard,
    /// Dual functions. On linear facets they are biorthogonal to the shape functions, `int Phi_i N_j = 0` for `i != j`. Then
    /// D is diagonal, and a slave node depends only on the masters opposite its own facets. On quadratic facets, the row of
    /// a mid-edge node also contains the corners of its edge, so this node also depends on the masters opposite the facets
    /// of those corners.
    Dual,
}

/// Ties two meshes of one line or surface weakly, by integrals: `sum_j D_ij u_j - sum_k M_ik u_k = 0`, with F fields in
/// D dimensions. The nodes need not match.
///
/// `D_ij = int Phi_i N_j` and `M_ik = int Phi_i N_k`, with the functions `N_j` of the slave side, `N_k` of the master
/// side and `Phi_i` of the multipliers ([`Multipliers`]). Each node i of a slave facet has one equation per field.
///
/// The integrals go over segments: overlaps of a slave and a master facet, seen along the normal of the mean plane of
/// the slave facet (perpendicular to its chord for lines). Areas are measured in that plane. D and M use the same
/// segments, so that each row sums to zero. Entries that are only rounding are left out. On a flat interface, linear
/// fields satisfy the tie for all shapes, and a constant stress is transmitted. The quadrature has degree five on each
/// piece: it is exact for lines, Tri3, Tri6 with straight edges and Quad4 that are parallelograms. For a Quad4
/// distorted by a tenth of its size, the error is below 4e-5 of the largest entry; for a fifth, below 1e-3. The errors
/// of D and M cancel in each row sum, and do not depend on the orientation of the model. Cost for n facets per side:
/// O(n log n).
///
#[doc = include_str!("../../../docs/pictures/mortar_tie.svg")]
///
#[doc = include_str!("../../../docs/types/mortar_tie.md")]
/// # Example
///
/// ```
/// use qless_constraints::{ConstraintSet, types::{MortarTie, Multipliers, Node, Surface}};
/// // Temperatures on a line of two elements and a line of three.
/// let line = |first: usize, at: &[f64]| {
///     Surface::polyline(at.iter().enumerate().map(|(i, &x)| Node::of_field(first + i, [x, 0.0])).collect())
/// };
/// let (slave, master) = (line(0, &[0.0, 1.0, 2.0]), line(3, &[0.0, 0.5, 1.25, 2.0]));
/// let mut builder = ConstraintSet::builder(7);
/// builder.add("interface", MortarTie { slave, master, multipliers: Multipliers::Dual, tolerance: 1e-9 })?;
/// let set = builder.build()?;
/// // A linear temperature satisfies all equations.
/// let mut evaluation = set.allocate();
/// set.evaluate(&[0.0, 1.0, 2.0, 0.0, 0.5, 1.25, 2.0], &mut evaluation)?;
/// assert!(evaluation.c().iter().all(|c| c.abs() < 1e-15));
/// // With dual multipliers, each row has a single slave node.
/// assert_eq!(evaluation.g().row(0).filter(|&(dof, _)| dof < 3).count(), 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct MortarTie<const D: usize, const F: usize = D> {
    /// The side with the multipliers.
    pub slave: Surface<D, F>,
    /// The side without multipliers.
    pub master: Surface<D, F>,
    /// The functions `Phi_i` of the multipliers.
    pub multipliers: Multipliers,
    /// Largest gap between the sides, a length. A slave facet may also have an uncovered border of this width, if the border is at most
    /// half of the facet.
    pub tolerance: f64,
}

impl<const D: usize, const F: usize> MortarTie<D, F> {
    /// The rows of the mortar matrices D and M, by slave nodes.
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

    fn emit(self, sink: &mut EquationSink) -> Result<(), MortarError> {
        self.check()?;
        let (slave, master) = (&self.slave.nodes, &self.master.nodes);
        for (i, row) in self.rows()? {
            for k in 0..F {
                let d = row.slaves().map(|(j, v)| (slave[j].dofs[k], v));
                let m = row.masters().map(|(j, v)| (master[j].dofs[k], v));
                sink.equation(field_of_node::<D, F>(i, k), d.chain(m), 0.0);
            }
        }
        Ok(())
    }
}

/// What can be wrong with a mortar tie.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MortarError {
    /// A side is not a valid surface.
    #[error("{side} side: {source}")]
    Surface {
        /// "slave" or "master".
        side: &'static str,
        /// What is wrong with this side.
        source: SurfaceError,
    },
    /// A facet has a wrong dimension.
    #[error(
        "facet {facet}, from 1, of the {side} side is a {shape:?}; both sides must consist of lines, or in space of faces"
    )]
    Dimension {
        /// "slave" or "master".
        side: &'static str,
        /// Number of the facet, counted from 1.
        facet: usize,
        /// Shape of the facet.
        shape: Shape,
    },
    /// A facet has no size, or is not convex.
    #[error("facet {facet}, from 1, of the {side} side has no area, or is not convex; correct it")]
    Facet {
        /// "slave" or "master".
        side: &'static str,
        /// Number of the facet, counted from 1.
        facet: usize,
    },
    /// A part of a slave facet has no master facet within the tolerance.
    #[error(
        "no master facet lies within the tolerance {tolerance} over {bare} of the size {size} of slave facet {facet}, from 1; {}",
        cover_advice(*gap)
    )]
    NotCovered {
        /// Number of the slave facet, counted from 1.
        facet: usize,
        /// The uncovered area or length.
        bare: f64,
        /// Size of the facet, or of a piece of a quadratic facet.
        size: f64,
        /// Largest allowed gap.
        tolerance: f64,
        /// The smallest gap, of those above the tolerance, to a master facet that lies opposite; `None` if there is no such facet.
        gap: Option<f64>,
    },
    /// Several master facets cover the same place.
    #[error(
        "master facets cover {covered}, more than the size {size} of slave facet {facet}, from 1: \
         remove facets that are listed twice or lie behind others"
    )]
    Overlap {
        /// Number of the slave facet, counted from 1.
        facet: usize,
        /// The sum of the areas or lengths of all overlaps with master facets.
        covered: f64,
        /// Size of the facet, or of a piece of a quadratic facet.
        size: f64,
    },
}

/// Advice for a facet that is not covered.
fn cover_advice(gap: Option<f64>) -> String {
    match gap {
        Some(gap) => {
            format!("the nearest facet beyond the tolerance is {gap} away: bring the sides together, or raise the tolerance")
        }
        None => {
            "no master facet lies opposite that part: extend the master side, shorten the slave side, or exchange the two".to_owned()
        }
    }
}
