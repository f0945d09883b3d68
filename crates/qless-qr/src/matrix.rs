//! A borrowed sparse m x n matrix in compressed columns or rows, as other libraries store it.
//!
//! The constructors check the arrays in O(nnz) and copy nothing. The entries of a column or row may come in any order;
//! entries with the same row and column are added.

use crate::Error;
use crate::lists::Lists;
use std::borrow::Cow;

/// A borrowed sparse matrix with offsets of type P and indices of type I, both counted from 0.
///
/// ```
/// use qless_qr::Matrix;
/// // [1 0 2]
/// // [0 3 0], by rows, with the 32-bit integers of a C library.
/// let (start, index): ([i32; 3], [i32; 3]) = ([0, 2, 3], [0, 2, 1]);
/// let a = Matrix::by_rows(2, 3, &start, &index, &[1.0, 2.0, 3.0])?;
/// assert_eq!((a.rows(), a.cols(), a.transposed().rows()), (2, 3, 3));
/// # Ok::<(), qless_qr::Error>(())
/// ```
#[derive(Debug)]
pub struct Matrix<'a, P = usize, I = u32> {
    rows: usize,
    cols: usize,
    /// True if the matrix is stored by rows, false if it is stored by columns.
    is_by_rows: bool,
    start: &'a [P],
    index: &'a [I],
    values: &'a [f64],
}

impl<P, I> Clone for Matrix<'_, P, I> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<P, I> Copy for Matrix<'_, P, I> {}

impl<'a, P: Index, I: Index> Matrix<'a, P, I> {
    /// Column j has the entries `start[j]..start[j + 1]`; `index` gives their rows.
    ///
    /// # Errors
    /// [`Error::Length`], [`Error::Start`], [`Error::Index`] or [`Error::NotFinite`] if the arrays are not an m x n matrix.
    pub fn by_columns(
        rows: usize,
        cols: usize,
        start: &'a [P],
        index: &'a [I],
        values: &'a [f64],
    ) -> Result<Self, Error> {
        Self { rows, cols, is_by_rows: false, start, index, values }.checked()
    }

    /// Row i has the entries `start[i]..start[i + 1]`; `index` gives their columns.
    ///
    /// # Errors
    /// As [`Self::by_columns`].
    pub fn by_rows(rows: usize, cols: usize, start: &'a [P], index: &'a [I], values: &'a [f64]) -> Result<Self, Error> {
        Self { rows, cols, is_by_rows: true, start, index, values }.checked()
    }

    /// m, the number of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// n, the number of columns.
    pub fn cols(&self) -> usize {
        self.cols
    }

    /// The values, in the order that [`Symbolic::factor`](crate::Symbolic::factor) expects after [`Self::analyse`].
    pub fn values(&self) -> &'a [f64] {
        self.values
    }

    /// `A^T`, over the same arrays.
    #[must_use]
    pub fn transposed(&self) -> Self {
        Self { rows: self.cols, cols: self.rows, is_by_rows: !self.is_by_rows, ..*self }
    }

    fn lists(&self) -> usize {
        if self.is_by_rows { self.rows } else { self.cols }
    }

    /// Range of the entries of row k, or of column k if the matrix is stored by columns.
    fn list(&self, k: usize) -> std::ops::Range<usize> {
        self.start[k].position()..self.start[k + 1].position()
    }

    fn checked(self) -> Result<Self, Error> {
        let (lists, entries) = (self.lists(), self.index.len());
        let bound = if self.is_by_rows { self.cols } else { self.rows };
        let expected = lists.saturating_add(1);
        if self.start.len() != expected {
            return Err(Error::Length { what: "start", found: self.start.len(), expected });
        }
        if self.values.len() != entries {
            return Err(Error::Length { what: "values", found: self.values.len(), expected: entries });
        }
        let start = |at: usize| self.start[at].position();
        let is_wrong = |&at: &usize| start(at) > entries || (at > 0 && start(at) < start(at - 1));
        let ends = [0, lists].into_iter().find(|&at| start(at) != if at == 0 { 0 } else { entries });
        if let Some(at) = ends.or_else(|| (0..=lists).find(is_wrong)) {
            return Err(Error::Start { at, found: start(at), entries });
        }
        if let Some(entry) = self.index.iter().position(|index| index.position() >= bound) {
            return Err(Error::Index { entry, found: self.index[entry].position(), bound });
        }
        if self.values.iter().all(|v| v.is_finite()) { Ok(self) } else { Err(Error::NotFinite("the matrix")) }
    }
}

/// An integer type for the indices or offsets of a compressed matrix. Sealed: other crates cannot implement it.
pub trait Index: Copy + Send + Sync + sealed::Sealed {
    /// The index as `usize`; `usize::MAX` if it is negative.
    fn position(self) -> usize;
}

mod sealed {
    pub trait Sealed {}
}

macro_rules! index {
    ($($integer:ty)*) => {$(
        impl sealed::Sealed for $integer {}
        impl Index for $integer {
            #[inline]
            fn position(self) -> usize {
                usize::try_from(self).unwrap_or(usize::MAX)
            }
        }
    )*};
}

index!(u32 u64 usize i32 i64 isize);

/// For each given value, the entry of the pattern to which it is added; `None` if the values already are in the order of the pattern.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Gather(Option<Vec<u32>>);

