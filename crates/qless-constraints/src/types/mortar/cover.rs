//! The segments of each slave facet (overlaps with master facets), and the check that the master side covers the facet exactly once.

use super::segment::{FacetPiece, MortarSegment};
use super::{MortarError, MortarTie};
use crate::geometry::node::{rounding, within};
use crate::geometry::search::FaceSearch;
use crate::geometry::surface::Surface;
use crate::scalar::HALF_DIGITS;
use crate::scalar::vector::Vector;

/// The segments of a slave facet, each with the index of its master facet.
pub(super) type FacetSegments = Vec<(usize, MortarSegment)>;

/// Coordinates of the nodes of a facet, in space.
fn places<const D: usize, const F: usize>(surface: &Surface<D, F>, facet: usize) -> Vec<Vector<f64>> {
    const { assert!(D == 2 || D == 3, "a mortar tie lies in the plane or in space") };
    let lift = |at: [f64; D]| std::array::from_fn(|k| if k < D { at[k] } else { 0.0 });
    surface.places(facet).into_iter().map(lift).collect()
}

impl<const D: usize, const F: usize> MortarTie<D, F> {
    /// Checks that both sides are valid surfaces, with facets of the same dimension.
    pub(super) fn check(&self) -> Result<(), MortarError> {
        for (side, surface) in [("slave", &self.slave), ("master", &self.master)] {
            surface.check_integrable().map_err(|source| MortarError::Surface { side, source })?;
            for (facet, face) in surface.faces.iter().enumerate() {
                let dimension = face.shape.dimensions();
                if dimension >= D || dimension != self.slave.faces[0].shape.dimensions() {
                    return Err(MortarError::Dimension { side, facet: facet + 1, shape: face.shape });
                }
                if FacetPiece::all(face.shape, &places(surface, facet)).is_none() {
                    return Err(MortarError::Facet { side, facet: facet + 1 });
                }
            }
        }
        Ok(())
    }

    /// The segments of one slave facet.
    pub(super) fn segments(&self, facet: usize, search: &FaceSearch<D, F>) -> Result<FacetSegments, MortarError> {
        let shape = self.slave.faces[facet].shape;
        let places = self.slave.places(facet);
        let near = search.faces_near(shape, &places, self.tolerance);
        let mut segments = Vec::new();
        for piece in self.pieces(facet) {
            let first = segments.len();
            let overlaps =
                near.iter().flat_map(|&master| self.overlaps(&piece, master).map(move |segment| (master, segment)));
            segments.extend(overlaps.filter(|(master, segment)| self.is_near(segment, &places, *master)));
            let covered = segments[first..].iter().map(|(_, segment)| segment.size).sum();
            self.check_cover(facet + 1, &piece, covered)?;
        }
        Ok(segments)
    }

    /// Whether the gap of a segment is at most the tolerance plus the rounding of the coordinates.
    fn is_near(&self, segment: &MortarSegment, slave: &[[f64; D]], master: usize) -> bool {
        let blur = slave.iter().fold(0.0, |most: f64, place| most.max(rounding(&self.master.places(master), place)));
        within(segment.gap - blur, self.tolerance)
    }

    fn pieces(&self, facet: usize) -> Vec<FacetPiece> {
        FacetPiece::all(self.slave.faces[facet].shape, &places(&self.slave, facet)).unwrap_or_default()
    }

    /// The overlaps of a piece of a slave facet with a master facet, however large the gap between them.
    fn overlaps(&self, piece: &FacetPiece, master: usize) -> impl Iterator<Item = MortarSegment> + use<D, F> {
        piece.segments(self.master.faces[master].shape, &places(&self.master, master)).into_iter()
    }

    fn check_cover(&self, facet: usize, piece: &FacetPiece, covered: f64) -> Result<(), MortarError> {
        let (size, tolerance) = (piece.outline.size(), self.tolerance);
        let bare = size - covered;
        // Even a large tolerance allows at most half of the piece to be uncovered.
        let allowed = (tolerance * piece.outline.border()).min(size / 2.0) + HALF_DIGITS * size;
        if within(bare.abs(), allowed) {
            Ok(())
        } else if bare < 0.0 {
            Err(MortarError::Overlap { facet, covered, size })
        } else {
            Err(MortarError::NotCovered { facet, bare, size, tolerance, gap: None })
        }
    }

    /// Adds the smallest gap beyond the tolerance to the error. This searches all master facets, which is too slow unless there is an
    /// error.
    pub(super) fn with_gap(&self, error: MortarError) -> MortarError {
        let MortarError::NotCovered { facet, bare, size, tolerance, .. } = error else { return error };
        let masters = || 0..self.master.faces.len();
        let pieces = self.pieces(facet - 1);
        let gaps = pieces.iter().flat_map(|piece| masters().flat_map(|master| self.overlaps(piece, master)));
        let gap = gaps.map(|segment| segment.gap).filter(|&gap| !within(gap, tolerance)).min_by(f64::total_cmp);
        MortarError::NotCovered { facet, bare, size, tolerance, gap }
    }
}
