//! `c(u)`, `G(u)` and `H(u, w)`: all types in one list of tasks, each with its own part of the arrays, so that threads wait for one
//! another once.
//!
//! Tasks are taken in the order of their last DOFs: those of all types that read the same part of u follow one another, while it is in
//! a cache, and rare types, whose tasks reach far, come when others have read it.

use qless::Csr;
use rayon::prelude::*;

use super::batch::Batch;
use super::block::Block;
use super::chunk::Chunk;
use super::effective::Weighted;
use super::linear::Rows;
use super::sums::NUMBERS;

/// DOFs of a configuration that one task copies.
const COPIED: usize = 1 << 15;

/// What one thread does at a time.
pub(super) struct Task<'a> {
    /// The last DOF that it reads, or nearly so.
    pub dof: u32,
    pub work: Work<'a>,
}

/// What is written, and where.
pub(super) enum Work<'a> {
    /// c of a batch of linear equations.
    Linear { batch: &'a Batch, c: &'a mut [f64] },
    /// c and G of constraints of a block.
    Nonlinear { block: &'a dyn Block, c: &'a mut [f64], g: &'a mut [f64] },
    /// Keeps the configuration.
    Copy { u: &'a [f64], to: &'a mut [f64] },
    /// Rows of H.
    Hessian { chunk: &'a Chunk, weighted: &'a Weighted<'a>, h: &'a mut [f64] },
}

/// The tasks that write c and the rows of G that depend on u.
pub(super) fn of_values<'a>(
    linear: &'a Rows,
    blocks: &'a [Box<dyn Block>],
    c: &'a mut [f64],
    g: &'a mut Csr,
) -> Vec<Task<'a>> {
    let (mut of_linear, c) = c.split_at_mut(linear.rows());
    let mut tasks = nonlinear(blocks, c, &mut g.values_mut()[linear.nnz()..]);
    for batch in &linear.batches {
        let c;
        (c, of_linear) = of_linear.split_at_mut(batch.rows());
        tasks.push(Task { dof: batch.first_dof(), work: Work::Linear { batch, c } });
    }
    tasks
}

fn nonlinear<'a>(blocks: &'a [Box<dyn Block>], mut c: &'a mut [f64], mut g: &'a mut [f64]) -> Vec<Task<'a>> {
    let mut tasks = Vec::new();
    for block in blocks {
        let (own_c, own_g);
        (own_c, c) = c.split_at_mut(block.rows());
        (own_g, g) = g.split_at_mut(block.nnz());
        let work = Work::Nonlinear { block: block.as_ref(), c: own_c, g: own_g };
        tasks.push(Task { dof: block.last_dof(), work });
    }
    tasks
}

/// The tasks that keep u, beside those that read it; a short one is copied at once.
pub(super) fn of_copies<'a>(u: &'a [f64], to: &'a mut [f64]) -> Vec<Task<'a>> {
    if u.len() <= COPIED {
        to.copy_from_slice(u);
        return Vec::new();
    }
    let parts = u.chunks(COPIED).zip(to.chunks_mut(COPIED)).enumerate();
    parts.map(|(k, (u, to))| Task { dof: (k * COPIED) as u32, work: Work::Copy { u, to } }).collect()
}

/// Does all of them.
pub(super) fn run(mut tasks: Vec<Task>, u: &[f64]) {
    tasks.sort_by_key(|task| task.dof);
    // The numbers of one chunk of H, in an array that serves one chunk after another and stays in the cache of a core.
    tasks.into_par_iter().for_each_init(Vec::new, |numbers, task| match task.work {
        Work::Linear { batch, c } => batch.evaluate(u, c),
        Work::Nonlinear { block, c, g } => block.evaluate(u, c, g),
        Work::Copy { u, to } => to.copy_from_slice(u),
        Work::Hessian { chunk, weighted, h } => {
            numbers.resize(numbers.len().max(NUMBERS), 0.0);
            chunk.write(weighted, u, numbers, h);
        }
    });
}
