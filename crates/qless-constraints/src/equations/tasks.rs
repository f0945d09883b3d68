//! Evaluation of `c(u)`, `G(u)` and `H(u, w)` as one list of parallel tasks, each of which writes its own slices of the arrays.
//!
//! Tasks are sorted by the last DOF that they read. Tasks of different types that read the same part of u then run close together, while
//! that part is in a cache. With one list for everything, threads wait for each other only once.

use qless::Csr;
use rayon::prelude::*;

use crate::equations::hessian::HessianPlan;
use crate::equations::hessian::chunk::{HessianChunk, WeightedBatches};
use crate::equations::hessian::sums::NUMBERS;
use crate::equations::linear::LinearEquations;
use crate::equations::linear::batch::LinearBatch;
use crate::equations::nonlinear::batch::NonlinearBatch;

/// Number of DOFs that one task copies.
const COPIED: usize = 1 << 15;

/// The work of one thread at a time.
pub struct EvaluationTask<'a> {
    /// The last DOF that the task reads, approximately.
    pub dof: u32,
    pub work: TaskOutput<'a>,
}

/// The work of a task, with the slices that it writes.
pub enum TaskOutput<'a> {
    /// c of a batch of linear equations.
    Linear { batch: &'a LinearBatch, c: &'a mut [f64] },
    /// c and G of a batch of nonlinear equations.
    Nonlinear { batch: &'a dyn NonlinearBatch, c: &'a mut [f64], g: &'a mut [f64] },
    /// A copy of u, kept with the results.
    Copy { u: &'a [f64], to: &'a mut [f64] },
    /// Rows of H.
    Hessian { chunk: &'a HessianChunk, weighted: &'a WeightedBatches<'a>, h: &'a mut [f64] },
}

/// The tasks that write c and the nonlinear rows of G.
pub fn value_tasks<'a>(
    linear: &'a LinearEquations,
    batches: &'a [Box<dyn NonlinearBatch>],
    c: &'a mut [f64],
    g: &'a mut Csr,
) -> Vec<EvaluationTask<'a>> {
    let (mut of_linear, c) = c.split_at_mut(linear.rows());
    let mut tasks = nonlinear(batches, c, &mut g.values_mut()[linear.nnz()..]);
    for batch in &linear.batches {
        let c;
        (c, of_linear) = of_linear.split_at_mut(batch.rows());
        tasks.push(EvaluationTask { dof: batch.base, work: TaskOutput::Linear { batch, c } });
    }
    tasks
}

fn nonlinear<'a>(
    batches: &'a [Box<dyn NonlinearBatch>],
    mut c: &'a mut [f64],
    mut g: &'a mut [f64],
) -> Vec<EvaluationTask<'a>> {
    let mut tasks = Vec::new();
    for batch in batches {
        let (own_c, own_g);
        (own_c, c) = c.split_at_mut(batch.rows());
        (own_g, g) = g.split_at_mut(batch.nnz());
        let work = TaskOutput::Nonlinear { batch: batch.as_ref(), c: own_c, g: own_g };
        tasks.push(EvaluationTask { dof: batch.last_dof(), work });
    }
    tasks
}

/// The tasks that copy u. A short u is copied at once.
pub fn copy_tasks<'a>(u: &'a [f64], to: &'a mut [f64]) -> Vec<EvaluationTask<'a>> {
    if u.len() <= COPIED {
        to.copy_from_slice(u);
        return Vec::new();
    }
    let parts = u.chunks(COPIED).zip(to.chunks_mut(COPIED)).enumerate();
    parts.map(|(k, (u, to))| EvaluationTask { dof: (k * COPIED) as u32, work: TaskOutput::Copy { u, to } }).collect()
}

/// Runs all tasks in parallel.
pub fn run_tasks(mut tasks: Vec<EvaluationTask>, u: &[f64]) {
    tasks.sort_by_key(|task| task.dof);
    // Each thread reuses one array for the Hessian numbers of a chunk, so that it stays in the cache of its core.
    tasks.into_par_iter().for_each_init(Vec::new, |numbers, task| match task.work {
        TaskOutput::Linear { batch, c } => batch.evaluate(u, c),
        TaskOutput::Nonlinear { batch, c, g } => batch.evaluate(u, c, g),
        TaskOutput::Copy { u, to } => to.copy_from_slice(u),
        TaskOutput::Hessian { chunk, weighted, h } => {
            numbers.resize(numbers.len().max(NUMBERS), 0.0);
            chunk.write(weighted, u, numbers, h);
        }
    });
}

/// The tasks that write all entries of H.
pub fn hessian_tasks<'a>(
    plan: &'a HessianPlan,
    weighted: &'a WeightedBatches,
    out: &'a mut [f64],
) -> Vec<EvaluationTask<'a>> {
    let mut rest = out;
    let own = |chunk: &'a HessianChunk| {
        let h = rest.split_off_mut(..chunk.entries()).unwrap_or_default();
        EvaluationTask { dof: chunk.rows.end.saturating_sub(1), work: TaskOutput::Hessian { chunk, weighted, h } }
    };
    plan.chunks.iter().map(own).collect()
}
