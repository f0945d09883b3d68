//! `c(u)` and `G(u)`: all types in one list of tasks, each with its own part of the arrays, so that threads wait for one another once.
//!
//! Tasks are taken in the order of their DOFs: those of all types that read the same part of u follow one another, while it is in a cache.

use qless::Csr;
use rayon::prelude::*;

use super::Quantities;
use super::batch::ROWS;
use super::block::{Block, CHUNK};
use super::linear::Rows;

/// What one thread does at a time.
struct Task<'a> {
    /// None for linear equations.
    block: Option<&'a dyn Block>,
    /// The batch of equations, or the first constraint of the block.
    first: usize,
    /// A DOF that it reads.
    dof: u32,
    c: &'a mut [f64],
    g: &'a mut [f64],
}

/// Writes c and the rows of G that depend on u.
pub fn evaluate(linear: &Rows, blocks: &[Box<dyn Block>], u: &[f64], quantities: &mut Quantities) {
    let Quantities { c, g: Csr { val, .. }, .. } = quantities;
    let (of_linear, c) = c.split_at_mut(linear.rows());
    let mut tasks = nonlinear(blocks, c, &mut val[linear.nnz()..]);
    debug_assert_eq!(linear.batches(), of_linear.len().div_ceil(ROWS));
    let batch = |(first, c)| Task { block: None, first, dof: linear.first_dof(first), c, g: &mut [] };
    tasks.extend(of_linear.chunks_mut(ROWS).enumerate().map(batch));
    tasks.sort_by_key(|task| task.dof);
    tasks.into_par_iter().for_each(|task| match task.block {
        Some(block) => block.evaluate(task.first, u, task.c, task.g),
        None => linear.evaluate(task.first, u, task.c),
    });
}

fn nonlinear<'a>(blocks: &'a [Box<dyn Block>], mut c: &'a mut [f64], mut g: &'a mut [f64]) -> Vec<Task<'a>> {
    let mut tasks = Vec::new();
    for block in blocks {
        for first in (0..block.items()).step_by(CHUNK) {
            let (rows, nnz) = block.task(first);
            let (own_c, own_g);
            (own_c, c) = c.split_at_mut(rows);
            (own_g, g) = g.split_at_mut(nnz);
            tasks.push(Task { block: Some(block.as_ref()), first, dof: block.first_dof(first), c: own_c, g: own_g });
        }
    }
    tasks
}