impl Gather {
    /// Number of values that the caller must pass for a pattern with `places` entries.
    pub fn given(&self, places: usize) -> usize {
        self.0.as_ref().map_or(places, Vec::len)
    }

    /// The values in the order of the pattern. Values of the same entry are added in the given order.
    pub fn gathered<'a>(&self, values: &'a [f64], places: usize) -> Cow<'a, [f64]> {
        let Some(slot) = &self.0 else { return Cow::Borrowed(values) };
        let mut gathered = vec![0.0; places];
        slot.iter().zip(values).for_each(|(&at, v)| gathered[at as usize] += v);
        Cow::Owned(gathered)
    }
}

impl<P: Index, I: Index> Matrix<'_, P, I> {
    /// The pattern by columns, rows ascending, each entry once, and for each value the entry to which it is added. Two counting sorts.
    pub(crate) fn by_ascending_columns(&self) -> (Lists, Gather) {
        if !self.is_by_rows && self.ascends() {
            let start = self.start.iter().map(|at| at.position()).collect();
            let index = self.index.iter().map(|i| i.position() as u32).collect();
            return (Lists { start, index }, Gather(None));
        }
        let (row, column) = self.places();
        let by_row = if self.is_by_rows {
            (0..row.len() as u32).collect()
        } else {
            sorted(&row, self.rows, 0..row.len() as u32)
        };
        let order = sorted(&column, self.cols, by_row.into_iter());
        let (mut lists, mut slot) = (Lists::new(), vec![0; row.len()]);
        let mut last = None;
        for entry in order.into_iter().map(|entry| entry as usize) {
            while lists.len() < column[entry] as usize {
                lists.close();
            }
            if last != Some((row[entry], column[entry])) {
                last = Some((row[entry], column[entry]));
                lists.index.push(row[entry]);
            }
            slot[entry] = lists.index.len() as u32 - 1;
        }
        while lists.len() < self.cols {
            lists.close();
        }
        (lists, Gather(Some(slot)))
    }

    /// Returns true if the indices of every list strictly ascend.
    fn ascends(&self) -> bool {
        let ascends = |list: &[I]| list.windows(2).all(|pair| pair[0].position() < pair[1].position());
        (0..self.lists()).all(|k| ascends(&self.index[self.list(k)]))
    }

    /// Row and column of each entry.
    fn places(&self) -> (Vec<u32>, Vec<u32>) {
        let minor = self.index.iter().map(|i| i.position() as u32).collect();
        let major = (0..self.lists()).flat_map(|k| self.list(k).map(move |_| k as u32)).collect();
        if self.is_by_rows { (major, minor) } else { (minor, major) }
    }
}

/// The entries sorted by key; the sort is stable.
fn sorted(key: &[u32], keys: usize, entries: impl Iterator<Item = u32>) -> Vec<u32> {
    let mut next = vec![0_usize; keys + 1];
    key.iter().for_each(|&k| next[k as usize + 1] += 1);
    (0..keys).for_each(|k| next[k + 1] += next[k]);
    let mut order = vec![0; key.len()];
    for entry in entries {
        let at = &mut next[key[entry as usize] as usize];
        order[*at] = entry;
        *at += 1;
    }
    order
}

impl<P: Index, I: Index> Matrix<'_, P, I> {
    /// `y <- y + s A x`.
    pub(crate) fn add_product(&self, s: f64, x: &[f64], y: &mut [f64]) {
        for k in 0..self.lists() {
            let range = self.list(k);
            let entries = self.index[range.clone()].iter().map(|i| i.position()).zip(&self.values[range]);
            if self.is_by_rows {
                y[k] += s * entries.fold(0.0, |sum, (j, v)| sum + v * x[j]);
            } else {
                let factor = s * x[k];
                entries.for_each(|(i, v)| y[i] += v * factor);
            }
        }
    }

    /// `b - r - A x` with twice the digits, rounded once (Dekker 1971; Ogita, Rump, Oishi 2005).
    pub(crate) fn exact_residual(&self, b: &[f64], r: Option<&[f64]>, x: &[f64]) -> Vec<f64> {
        let mut sums: Vec<DoubleSum> = b.iter().map(|&b| DoubleSum { high: b, low: 0.0 }).collect();
        r.into_iter().for_each(|r| sums.iter_mut().zip(r).for_each(|(sum, r)| sum.add(-r)));
        for k in 0..self.lists() {
            for at in self.list(k) {
                let other = self.index[at].position();
                let (i, j) = if self.is_by_rows { (k, other) } else { (other, k) };
                sums[i].add_product(-self.values[at], x[j]);
            }
        }
        sums.into_iter().map(|sum| sum.high + sum.low).collect()
    }
}

/// An unevaluated sum of two numbers, which has twice the digits of one.
struct DoubleSum {
    high: f64,
    low: f64,
}

impl DoubleSum {
    fn add(&mut self, v: f64) {
        let sum = self.high + v;
        let part = sum - self.high;
        self.low += (self.high - (sum - part)) + (v - part);
        self.high = sum;
    }

    fn add_product(&mut self, a: f64, b: f64) {
        let product = a * b;
        self.low += a.mul_add(b, -product);
        self.add(product);
    }
}
