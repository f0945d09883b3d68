//! `P_r A P_c = [R11 R12; 0 S]` and the tree of fronts of S: everything that the pattern alone decides.

use crate::analyse::{Forecast, Fronts};
use crate::matrix::Gather;
use crate::pattern::Lists;
use crate::{Error, Factor, Options};
use std::borrow::Cow;

/// The analysis of one pattern. It holds no numbers, serves any number of factorizations, and any number at once.
#[derive(Clone, Debug, PartialEq)]
pub struct Symbolic {
    pub(crate) rows: usize,
    pub(crate) cols: usize,
    /// Column of A at each position; peeled ones first.
    pub(crate) order: Vec<u32>,
    /// How many columns were peeled: position i is the diagonal of row i up to here.
    pub(crate) peeled: usize,
    /// Row of A at each row position: peeled ones, then by first column, empty ones last.
    pub(crate) row_order: Vec<u32>,
    /// Columns (positions, ascending) of the rows in that order.
    pub(crate) pattern: Lists,
    /// Where in A's values each of those entries is.
    pub(crate) entry: Vec<u32>,
    pub(crate) fronts: Fronts,
    /// Front f assembles the rows `row[f]..row[f + 1]` (row positions).
    pub(crate) row: Vec<u32>,
    /// Columns of each front that are not pivotal.
    pub(crate) outer: Lists,
    pub(crate) forecast: Forecast,
    /// How the values that are given become those of the pattern.
    pub(crate) gather: Gather,
}

impl Symbolic {
    /// Analyses the pattern of an m x n matrix, given by columns: column j has entries in the rows
    /// `index[start[j]..start[j + 1]]`, ascending without duplicates.
    ///
    /// # Errors
    /// [`Error::Length`], [`Error::Pattern`] or [`Error::TooLarge`] if it is no such pattern.
    pub fn analyse(rows: usize, cols: usize, start: &[usize], index: &[u32]) -> Result<Self, Error> {
        let columns = crate::pattern::checked(rows, cols, start, index)?;
        crate::analyse::analyse(rows, &columns, &|_| true)
    }

    /// P: the column of A at each position, in an order in which R has few entries; length n.
    pub fn order(&self) -> &[u32] {
        &self.order
    }

    /// Operations of the factorization without right-hand sides, if no column is dependent.
    pub fn flops(&self) -> f64 {
        self.forecast.flops.iter().fold(0.0, |sum, flops| sum + flops)
    }

    /// Entries of `[R1 R2]` if no column is dependent, zeros of joined fronts included.
    pub fn entries(&self) -> usize {
        self.forecast.entries
    }

    /// Bytes that a factorization with `rhs` right-hand sides allocates at most (result, fronts, what waits for its
    /// parent), if no column is dependent by its values and all fronts run on one thread.
    ///
    /// A dependent column leaves a row to the parent that the pattern did not foresee; then [`Self::memory_at_worst`]
    /// is the bound. Several threads run subtrees side by side only if the limit has room for that as well.
    pub fn memory(&self, rhs: usize) -> usize {
        self.forecast.bytes(self, rhs, false)
    }

    /// As [`Self::memory`], whatever the values.
    pub fn memory_at_worst(&self, rhs: usize) -> usize {
        self.forecast.bytes(self, rhs, true)
    }

    /// Bytes that [`Options::keep_q`] adds to [`Self::memory`], if no column is dependent by its values.
    pub fn memory_of_q(&self) -> usize {
        self.forecast.bytes_of_q(self)
    }

    /// Factors the matrix with this pattern and the given values, and transforms B (`rhs`, m x k by columns, or nothing).
    ///
    /// [`Options`] say which columns count as dependent, how many bytes are allocated at most (the forecast is checked
    /// before anything is, and what exceeds the forecast before each front) and whether Q stays.
    /// Runs on the calling thread's rayon pool; the result has the same bits whatever its size.
    ///
    /// The analysis serves any number of matrices of its pattern:
    ///
    /// ```
    /// use qless_qr::{Options, Symbolic};
    /// let symbolic = Symbolic::analyse(2, 2, &[0, 2, 3], &[0, 1, 1])?;
    /// for scale in [1.0, 2.0] {
    ///     let (values, b) = ([3.0 * scale, 4.0, 5.0], [3.0 * scale, 9.0]);
    ///     let x = symbolic.factor(&values, &b, Options::new())?.basic()?;
    ///     assert!((x[0] - 1.0).abs() < 1e-14 && (x[1] - 1.0).abs() < 1e-14);
    /// }
    /// # Ok::<(), qless_qr::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Length`], [`Error::Tolerance`], [`Error::NotFinite`], [`Error::Overflow`], [`Error::OutOfMemory`] or
    /// [`Error::Ordering`].
    pub fn factor(&self, values: &[f64], rhs: &[f64], options: Options) -> Result<Factor, Error> {
        crate::numeric::factor(self, values, rhs, options)
    }

    /// The values by columns, rows ascending, each entry once.
    pub(crate) fn gathered<'a>(&self, values: &'a [f64]) -> Result<Cow<'a, [f64]>, Error> {
        let expected = self.gather.given(self.entry.len());
        if values.len() != expected {
            return Err(Error::Length { what: "values", found: values.len(), expected });
        }
        Ok(self.gather.of(values, self.entry.len()))
    }

    pub(crate) fn front_columns(&self, f: usize) -> (u32, u32, &[u32]) {
        (self.fronts.pivot[f], self.fronts.pivot[f + 1], self.outer.list(f))
    }

    pub(crate) fn front_rows(&self, f: usize) -> std::ops::Range<usize> {
        self.row[f] as usize..self.row[f + 1] as usize
    }

    /// The pattern by columns as it was given, and the column of each peeled position.
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
