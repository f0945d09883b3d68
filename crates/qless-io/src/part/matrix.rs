//! Parts of a Matrix Market file.

use std::path::Path;

use super::{Count, File, Lines, head};
use crate::matrix_market::coordinate;
use crate::{ReadError, lines};

/// Bytes at a time when a file is searched.
const PIECE: u64 = 1 << 24;

/// What stands before the entries.
#[derive(Debug)]
pub struct Matrix {
    head: coordinate::Head,
    before: Count,
    start: u64,
}

impl Matrix {
    /// Reads header and sizes.
    ///
    /// # Errors
    /// [`ReadError::Io`], or [`ReadError::Malformed`] with the line.
    pub fn of(file: &File) -> Result<Self, ReadError> {
        let head = head::read(file, true)?.unwrap_or(head::Head { text: Vec::new(), end: 0 });
        let mut lines = lines::Lines::new(&head.text);
        let read = coordinate::head(&mut lines).map_err(|at| at.of(file.path()))?;
        Ok(Self { head: read, before: Count { lines: lines.number(), items: 0 }, start: head.end })
    }

    /// Number of rows m.
    pub fn rows(&self) -> usize {
        self.head.rows
    }

    /// Number of columns n.
    pub fn columns(&self) -> usize {
        self.head.columns
    }

    /// Where the entries begin, in bytes.
    pub fn start(&self) -> u64 {
        self.start
    }

    /// Lines before the entries.
    pub fn before(&self) -> Count {
        self.before
    }

    /// The entries in these lines, before which so many stand; 0-based.
    ///
    /// # Errors
    /// [`ReadError::Malformed`] with the line.
    pub fn entries(&self, lines: &Lines, before: Count) -> Result<Vec<(usize, usize, f64)>, ReadError> {
        coordinate::entries(&mut lines.after(before.lines), &self.head, before.items).map_err(|at| at.of(lines.path()))
    }

    /// Whether the file has all entries that it promises, if so many were found.
    ///
    /// # Errors
    /// [`ReadError::Malformed`] if some are missing.
    pub fn check(&self, file: &File, found: usize) -> Result<(), ReadError> {
        self.head.complete(found).map_err(|at| at.of(file.path()))
    }
}

/// First and last line that give an entry of this 0-based row and column.
pub(crate) fn lines_of(path: &Path, row: usize, column: usize) -> Result<Option<(usize, usize)>, ReadError> {
    let file = File::open(path)?;
    let matrix = Matrix::of(&file)?;
    let (mut before, mut found) = (matrix.before.lines, None);
    let mut start = matrix.start;
    while start < file.len() {
        let part = file.lines(start..start.saturating_add(PIECE))?;
        let mut lines = part.after(before);
        let of_part = coordinate::lines_of(&mut lines, &matrix.head, (row, column)).map_err(|at| at.of(path))?;
        found = of_part.map(|(first, last)| (found.map_or(first, |(first, _)| first), last)).or(found);
        (before, start) = (lines.number().max(before), start.saturating_add(PIECE));
    }
    Ok(found)
}
