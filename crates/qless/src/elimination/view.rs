//! A borrowed view of the pattern of a sparse matrix: compressed rows or columns, with any index type, counted from 0 or 1.

pub use qless_qr::Index;

use crate::SystemError;

/// Which entries of a symmetric matrix are stored.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Storage {
    /// All entries; the matrix need not be symmetric.
    #[default]
    Full,
    /// Entries with column <= row of a symmetric matrix.
    Lower,
    /// Entries with column >= row of a symmetric matrix.
    Upper,
}

impl Storage {
    /// Returns true if entry (row, column) is one of the stored entries.
    pub(super) fn holds(self, row: usize, column: usize) -> bool {
        match self {
            Self::Full => true,
            Self::Lower => column <= row,
            Self::Upper => column >= row,
        }
    }

    /// The half that is stored after rows and columns are exchanged.
    pub(super) fn transposed(self) -> Self {
        match self {
            Self::Full => Self::Full,
            Self::Lower => Self::Upper,
            Self::Upper => Self::Lower,
        }
    }
}

/// A borrowed pattern: line i holds the indices `index[k]` for `k` in `starts[i]..starts[i + 1]`. Lines are rows or columns.
///
/// ```
/// use qless::elimination::{Storage, View};
/// // [2 1]  in compressed rows, counted from 1, with the integers of Fortran.
/// // [0 3]
/// let view = View::rows(&[1_i32, 3, 4], &[1_i32, 2, 2]).one_based();
/// assert_eq!(view.checked(2)?.nnz(), 3);
/// // The lower half by compressed columns, as in faer, sprs and nalgebra-sparse:
/// let lower = View::columns(&[0_usize, 2, 3], &[0_u32, 1, 1]).storing(Storage::Lower);
/// assert!(lower.checked(2).is_ok() && lower.checked(3).is_err());
/// # Ok::<(), qless::SystemError>(())
/// ```
#[derive(Clone, Copy, Debug)]
#[must_use]
pub struct View<'a, P = usize, I = u32> {
    starts: &'a [P],
    index: &'a [I],
    base: usize,
    /// Number of empty lines (rows or columns) that follow those of `starts`.
    empty: usize,
    pub(super) by_columns: bool,
    pub(super) storage: Storage,
}

impl<'a, P: Index, I: Index> View<'a, P, I> {
    /// A pattern of compressed rows; starts and indices count from 0.
    pub fn rows(starts: &'a [P], columns: &'a [I]) -> Self {
        Self { starts, index: columns, base: 0, empty: 0, by_columns: false, storage: Storage::Full }
    }

    /// A pattern of compressed columns; starts and indices count from 0.
    pub fn columns(starts: &'a [P], rows: &'a [I]) -> Self {
        Self { by_columns: true, ..Self::rows(starts, rows) }
    }

    /// Declares that starts and indices count from 1.
    pub fn one_based(self) -> Self {
        Self { base: 1, ..self }
    }

    /// Declares that the arrays hold only this half of a symmetric matrix.
    pub fn storing(self, storage: Storage) -> Self {
        Self { storage, ..self }
    }

    /// The same pattern followed by empty lines, for DOFs that occur only in constraints, like the rotations of a rigid body.
    ///
    /// ```
    /// use qless::elimination::View;
    /// let view = View::rows(&[0_usize, 1, 2], &[0_u32, 1]).then_empty(3);
    /// assert!(view.checked(5).is_ok() && view.checked(2).is_err());
    /// # Ok::<(), qless::SystemError>(())
    /// ```
    pub fn then_empty(self, lines: usize) -> Self {
        Self { empty: lines, ..self }
    }

    /// Number of stored entries.
    pub fn nnz(&self) -> usize {
        self.index.len()
    }

    /// `(row, column)` of each stored entry, in the order of the values.
    ///
    /// ```
    /// use qless::elimination::View;
    /// let view = View::columns(&[0, 2, 3], &[0_u32, 1, 1]).checked(2)?;
    /// assert_eq!(view.entries().collect::<Vec<_>>(), [(0, 0), (1, 0), (1, 1)]);
    /// # Ok::<(), qless::SystemError>(())
    /// ```
    ///
    /// # Panics
    /// If the arrays are not a valid pattern; [`View::checked`] tests that.
    pub fn entries(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        (0..self.starts.len().saturating_sub(1)).flat_map(move |line| {
            let others = self.range(line).map(|k| self.index(k));
            others.map(move |other| if self.by_columns { (other, line) } else { (line, other) })
        })
    }

    /// Which entries of the matrix are stored.
    pub fn storage(&self) -> Storage {
        self.storage
    }

    /// The range of the entries of line i (a row or a column) in the list of indices.
    #[inline]
    pub(super) fn range(&self, i: usize) -> std::ops::Range<usize> {
        match self.starts.get(i + 1) {
            Some(end) => self.starts[i].position() - self.base..end.position() - self.base,
            None => self.nnz()..self.nnz(),
        }
    }

    /// The index of entry k in its line, counted from 0: the column of the entry if lines are rows, else its row.
    #[inline]
    pub(super) fn index(&self, k: usize) -> usize {
        self.index[k].position() - self.base
    }

    /// Checks that this is the pattern of an n x n matrix. Indices may be in any order and may repeat; repeated entries are summed.
    ///
    /// # Errors
    /// [`SystemError::WrongLength`], [`SystemError::BadStarts`], [`SystemError::BadIndex`], [`SystemError::WrongHalf`].
    pub fn checked(self, n: usize) -> Result<Self, SystemError> {
        // `starts` has one number more than there are lines.
        let Some(lines) = n.checked_sub(self.empty).filter(|lines| self.starts.len().checked_sub(1) == Some(*lines))
        else {
            let (found, expected) = (self.starts.len(), n.saturating_sub(self.empty).saturating_add(1));
            return Err(SystemError::WrongLength { what: "the list of starts", found, expected });
        };
        let mut before = self.base;
        for (line, start) in self.starts.iter().enumerate() {
            let value = start.position();
            let last = self.base + self.nnz();
            let fits = if line == 0 { value == self.base } else { value >= before && value <= last };
            if !fits || (line == lines && value != last) {
                return Err(SystemError::BadStarts { index: line, value });
            }
            before = value;
        }
        for line in 0..lines {
            for k in self.range(line) {
                let found = self.index[k].position().checked_sub(self.base).filter(|&j| j < n);
                let Some(j) = found else {
                    return Err(SystemError::BadIndex { place: k, dofs: n });
                };
                let (row, column) = if self.by_columns { (j, line) } else { (line, j) };
                if !self.storage.holds(row, column) {
                    return Err(SystemError::WrongHalf { place: k, row, column });
                }
            }
        }
        Ok(self)
    }
}
