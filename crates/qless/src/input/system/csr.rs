//! `A` as compressed rows: row `i` holds `(col[k], val[k])` for `k` in `start[i]..start[i + 1]`.

use rayon::prelude::*;

use super::SystemError;

/// Number of rows that one thread checks at a time.
const PART: usize = 1 << 13;

/// Sparse m x n matrix in compressed rows; columns ascend within a row and none repeats.
///
/// Every constructor guarantees that starts ascend from 0 to the number of entries, and that columns are below n.
#[derive(Clone, Debug, PartialEq)]
pub struct Csr {
    pub(crate) cols: usize,
    pub(crate) start: Vec<usize>,
    pub(crate) col: Vec<u32>,
    pub(crate) val: Vec<f64>,
}

impl Default for Csr {
    /// The 0 x 0 matrix.
    fn default() -> Self {
        Self::empty(0)
    }
}

impl Csr {
    /// The 0 x n matrix, ready for [`Csr::push_row`].
    ///
    /// ```
    /// use qless::Csr;
    /// let mut a = Csr::empty(3);
    /// a.push_row([(0, 1.0), (2, -1.0)])?;
    /// assert_eq!((a.rows(), a.cols(), a.nnz()), (1, 3, 2));
    /// assert_eq!(a.row(0).collect::<Vec<_>>(), [(0, 1.0), (2, -1.0)]);
    /// # Ok::<(), qless::SystemError>(())
    /// ```
    pub fn empty(cols: usize) -> Self {
        Self { cols, start: vec![0], col: Vec::new(), val: Vec::new() }
    }

    /// A matrix from the three arrays of the format: row `i` holds `(col[k], val[k])` for `k` in `start[i]..start[i + 1]`.
    ///
    /// ```
    /// use qless::{Csr, SystemError};
    /// let a = Csr::from_parts(2, vec![0, 1, 3], vec![1, 0, 1], vec![4.0, 5.0, 6.0])?;
    /// assert_eq!(a.row(1).collect::<Vec<_>>(), [(0, 5.0), (1, 6.0)]);
    /// let bad = Csr::from_parts(2, vec![0, 2, 1], vec![1], vec![4.0]);
    /// assert_eq!(bad, Err(SystemError::BadStarts { index: 1, value: 2 }));
    /// # Ok::<(), SystemError>(())
    /// ```
    ///
    /// # Errors
    /// [`SystemError::WrongLength`], [`SystemError::BadStarts`], [`SystemError::DofOutOfRange`] for a column that is not below
    /// `cols`, [`SystemError::NotAscending`], [`SystemError::TooLarge`].
    pub fn from_parts(cols: usize, start: Vec<usize>, col: Vec<u32>, val: Vec<f64>) -> Result<Self, SystemError> {
        check_starts(&start, col.len(), val.len())?;
        fits("the number of rows", start.len() - 1)?;
        check_rows(cols, &start, &col)?;
        Ok(Self { cols, start, col, val })
    }

    /// The m x n matrix without entries. Its starts are allocated as zeros, so large ones occupy no memory before they are accessed.
    ///
    /// ```
    /// use qless::Csr;
    /// let a = Csr::zero(3, 2)?;
    /// assert_eq!((a.rows(), a.cols(), a.nnz()), (3, 2, 0));
    /// # Ok::<(), qless::SystemError>(())
    /// ```
    ///
    /// # Errors
    /// [`SystemError::TooLarge`].
    pub fn zero(rows: usize, cols: usize) -> Result<Self, SystemError> {
        fits("the number of rows", rows)?;
        Ok(Self { cols, start: vec![0; rows + 1], col: Vec::new(), val: Vec::new() })
    }

    /// Number of rows m.
    pub fn rows(&self) -> usize {
        self.start.len() - 1
    }

    /// Number of columns n.
    pub fn cols(&self) -> usize {
        self.cols
    }

    /// Number of stored entries.
    pub fn nnz(&self) -> usize {
        self.col.len()
    }

    /// The start of each row in [`Csr::columns`] and [`Csr::values`]; length m + 1.
    pub fn starts(&self) -> &[usize] {
        &self.start
    }

    /// 0-based column of each entry.
    pub fn columns(&self) -> &[u32] {
        &self.col
    }

    /// Value of each entry.
    pub fn values(&self) -> &[f64] {
        &self.val
    }

    /// The values, which may be overwritten; the pattern stays.
    pub fn values_mut(&mut self) -> &mut [f64] {
        &mut self.val
    }

