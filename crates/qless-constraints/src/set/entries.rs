//! How many entries constraints have in each row of H, counted by all threads.

use std::ops::Range;
use std::slice;

use rayon::prelude::*;

use super::block::Block;

/// Threads that count: each has an array of its own, of as many rows as its constraints reach.
const MOST: usize = 8;

/// By row; sums of whole numbers, whoever counts.
pub(super) fn of_rows(blocks: &[Box<dyn Block>], dofs: usize) -> Vec<u32> {
    let threads = rayon::current_num_threads().min(MOST);
    let parts = blocks.par_chunks(blocks.len().div_ceil(threads).max(1)).map(of_part).collect::<Vec<_>>();
    let mut all = vec![0; dofs];
    for (first, counts) in parts {
        all[first as usize..].iter_mut().zip(counts).for_each(|(sum, count)| *sum += count);
    }
    all
}

/// The first row that these have entries in, and the counts from there on.
fn of_part(blocks: &[Box<dyn Block>]) -> (u32, Vec<u32>) {
    let hull = |a: Range<u32>, b: Range<u32>| a.start.min(b.start)..a.end.max(b.end);
    let rows = blocks.iter().map(|block| block.reach()).reduce(hull).unwrap_or_default();
    let mut counts = vec![0; rows.len()];
    blocks.iter().for_each(|block| {
        block.count(slice::from_ref(&(0..block.items() as u32)), rows.start, &mut counts);
    });
    (rows.start, counts)
}
