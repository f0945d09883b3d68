//! `(i / nx, j / ny)` and a little more: rows of cells whose inner nodes are moved, whole or cut along either diagonal.

use super::PatchFace;
use crate::Rng;

/// What the elements behind a surface show of themselves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Faces {
    /// Bilinear faces, of hexahedra.
    Quads,
    /// Linear faces, of tetrahedra: cells of four nodes, each cut along a diagonal that the seed chooses.
    Triangles,
}

/// A mesh of the square `[0, 1]^2`, its nodes along s first.
#[derive(Debug)]
pub(in super::super) struct Grid {
    pub(in super::super) nodes: Vec<[f64; 2]>,
    pub(in super::super) faces: Vec<PatchFace>,
}

/// Part of a cell by which nodes move each way. Below a quarter all faces stay convex.
const MOVE: f64 = 0.2;

impl Grid {
    /// Nodes of the border move along it, corners stay.
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

/// The faces of the cell that starts with node `first`.
fn cut(first: usize, width: usize, faces: Faces, rng: &mut Rng) -> [Option<PatchFace>; 2] {
    let [a, b, c, d] = [first, first + 1, first + 1 + width, first + width];
    match faces {
        Faces::Quads => [Some(PatchFace::Quad([a, b, c, d])), None],
        Faces::Triangles if rng.below(2) == 0 => [[a, b, c], [a, c, d]].map(PatchFace::Triangle).map(Some),
        Faces::Triangles => [[a, b, d], [b, c, d]].map(PatchFace::Triangle).map(Some),
    }
}
