//! Sums `H = sum_r w_r H_r`. The plan holds the pattern of H and, for each entry, the indices of the Hessian numbers that sum to it.
//! [`crate::Nonlinear::hessian`] computes these numbers for each item.
//!
//! All items write their numbers into one list, in parallel; then each entry sums its numbers, in the order of the items. No two tasks
//! write the same entry, and the sum does not depend on the number of threads.

use qless::common::Identity;
use qless::{Csr, SystemError};
use rayon::prelude::*;

use crate::equations::nonlinear::NonlinearBatch;

/// Number of entries of H that one task sums.
const SUMMED: usize = 1 << 13;

/// The pattern of H, and the terms of its entries.
pub struct HessianPlan {
    pub stamp: Identity,
    /// Index of the first entry of each row, and at the end the number of entries.
    start: Vec<usize>,
    col: Vec<u32>,
    /// Index in `terms` of the first term of each entry, and at the end the number of terms.
    first: Vec<u32>,
    /// Index of each term in the list of the numbers that [`crate::Nonlinear::hessian`] computes for all items.
    terms: Vec<u32>,
    /// Length of the list of the numbers that [`crate::Nonlinear::hessian`] computes for all items.
    pub numbers: usize,
}

impl HessianPlan {
    /// Collects the contributions `(row, column, number)` of all items to H, and sorts them by row and column. `number` is the index of the
    /// value in the list of all Hessian numbers.
    pub fn new(batches: &[Box<dyn NonlinearBatch>], dofs: usize) -> Self {
        let mut ends = vec![0_usize; dofs + 1];
        let numbers = for_each_entry(batches, |row, _, _| ends[row as usize + 1] += 1);
        if numbers == 0 {
            let (col, first, terms) = (Vec::new(), vec![0], Vec::new());
            return Self { stamp: Identity::new(), start: ends, col, first, terms, numbers };
        }
        (0..dofs).for_each(|row| ends[row + 1] += ends[row]);
        let mut keys = vec![(0, 0); ends[dofs]];
        let mut next = ends.clone();
        for_each_entry(batches, |row, column, number| {
            let next = &mut next[row as usize];
            keys[*next] = (column, number);
            *next += 1;
        });
        let (mut rows, mut rest) = (Vec::with_capacity(dofs), keys.as_mut_slice());
        for row in ends.windows(2) {
            let own;
            (own, rest) = rest.split_at_mut(row[1] - row[0]);
            rows.push(own);
        }
        rows.par_iter_mut().for_each(|row| row.sort_unstable());
        let (mut start, mut col, mut first) = (vec![0], Vec::new(), Vec::new());
        let mut before = 0;
        for row in rows {
            for same in row.chunk_by(|a, b| a.0 == b.0) {
                col.push(same[0].0);
                first.push(before);
                before += same.len() as u32;
            }
            start.push(col.len());
        }
        first.push(before);
        let terms = keys.into_iter().map(|(_, number)| number).collect();
        Self { stamp: Identity::new(), start, col, first, terms, numbers }
    }

    /// H with zeros as values.
    pub fn pattern(&self) -> Result<Csr, SystemError> {
        Csr::from_parts(self.start.len() - 1, self.start.clone(), self.col.clone(), vec![0.0; self.col.len()])
    }

    /// Writes the entries of H, from the Hessian numbers of all items.
    pub fn sum(&self, numbers: &[f64], h: &mut [f64]) {
        h.par_chunks_mut(SUMMED).zip(self.first.par_chunks(SUMMED)).enumerate().for_each(|(k, (h, first))| {
            let last = [self.first[(k * SUMMED + h.len()).min(self.first.len() - 1)]];
            let ends = first.iter().skip(1).chain(&last);
            for ((h, &first), &end) in h.iter_mut().zip(first).zip(ends) {
                let terms = &self.terms[first as usize..end as usize];
                *h = terms.iter().skip(1).fold(numbers[terms[0] as usize], |sum, &k| sum + numbers[k as usize]);
            }
        });
    }
}

/// Calls `entry(row, column, number)` for each contribution of an item to H, where `number` is the index of its value in the list of all
/// Hessian numbers. Returns the length of that list.
fn for_each_entry(batches: &[Box<dyn NonlinearBatch>], mut entry: impl FnMut(u32, u32, u32)) -> usize {
    batches.iter().fold(0, |first, batch| {
        batch.entries(first, &mut entry);
        first + batch.numbers(0..batch.items())
    })
}
