//! Readers of the chunks of a matrix, a right-hand side, prescribed values and labels.

use std::collections::BTreeMap;
use std::io::BufRead;
use std::path::Path;

use super::file::{ChunkedFile, FileChunk, FileHead, LineCount, read_head};
use crate::matrix_market::MatrixHead;
use crate::vectors::{self, PrescribedLine, RhsHead};
use crate::{ReadError, lines};

/// Bytes read at a time when a file is searched.
const SEARCHED: u64 = 1 << 24;

/// Header and sizes of a matrix file, and where its entries start.
#[derive(Debug)]
pub struct ChunkedMatrix {
    head: MatrixHead,
    before: LineCount,
    start: u64,
}

impl ChunkedMatrix {
    /// Reads header and sizes.
    ///
    /// # Errors
    /// [`ReadError::Io`], or [`ReadError::Malformed`] with the line.
    pub fn open(file: &ChunkedFile) -> Result<Self, ReadError> {
        let head = read_head(file, true)?.unwrap_or(FileHead { text: Vec::new(), end: 0 });
        let mut lines = lines::TextLines::new(&head.text);
        let read = MatrixHead::read(&mut lines).map_err(|at| at.in_file(file.path()))?;
        Ok(Self { head: read, before: LineCount { lines: lines.number(), items: 0 }, start: head.end })
    }

    /// Number of rows m.
    pub fn rows(&self) -> usize {
        self.head.rows
    }

    /// Number of columns n.
    pub fn columns(&self) -> usize {
        self.head.columns
    }

    /// Byte at which the entries start.
    pub fn start(&self) -> u64 {
        self.start
    }

    /// Lines before the entries.
    pub fn before(&self) -> LineCount {
        self.before
    }

    /// Parses the entries in a chunk; `before` counts the lines and entries in front of it. Indices are 0-based.
    ///
    /// # Errors
    /// [`ReadError::Malformed`] with the line.
    pub fn entries(&self, lines: &FileChunk, before: LineCount) -> Result<Vec<(usize, usize, f64)>, ReadError> {
        self.head.entries(&mut lines.after(before.lines), before.items).map_err(|at| at.in_file(lines.path()))
    }

    /// Checks that the whole file has all promised entries; `found` is their number.
    ///
    /// # Errors
    /// [`ReadError::Malformed`] if entries are missing.
    pub fn check(&self, file: &ChunkedFile, found: usize) -> Result<(), ReadError> {
        self.head.check_count(found).map_err(|at| at.in_file(file.path()))
    }
}

/// First and last line with an entry of this 0-based row and column.
pub(crate) fn lines_of(path: &Path, row: usize, column: usize) -> Result<Option<(usize, usize)>, ReadError> {
    let file = ChunkedFile::open(path)?;
    let matrix = ChunkedMatrix::open(&file)?;
    let (mut before, mut found) = (matrix.before.lines, None);
    let mut start = matrix.start;
    while start < file.len() {
        let chunk = file.lines(start..start.saturating_add(SEARCHED))?;
        let mut lines = chunk.after(before);
        let of_chunk = matrix.head.lines_of(&mut lines, (row, column)).map_err(|at| at.in_file(path))?;
        found = of_chunk.map(|(first, last)| (found.map_or(first, |(first, _)| first), last)).or(found);
        (before, start) = (lines.number().max(before), start.saturating_add(SEARCHED));
    }
    Ok(found)
}

/// Head of a file of right-hand sides, and where its numbers start.
#[derive(Debug)]
pub struct ChunkedRhs {
    head: RhsHead,
    before: LineCount,
    start: u64,
}

impl ChunkedRhs {
    /// Reads header and sizes, if there are any; the file must hold `rows` numbers.
    ///
    /// # Errors
    /// [`ReadError::Io`], or [`ReadError::Malformed`] with the line.
    pub fn open(file: &ChunkedFile, rows: usize) -> Result<Self, ReadError> {
        let Some(head) = read_head(file, false)? else {
            return Ok(Self { head: RhsHead::absent(rows), before: LineCount::default(), start: 0 });
        };
        let mut lines = lines::TextLines::new(&head.text);
        let read = RhsHead::read(&mut lines, rows).map_err(|at| at.in_file(file.path()))?;
        Ok(Self { head: read, before: LineCount { lines: lines.number(), items: 0 }, start: head.end })
    }

