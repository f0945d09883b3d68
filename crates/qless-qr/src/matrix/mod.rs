//! `A = {(i, j, a_ij)}`: a borrowed m x n matrix in compressed columns or rows, as other libraries hold it.
//!
//! Nothing is copied to look at it. Entries of one column or row may stand in any order; those of the same place are
//! added. Checked in O(nnz) when it is made, so that nothing later meets a wrong index.

mod gather;
mod index;
mod multiply;

pub(crate) use gather::Gather;
pub use index::Index;

use crate::{Error, Symbolic};

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
    /// Whether the lists are rows.
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
    /// Column j has the entries `start[j]..start[j + 1]`, in the rows that `index` says.
    ///
    /// # Errors
    /// [`Error::Length`], [`Error::Start`], [`Error::Index`] or [`Error::NotFinite`] if the arrays are no m x n matrix.
    pub fn by_columns(
        rows: usize,
        cols: usize,
        start: &'a [P],
        index: &'a [I],
        values: &'a [f64],
    ) -> Result<Self, Error> {
        Self { rows, cols, is_by_rows: false, start, index, values }.checked()
    }

    /// Row i has the entries `start[i]..start[i + 1]`, in the columns that `index` says.
    ///
    /// # Errors
    /// As [`Self::by_columns`].
    pub fn by_rows(rows: usize, cols: usize, start: &'a [P], index: &'a [I], values: &'a [f64]) -> Result<Self, Error> {
        Self { rows, cols, is_by_rows: true, start, index, values }.checked()
    }

    /// m.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// n.
    pub fn cols(&self) -> usize {
        self.cols
    }

    /// The values, in the order in which [`Symbolic::factor`] takes them.
    pub fn values(&self) -> &'a [f64] {
        self.values
    }

    /// `A^T`, over the same arrays.
    #[must_use]
    pub fn transposed(&self) -> Self {
        Self { rows: self.cols, cols: self.rows, is_by_rows: !self.is_by_rows, ..*self }
    }

    /// Analyses the pattern; the analysis takes values in this matrix' order.
    ///
    /// # Errors
    /// [`Error::TooLarge`] or [`Error::Ordering`].
    pub fn analyse(&self) -> Result<Symbolic, Error> {
        crate::pattern::countable(self.rows, self.cols, self.index.len())?;
        let (columns, gather) = self.by_ascending_columns();
        let symbolic = crate::analyse::analyse(self.rows, &columns, &|_| true)?;
        Ok(Symbolic { gather, ..symbolic })
    }

    fn lists(&self) -> usize {
        if self.is_by_rows { self.rows } else { self.cols }
    }

    /// Entries of list k.
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
