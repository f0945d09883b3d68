//! Rows, columns and the largest entries of a T that is not formed.
//!
//! The search for `max |T_ij|` is like the estimate of a 1-norm (Higham and Tisseur 2000): it alternates between a row, the column of its
//! largest entry, and the row of that column's largest entry, until the entry no longer grows. It is repeated from several starts.

use rayon::prelude::*;

use super::FactoredBlock;
use crate::common::random::signed;
use crate::factor::backend::largest_place;

/// Number of starts of the search for the largest entry.
const STARTS: u64 = 4;
/// For a bound of at least this, the pivot threshold keeps nearly all entries of T below the bound, and the search looks for exceptions.
/// For a smaller bound every column is computed.
const SURE: f64 = 4.0;
/// Number of columns of T that are computed to estimate its nonzeros.
const SAMPLE: usize = 8;
/// Entries of a column below this, relative to its largest, are rounding.
const NOISE: f64 = 1e-14;
/// Maximum number of steps from a row to a column and back.
const STEPS: usize = 6;

impl FactoredBlock {
    /// Pairs of a slave and a master to exchange: the places of entries of T above the limit, at most one in each row and column. Updates
    /// the growth.
    pub(super) fn search(&mut self, limit: f64) -> Vec<(usize, usize)> {
        let mut found: Vec<(usize, usize)> = Vec::new();
        let entries: Vec<_> = if limit < SURE {
            (0..self.masters.len()).into_par_iter().filter_map(|j| self.largest_of_column(j)).collect()
        } else {
            (0..STARTS).into_par_iter().filter_map(|start| self.climb(start)).collect()
        };
        for (slave, master, size) in entries {
            self.growth = self.growth.max(size);
            if size > limit && found.iter().all(|&(s, m)| s != slave && m != master) {
                found.push((slave, master));
            }
        }
        found
    }

    /// The largest entry of a column of T.
    fn largest_of_column(&self, j: usize) -> Option<(usize, usize, f64)> {
        let column = self.column_of(j);
        let i = largest_place(&column)?;
        Some((self.slaves[i], self.masters[j], column[i].abs()))
    }

    /// An estimate of the nonzeros of T from a sample of its columns.
    pub(super) fn sampled(&self) -> usize {
        let count = self.masters.len();
        let step = count.div_ceil(SAMPLE).max(1);
        let places: Vec<usize> = (0..count).step_by(step).collect();
        let nonzeros = |&j: &usize| {
            let column = self.column_of(j);
            let least = NOISE * column.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
            column.iter().filter(|v| v.abs() > least).count()
        };
        places.iter().map(nonzeros).sum::<usize>() * count / places.len().max(1)
    }

    /// Starts at a random combination of rows, and climbs to an entry of T that is the largest of its row and of its column, in at most
    /// [`STEPS`] steps.
    fn climb(&self, seed: u64) -> Option<(usize, usize, f64)> {
        let mut f: Vec<f64> = (0..self.slaves.len() as u64).map(|k| signed(seed, k)).collect();
        let mut best = None;
        for _ in 0..STEPS {
            let row = self.row_of(&f);
            let j = largest_place(&row)?;
            let column = self.column_of(j);
            let i = largest_place(&column)?;
            let size = column[i].abs();
            if best.is_some_and(|(_, _, most)| size <= most) {
                break;
            }
            best = Some((self.slaves[i], self.masters[j], size));
            f.fill(0.0);
            f[i] = 1.0;
        }
        best
    }

    /// The row of T of the k-th slave of the block, as (master, coefficient), ascending.
    pub(crate) fn row(&self, k: usize) -> Vec<(usize, f64)> {
        let mut unit = vec![0.0; self.slaves.len()];
        unit[k] = 1.0;
        let row = self.row_of(&unit).into_iter().zip(&self.masters);
        row.filter(|(v, _)| *v != 0.0).map(|(v, &j)| (j, v)).collect()
    }

    /// `T^T f` for forces f on the slaves of the block, by master.
    pub(crate) fn row_of(&self, f: &[f64]) -> Vec<f64> {
        let mut f = f.to_vec();
        super::rescale(&mut f, &self.exponents[0], 1);
        let y = self.solver.solve_transposed(&f);
        let mut sum = vec![0.0; self.masters.len()];
        y.iter().enumerate().for_each(|(i, y)| self.of_masters.row(i).for_each(|(j, v)| sum[j] -= v * y));
        super::rescale(&mut sum, &self.exponents[1], -1);
        sum
    }

    /// The column of T of the j-th master of the block, by slave.
    pub(crate) fn column_of(&self, j: usize) -> Vec<f64> {
        let mut unit = vec![0.0; self.masters.len()];
        unit[j] = 1.0;
        super::rescale(&mut unit, &self.exponents[1], -1);
        let right: Vec<f64> = self.of_masters.product(&unit).into_iter().map(|v| -v).collect();
        let mut x = self.solver.solve_dense(&right);
        super::rescale(&mut x, &self.exponents[0], 1);
        x
    }
}