    /// Byte at which the numbers start.
    pub fn start(&self) -> u64 {
        self.start
    }

    /// Lines before the numbers.
    pub fn before(&self) -> LineCount {
        self.before
    }

    /// Parses the numbers in a chunk; `before` counts the lines and numbers in front of it. The first number belongs
    /// to row `before.items`, from 0.
    ///
    /// # Errors
    /// [`ReadError::Malformed`] with the line.
    pub fn numbers(&self, lines: &FileChunk, before: LineCount) -> Result<Vec<f64>, ReadError> {
        self.head.numbers(&mut lines.after(before.lines), before.items).map_err(|at| at.in_file(lines.path()))
    }

    /// Checks that the whole file has one number for each row; `found` is their number.
    ///
    /// # Errors
    /// [`ReadError::Malformed`] if not.
    pub fn check(&self, file: &ChunkedFile, found: usize) -> Result<(), ReadError> {
        self.head.check_count(found).map_err(|at| at.in_file(file.path()))
    }
}

/// Parses the prescribed values in a chunk for a matrix of `columns` columns; `before` counts the lines in front of
/// it.
///
/// # Errors
/// [`ReadError::Malformed`] with the line.
pub fn prescribed_lines(
    lines: &FileChunk,
    before: LineCount,
    columns: usize,
) -> Result<Vec<PrescribedLine>, ReadError> {
    vectors::prescribed_lines(&mut lines.after(before.lines), columns).map_err(|at| at.in_file(lines.path()))
}

/// Joins the prescribed values of all chunks, in the order of the file, into `(DOF, value)`: ascending by DOF,
/// 0-based.
///
/// # Errors
/// [`ReadError::Malformed`] for one column with two values.
pub fn merge_prescribed(path: &Path, prescribed: Vec<PrescribedLine>) -> Result<Vec<(usize, f64)>, ReadError> {
    vectors::merge_prescribed(prescribed).map_err(|at| at.in_file(path))
}

/// Checks that a file of labels has one for each of `expected` rows or columns. `lines` is its number of lines,
/// `last_filled` the last line that is not blank, from 1; `each` is "row" or "column".
///
/// # Errors
/// [`ReadError::Malformed`] if not.
pub fn check_labels(
    path: &Path,
    (lines, last_filled): (usize, usize),
    expected: usize,
    each: &'static str,
) -> Result<(), ReadError> {
    vectors::check_label_count(lines, last_filled, expected, each).map_err(|at| at.in_file(path))
}

/// Reads the labels of these rows or columns (0-based, ascending) in one pass over the file. Blank lines give no
/// label.
///
/// # Errors
/// [`ReadError::Io`].
///
/// ```
/// # let place = tempfile::tempdir()?;
/// let path = place.path().join("rows.txt");
/// std::fs::write(&path, "RBE2:130\n\ntie 7, leg 2\n")?;
/// let labels = qless_io::chunk::find_labels(&path, &[1, 2])?;
/// assert_eq!(labels.into_iter().collect::<Vec<_>>(), [(2, "tie 7, leg 2".to_owned())]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn find_labels(path: &Path, wanted: &[usize]) -> Result<BTreeMap<usize, String>, ReadError> {
    let file = ChunkedFile::open(path)?;
    let mut reader = file.reader()?;
    let (mut line, mut number, mut found) = (Vec::new(), 0, BTreeMap::new());
    for &index in wanted {
        while number <= index {
            line.clear();
            if reader.read_until(b'\n', &mut line).map_err(ReadError::io(path))? == 0 {
                return Ok(found);
            }
            number += 1;
        }
        let mut lines = if number == 1 { lines::TextLines::new(&line) } else { lines::TextLines::after(&line, 0) };
        let label = lines.any().map(|line| String::from_utf8_lossy(line.text).into_owned());
        found.extend(label.filter(|label| !label.trim().is_empty()).map(|label| (index, label)));
    }
    Ok(found)
}