    /// The entries `(column, value)` of row `i`; rows from m on have none.
    #[inline]
    pub fn row(&self, i: usize) -> impl ExactSizeIterator<Item = (usize, f64)> + Clone + '_ {
        let range = if i < self.rows() { self.start[i]..self.start[i + 1] } else { 0..0 };
        self.col[range.clone()].iter().zip(&self.val[range]).map(|(&j, &v)| (j as usize, v))
    }

    /// Appends a row; its entries must ascend by column.
    ///
    /// # Errors
    /// [`SystemError::DofOutOfRange`] for a column that is not below n, [`SystemError::NotAscending`],
    /// [`SystemError::TooLarge`]; the matrix is then unchanged.
    pub fn push_row(&mut self, entries: impl IntoIterator<Item = (usize, f64)>) -> Result<(), SystemError> {
        fits("the number of rows", self.rows() + 1)?;
        let first = self.col.len();
        let mut before = None;
        for (column, value) in entries {
            if let Err(error) = check_next(self.rows(), self.cols, before, column) {
                self.col.truncate(first);
                self.val.truncate(first);
                return Err(error);
            }
            before = Some(column);
            self.col.push(column as u32);
            self.val.push(value);
        }
        self.start.push(self.col.len());
        Ok(())
    }

    /// Appends a valid row without checks; entries may be in any order if the caller sorts them later.
    pub(crate) fn append(&mut self, entries: impl IntoIterator<Item = (usize, f64)>) {
        for (j, v) in entries {
            debug_assert!(j < self.cols);
            self.col.push(j as u32);
            self.val.push(v);
        }
        self.start.push(self.col.len());
    }

    /// The transpose `A^T` (n x m), in O(m + n + nnz).
    ///
    /// ```
    /// use qless::Csr;
    /// let mut a = Csr::empty(2);
    /// a.push_row([(1, 5.0)])?;
    /// assert_eq!(a.transpose()?.row(1).collect::<Vec<_>>(), [(0, 5.0)]);
    /// # Ok::<(), qless::SystemError>(())
    /// ```
    ///
    /// # Errors
    /// [`SystemError::TooLarge`] if there are more columns than the library allows rows, or than memory allows.
    pub fn transpose(&self) -> Result<Self, SystemError> {
        fits("the number of columns", self.cols)?;
        // The number of columns can be huge although little is stored, so these allocations may fail.
        let room = |_| SystemError::TooLarge { what: "the number of columns", found: self.cols };
        let (mut start, mut next) = (Vec::new(), Vec::new());
        start.try_reserve_exact(self.cols + 1).map_err(room)?;
        next.try_reserve_exact(self.cols + 1).map_err(room)?;
        start.resize(self.cols + 1, 0);
        Ok(self.transposed_with(start, next))
    }

    /// [`Csr::transpose`] without its check, for a matrix whose number of columns is known to be below the limit.
    #[must_use]
    pub(crate) fn transposed(&self) -> Self {
        self.transposed_with(vec![0; self.cols + 1], Vec::new())
    }

    /// The transpose. `start` has length n + 1, is all zero, and becomes the starts of the result; `next` is empty and used as work memory.
    fn transposed_with(&self, mut start: Vec<usize>, mut next: Vec<usize>) -> Self {
        for &j in &self.col {
            start[j as usize + 1] += 1;
        }
        for j in 0..self.cols {
            start[j + 1] += start[j];
        }
        next.extend_from_slice(&start);
        let mut col = vec![0; self.nnz()];
        let mut val = vec![0.0; self.nnz()];
        for i in 0..self.rows() {
            for k in self.start[i]..self.start[i + 1] {
                let slot = &mut next[self.col[k] as usize];
                col[*slot] = i as u32;
                val[*slot] = self.val[k];
                *slot += 1;
            }
        }
        Self { cols: self.rows(), start, col, val }
    }

    /// The product `A x`.
    ///
    /// # Errors
    /// [`SystemError::WrongLength`] unless x has length n.
    pub fn times(&self, x: &[f64]) -> Result<Vec<f64>, SystemError> {
        if x.len() != self.cols {
            return Err(SystemError::WrongLength { what: "the vector", found: x.len(), expected: self.cols });
        }
        Ok(self.product(x))
    }

    /// The product `A x` for x of length n, which is not checked.
    pub(crate) fn product(&self, x: &[f64]) -> Vec<f64> {
        (0..self.rows()).map(|i| self.row(i).map(|(j, v)| v * x[j]).sum()).collect()
    }
}

/// Checks that a size fits 32-bit indices; `u32::MAX` itself marks a missing index.
pub(super) fn fits(what: &'static str, found: usize) -> Result<(), SystemError> {
    if found < u32::MAX as usize { Ok(()) } else { Err(SystemError::TooLarge { what, found }) }
}

/// Checks the starts of compressed rows or columns: they ascend from 0 to the number of entries, and there are as many values as indices.
pub(super) fn check_starts(start: &[usize], nnz: usize, values: usize) -> Result<(), SystemError> {
    if values != nnz {
        return Err(SystemError::WrongLength { what: "the list of values", found: values, expected: nnz });
    }
    let Some(last) = start.len().checked_sub(1) else {
        return Err(SystemError::WrongLength { what: "the list of starts", found: 0, expected: 1 });
    };
    for (index, &value) in start.iter().enumerate() {
        let (low, high) = if index == 0 { (0, 0) } else { (start[index - 1], nnz) };
        if value < low || value > high || (index == last && value != nnz) {
            return Err(SystemError::BadStarts { index, value });
        }
    }
    Ok(())
}

/// Checks all rows in parallel; returns the fault of the first bad row.
fn check_rows(cols: usize, start: &[usize], col: &[u32]) -> Result<(), SystemError> {
    let rows = start.len() - 1;
    let fault = |row: usize| check_row(row, cols, &col[start[row]..start[row + 1]]).err();
    let first = |part: usize| (part * PART..rows.min((part + 1) * PART)).find_map(fault);
    (0..rows.div_ceil(PART)).into_par_iter().find_map_first(first).map_or(Ok(()), Err)
}

/// Checks that columns ascend, and are below `cols`.
fn check_row(row: usize, cols: usize, columns: &[u32]) -> Result<(), SystemError> {
    let mut before = None;
    for &column in columns {
        check_next(row, cols, before, column as usize)?;
        before = Some(column as usize);
    }
    Ok(())
}

fn check_next(row: usize, cols: usize, before: Option<usize>, column: usize) -> Result<(), SystemError> {
    if column >= cols.min(u32::MAX as usize) {
        let what = super::Place::Coefficient { row, dof: column };
        return Err(SystemError::DofOutOfRange { what, dof: column, dofs: cols });
    }
    match before {
        Some(before) if before >= column => Err(SystemError::NotAscending { row, column, before }),
        _ => Ok(()),
    }
}
