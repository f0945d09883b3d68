//! Vector-valued incidence matrices: `A_e u_a + B_e u_b = 0` for each edge of a grid, with d x d blocks.

use qless::SystemBuilder;

use super::MOST;
use crate::error::within;
use crate::{Rng, Scene, SceneError, Truth};

/// The edges x nodes matrix of an nx x ny x nz grid (nz = 1 for 2-D), with d rows per edge and d DOFs per node.
///
/// For d = 1 the coefficients are +1 and -1, and the rank is nodes - 1. Otherwise all entries of the blocks are random in
/// `-1..1`. With probability one the rank is then d nodes if the grid has a cycle, and d (nodes - 1) if it is a line.
///
/// Two sizes for benchmarks: `[128, 128, 1]` with d = 3 gives 97,536 x 49,152; `[16, 16, 16]` with d = 3
/// gives 34,560 x 12,288.
///
/// # Errors
/// [`SceneError::Size`] for a grid of fewer than 2 nodes or for d = 0.
pub fn gradient(extent: [usize; 3], d: usize, seed: u64) -> Result<Scene, SceneError> {
    let [nx, ny, nz] = extent;
    extent.into_iter().try_for_each(|n| within("a side of the grid", n, 1, 1 << 13))?;
    within("the number of nodes", nx * ny * nz, 2, MOST)?;
    within("d", d, 1, 100)?;
    let nodes = nx * ny * nz;
    let mut rng = Rng::new(seed);
    let mut builder = SystemBuilder::new(d * nodes);
    let mut equations = 0;
    for (a, b) in edges(extent) {
        for row in block_rows(a, b, d, &mut rng) {
            builder.equation(row, 0.0);
            equations += 1;
        }
    }
    let full = d > 1 && equations / d >= nodes;
    let rank = if full { d * nodes } else { d * (nodes - 1) };
    Scene::bare(builder, Truth::rank(equations, rank))
}

/// The d equations of one edge.
fn block_rows(a: usize, b: usize, d: usize, rng: &mut Rng) -> Vec<Vec<(usize, f64)>> {
    if d == 1 {
        return vec![vec![(a, 1.0), (b, -1.0)]];
    }
    let columns = |node: usize| (0..d).map(move |j| d * node + j);
    (0..d).map(|_| columns(a).chain(columns(b)).map(|j| (j, rng.real())).collect()).collect()
}

/// Pairs of neighbours, first along x, then y, then z.
fn edges([nx, ny, nz]: [usize; 3]) -> impl Iterator<Item = (usize, usize)> {
    let strides = [1, nx, nx * ny];
    (0..3).flat_map(move |axis| {
        (0..nx * ny * nz).filter_map(move |node| {
            let place = [node % nx, node / nx % ny, node / (nx * ny)][axis];
            (place + 1 < [nx, ny, nz][axis]).then(|| (node, node + strides[axis]))
        })
    })
}
