//! Loops over much memory, shared by all threads of the caller's pool; short ones stay on the thread that asks.

use rayon::prelude::*;

/// Fewer rows or DOFs than this are not worth a thread of their own.
pub(crate) const WORTH_A_THREAD: usize = 1 << 17;

/// `values[at[k]]`.
pub(crate) fn gather(values: &[u32], at: &[u32]) -> Vec<u32> {
    let value = |&j: &u32| values[j as usize];
    if at.len() < WORTH_A_THREAD { at.iter().map(value).collect() } else { at.par_iter().map(value).collect() }
}

/// Does each piece of work, one alone without asking the pool.
pub(crate) fn each<T: Send>(work: Vec<T>, job: impl Fn(T) + Send + Sync) {
    match work.len() {
        0 | 1 => work.into_iter().for_each(job),
        _ => work.into_par_iter().for_each(job),
    }
}
