//! Symbolic analysis: everything that depends on the pattern of A alone.
//!
//! `P_r A P_c = [R11 R12; 0 S]` with the singleton columns peeled into R11, and the tree of fronts of S.

mod analyse;
mod forecast;
mod fronts;
mod order;
mod singletons;
mod tree;

pub(crate) use analyse::analyse;
pub(crate) use forecast::{
    Forecast, FrontShape, INDEX, front_bytes, kept_bytes, out_bytes, reflection_bytes, waiting_bytes,
};
pub(crate) use fronts::Fronts;

use crate::Error;
use crate::lists::Lists;
use crate::matrix::Gather;
use std::borrow::Cow;

/// The analysis of one pattern. It holds no values and serves any number of factorizations, also in parallel.
#[derive(Clone, Debug, PartialEq)]
pub struct Symbolic {
    pub(crate) rows: usize,
    pub(crate) cols: usize,
    /// Column of A at each position; peeled ones first.
    pub(crate) order: Vec<u32>,
    /// Number of peeled columns. They have the first positions, and the diagonal entry of peeled row i is at position i.
    pub(crate) peeled: usize,
    /// Row of A at each row position: peeled rows, then the others by first column, empty rows last.
    pub(crate) row_order: Vec<u32>,
    /// Columns of each row, in the order of `row_order`; ascending column positions.
    pub(crate) pattern: Lists,
    /// For each entry of `pattern`, its index in the values of A.
    pub(crate) entry: Vec<u32>,
    pub(crate) fronts: Fronts,
    /// Front f assembles the rows `row[f]..row[f + 1]` (row positions).
    pub(crate) row: Vec<u32>,
    /// Columns of each front that are not pivotal.
    pub(crate) outer: Lists,
    pub(crate) forecast: Forecast,
    /// Maps the given values to the entries of the pattern.
    pub(crate) gather: Gather,
}

impl Symbolic {
    /// P: the column of A at each position, in an order in which R has few entries; length n.
    pub fn order(&self) -> &[u32] {
        &self.order
    }

    /// Floating-point operations of a factorization without right-hand sides, if no column is dependent.
    pub fn flops(&self) -> f64 {
        self.forecast.flops.iter().fold(0.0, |sum, flops| sum + flops)
    }

    /// Upper bound for the speed-up on this many threads: `min(threads, W / S)`. W are all operations; S are those on the longest path from
    /// a leaf of the tree of fronts to its root, for large fronts only those that cannot run in parallel.
    pub fn speedup(&self, threads: usize) -> f64 {
        let bound = self.flops() / self.forecast.span;
        if bound < threads as f64 { bound } else { threads as f64 }
    }

    /// Number of entries of `[R1 R2]` if no column is dependent, including the zeros of merged fronts.
    pub fn entries(&self) -> usize {
        self.forecast.entries
    }

    /// Upper bound of the bytes that a factorization with `rhs` right-hand sides allocates (result, fronts, contributions
    /// to parents), if no column is dependent by its values and all fronts run on one thread.
    ///
    /// A column that is dependent by its values passes one more row to the parent than the pattern foresees; then [`Self::memory_at_worst`]
    /// is the bound. Subtrees run in parallel only if the memory limit has room for all of them at once.
    pub fn memory(&self, rhs: usize) -> usize {
        self.forecast.bytes(self, rhs, false)
    }

    /// Like [`Self::memory`], but for any values.
    pub fn memory_at_worst(&self, rhs: usize) -> usize {
        self.forecast.bytes(self, rhs, true)
    }

    /// Bytes that [`crate::Options::keep_q`] adds to [`Self::memory`], if no column is dependent by its values.
    pub fn memory_of_q(&self) -> usize {
        self.forecast.bytes_of_q(self)
    }

    /// The given values in the order of the pattern: by columns, rows ascending, each entry once.
    pub(crate) fn gathered<'a>(&self, values: &'a [f64]) -> Result<Cow<'a, [f64]>, Error> {
        let expected = self.gather.given(self.entry.len());
        if values.len() != expected {
            return Err(Error::Length { what: "values", found: values.len(), expected });
        }
        Ok(self.gather.gathered(values, self.entry.len()))
    }

    pub(crate) fn front_columns(&self, f: usize) -> (u32, u32, &[u32]) {
        (self.fronts.pivot[f], self.fronts.pivot[f + 1], self.outer.list(f))
    }

    pub(crate) fn front_rows(&self, f: usize) -> std::ops::Range<usize> {
        self.row[f] as usize..self.row[f + 1] as usize
    }

    /// The pattern of A by columns, as it was analysed.
    pub(crate) fn columns(&self) -> Lists {
        let mut start = vec![0; self.cols + 1];
        for &position in &self.pattern.index {
            start[self.order[position as usize] as usize + 1] += 1;
        }
        (0..self.cols).for_each(|j| start[j + 1] += start[j]);
        let mut index = vec![0; self.entry.len()];
        for i in 0..self.rows {
            let entries = &self.entry[self.pattern.start[i]..self.pattern.start[i + 1]];
            entries.iter().for_each(|&entry| index[entry as usize] = self.row_order[i]);
        }
        Lists { start, index }
    }
}
