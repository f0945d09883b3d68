//! A grid of cells with nodes near `(i / nx, j / ny)`; cells are quadrilaterals, or pairs of triangles.

use super::PatchFace;
use crate::Rng;

/// Faces of the elements at a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Faces {
    /// Bilinear quadrilaterals, the faces of hexahedra.
    Quads,
    /// Linear triangles, the faces of tetrahedra: each cell is cut along a random diagonal.
    Triangles,
}

/// A mesh of the square `[0, 1]^2`; nodes are numbered along s first.
#[derive(Debug)]
pub(in super::super) struct Grid {
    pub(in super::super) nodes: Vec<[f64; 2]>,
    pub(in super::super) faces: Vec<PatchFace>,
}

/// Largest random displacement of a node, relative to a cell. Below a quarter all faces stay convex.
const MOVE: f64 = 0.2;

impl Grid {
    /// A grid with randomly moved nodes. Nodes of the border move along it, corners stay.
    pub(in super::super) fn jittered(cells: [usize; 2], faces: Faces, rng: &mut Rng) -> Self {
        let [nx, ny] = cells;
        let place = |k: usize, n: usize, rng: &mut Rng| {
            let by = if k == 0 || k == n { 0.0 } else { MOVE * rng.real() };
            (k as f64 + by) / n as f64
        };
        let at = (0..=ny).flat_map(|j| (0..=nx).map(move |i| [i, j]));
        let nodes = at.map(|[i, j]| [place(i, nx, rng), place(j, ny, rng)]).collect();
        let cells = (0..ny).flat_map(|j| (0..nx).map(move |i| i + (nx + 1) * j));
        let faces = cells.flat_map(|first| cut(first, nx + 1, faces, rng)).flatten().collect();
        Self { nodes, faces }
    }
}

/// The faces of the cell whose first node is `first`.
fn cut(first: usize, width: usize, faces: Faces, rng: &mut Rng) -> [Option<PatchFace>; 2] {
    let [a, b, c, d] = [first, first + 1, first + 1 + width, first + width];
    match faces {
        Faces::Quads => [Some(PatchFace::Quad([a, b, c, d])), None],
        Faces::Triangles if rng.below(2) == 0 => [[a, b, c], [a, c, d]].map(PatchFace::Triangle).map(Some),
        Faces::Triangles => [[a, b, d], [b, c, d]].map(PatchFace::Triangle).map(Some),
    }
}

/// A node and its position along a line of nodes.
type ZipPosition = (usize, f64);

/// The triangles between two lines with ascending positions. Each step advances to the next node of either line.
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
