//! What can be wrong with the two sides of a mortar tie.

use crate::geometry::shape::Shape;
use crate::geometry::surface::SurfaceError;

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
