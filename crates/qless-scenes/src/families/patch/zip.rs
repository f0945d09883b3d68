//! Triangles between two lines of nodes side by side, of which each has its own spacing.

use super::PatchFace;

/// A node and its place along the line.
type ZipPosition = (usize, f64);

/// The strip between two lines with ascending places: always on to the node that comes first.
pub(in super::super) fn zip(one: &[ZipPosition], other: &[ZipPosition]) -> Vec<PatchFace> {
    let (mut i, mut j) = (0, 0);
    let mut faces = Vec::with_capacity(one.len() + other.len());
    while i + 1 < one.len() || j + 1 < other.len() {
        let next = |line: &[ZipPosition], k: usize| line.get(k + 1).map_or(f64::INFINITY, |place| place.1);
        if next(one, i) <= next(other, j) {
            faces.push(PatchFace::Triangle([one[i].0, one[i + 1].0, other[j].0]));
            i += 1;
        } else {
            faces.push(PatchFace::Triangle([one[i].0, other[j + 1].0, other[j].0]));
            j += 1;
        }
    }
    faces
}
