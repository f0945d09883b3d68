//! Evaluation of `c(u)`, `G(u)` and the Hessian numbers as one list of parallel tasks, each of which writes its own slices of the arrays.

use std::ops::Range;

use qless::Csr;
use rayon::prelude::*;

use crate::equations::linear::LinearEquations;
use crate::equations::nonlinear::NonlinearBatch;

/// Largest number of linear equations, or of nonlinear items, that one task evaluates.
const AT_ONCE: usize = 1024;

/// A piece of work with the slices that it writes.
pub type EvaluationTask<'a> = Box<dyn FnOnce() + Send + 'a>;

/// Runs all tasks in parallel.
pub fn run_tasks(tasks: Vec<EvaluationTask>) {
    tasks.into_par_iter().for_each(|task| task());
}

/// Cuts `0..count` into ranges of at most [`AT_ONCE`].
fn ranges(count: usize) -> impl Iterator<Item = Range<usize>> {
    (0..count).step_by(AT_ONCE).map(move |first| first..count.min(first + AT_ONCE))
}

/// Makes one task for each range of linear rows, which calls `of_linear(rows, c)`, and one for each range of items, which calls
/// `of_items(batch, items, c, G)`.
pub fn value_tasks<'a>(
    (linear, batches): (&LinearEquations, &'a [Box<dyn NonlinearBatch>]),
    (c, g): (&'a mut [f64], &'a mut Csr),
    of_linear: impl Fn(Range<usize>, &mut [f64]) + Send + Copy + 'a,
    of_items: impl Fn(&dyn NonlinearBatch, Range<usize>, &mut [f64], &mut [f64]) + Send + Copy + 'a,
) -> Vec<EvaluationTask<'a>> {
    let (mut tasks, mut c, mut g): (Vec<EvaluationTask>, _, _) =
        (Vec::new(), c, &mut g.values_mut()[linear.col.len()..]);
    for rows in ranges(linear.rows()) {
        let own = c.split_off_mut(..rows.len()).unwrap_or_default();
        tasks.push(Box::new(move || of_linear(rows, own)));
    }
    for batch in batches {
        let rows = batch.equations_per_item();
        for items in ranges(batch.items()) {
            let own_c = c.split_off_mut(..rows * items.len()).unwrap_or_default();
            let own_g = g.split_off_mut(..rows * batch.width(items.clone())).unwrap_or_default();
            tasks.push(Box::new(move || of_items(batch.as_ref(), items, own_c, own_g)));
        }
    }
    tasks
}

/// The tasks that write the numbers of [`crate::Nonlinear::hessian`] for all items; `weights` are those of all nonlinear equations.
pub fn number_tasks<'a>(
    batches: &'a [Box<dyn NonlinearBatch>],
    u: &'a [f64],
    weights: &'a [f64],
    numbers: &'a mut [f64],
) -> Vec<EvaluationTask<'a>> {
    let (mut tasks, mut w, mut rest): (Vec<EvaluationTask>, _, _) = (Vec::new(), weights, numbers);
    for batch in batches {
        for items in ranges(batch.items()) {
            let of_items;
            (of_items, w) = w.split_at(batch.equations_per_item() * items.len());
            let own = rest.split_off_mut(..batch.numbers(items.clone())).unwrap_or_default();
            tasks.push(Box::new(move || batch.curvatures(items, u, of_items, own)));
        }
    }
    tasks
}
