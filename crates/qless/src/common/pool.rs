//! Parallel loops on the caller's thread pool; short loops run on the calling thread.

use rayon::prelude::*;

/// Minimum number of rows or DOFs for one thread.
pub(crate) const WORTH_A_THREAD: usize = 1 << 17;

/// Gathers `values[at[k]]` for every k.
pub(crate) fn gather(values: &[u32], at: &[u32]) -> Vec<u32> {
    let value = |&j: &u32| values[j as usize];
    if at.len() < WORTH_A_THREAD { at.iter().map(value).collect() } else { at.par_iter().map(value).collect() }
}

/// Runs a job for each item in parallel; a single item runs on the calling thread.
pub(crate) fn each<T: Send>(work: Vec<T>, job: impl Fn(T) + Send + Sync) {
    match work.len() {
        0 | 1 => work.into_iter().for_each(job),
        _ => work.into_par_iter().for_each(job),
    }
}
