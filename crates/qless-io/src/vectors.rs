//! Reads the files beside `C.mtx`: right-hand side, prescribed values and labels, with one item on a line.
//!
//! Files of numbers may have blank lines and comments that start with `#` or `%`. In a file of labels, every line is a label. Columns count
//! from 1 in the files, and DOFs from 0 here.

use std::collections::BTreeMap;
use std::io::BufRead;
use std::path::Path;

use crate::ReadError;
use crate::error::read_file;
use crate::fault::{Quantity, TextFault, quote};
use crate::file_chunk::{ChunkedFile, FileChunk, LineCount};
use crate::lines::{TextLine, TextLines};
use crate::matrix_market::header::{self, FileHead};
use crate::number::whole;

const SIZES: &str = "rows 1";
const FORM: &str = "column value";

/// Reads the right-hand side of `rows` equations.
///
/// # Errors
/// [`ReadError::Io`], or [`ReadError::Malformed`] if a text is no finite number (with line and row) or if the number of values is wrong.
///
/// ```
/// use qless_io::vectors::read_rhs;
/// # let place = tempfile::tempdir()?;
/// let path = place.path().join("b.txt");
/// std::fs::write(&path, "# gaps in mm\n0.5\n1.0D-3\n")?;
/// assert_eq!(read_rhs(&path, 2)?, [0.5, 1e-3]);
///
/// let error = read_rhs(&path, 3).unwrap_err().to_string();
/// assert!(error.contains("b.txt: found 2 numbers, expected 3, one for each row"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn read_rhs(path: &Path, rows: usize) -> Result<Vec<f64>, ReadError> {
    let text = read_file(path)?;
    let mut lines = TextLines::new(path, &text);
    let head = ChunkedRhs::parse_head(path, &mut lines, rows, header::is_present(&text))?;
    let numbers = head.parse_numbers(&mut lines, 0)?;
    head.check_count(path, numbers.len())?;
    Ok(numbers)
}

/// The head of a file of right-hand sides, and the place where its numbers start. The head is empty, or is a Matrix Market header with
/// sizes.
#[derive(Debug)]
pub struct ChunkedRhs {
    rows: usize,
    is_integer: bool,
    before: LineCount,
    start: u64,
}

impl ChunkedRhs {
    /// Reads the header and the sizes, if there are any. The file must hold `rows` numbers.
    ///
    /// # Errors
    /// [`ReadError::Io`], or [`ReadError::Malformed`] with the line.
    pub fn open(file: &ChunkedFile, rows: usize) -> Result<Self, ReadError> {
        let head = FileHead::read(file, true)?;
        let mut lines = TextLines::new(file.path(), &head.text);
        let read = Self::parse_head(file.path(), &mut lines, rows, !head.text.is_empty())?;
        Ok(Self { start: head.end, ..read })
    }

    fn parse_head(path: &Path, lines: &mut TextLines, rows: usize, has_head: bool) -> Result<Self, ReadError> {
        let mut head = Self { rows, is_integer: false, before: LineCount::default(), start: 0 };
        if has_head {
            head.is_integer = header::read_vector(path, lines)?;
            check_sizes(path, lines, rows)?;
            head.before.lines = lines.number();
        }
        Ok(head)
    }

    /// The byte of the file at which the numbers start.
    pub fn start(&self) -> u64 {
        self.start
    }

    /// Counts of the lines that precede the numbers.
    pub fn before(&self) -> LineCount {
        self.before
    }

    /// Parses the numbers in a chunk. `before` counts the lines and numbers of the file that precede it. The first number of the chunk
    /// belongs to row `before.items`, counted from 0.
    ///
    /// # Errors
    /// [`ReadError::Malformed`] with the line.
    pub fn numbers(&self, lines: &FileChunk, before: LineCount) -> Result<Vec<f64>, ReadError> {
        self.parse_numbers(&mut lines.after(before.lines), before.items)
    }

    fn parse_numbers(&self, lines: &mut TextLines, before: usize) -> Result<Vec<f64>, ReadError> {
        let mut numbers = Vec::new();
        while let Some(line) = lines.content() {
            let [word] = line.fields().ok_or_else(|| line.malformed("one number"))?;
            let what = Quantity::RightHandSide { row: before + numbers.len() + 1 };
            numbers.push(line.number(word, what, self.is_integer)?);
        }
        Ok(numbers)
    }

    /// Checks that the file has one number for each row. `found` numbers were read from it.
    ///
    /// # Errors
    /// [`ReadError::Malformed`] if it has more or fewer.
    pub fn check(&self, file: &ChunkedFile, found: usize) -> Result<(), ReadError> {
        self.check_count(file.path(), found)
    }

    fn check_count(&self, path: &Path, found: usize) -> Result<(), ReadError> {
        if found == self.rows { Ok(()) } else { Err(ReadError::malformed(path, None, wrong_count(found, self.rows))) }
    }
}

fn check_sizes(path: &Path, lines: &mut TextLines, rows: usize) -> Result<(), ReadError> {
    let header = lines.number();
    let Some(line) = lines.content() else {
        return Err(ReadError::malformed(path, Some(header), TextFault::Sizes { expected: SIZES, found: quote(b"") }));
    };
    match line.fields().map(|[rows, columns]| (whole(rows), whole(columns))) {
        Some((Some(found), Some(1))) if found == rows => Ok(()),
        Some((Some(found), Some(1))) => Err(line.fault(wrong_count(found, rows))),
        _ => Err(line.fault(TextFault::Sizes { expected: SIZES, found: line.quote() })),
    }
}

fn wrong_count(found: usize, expected: usize) -> TextFault {
    TextFault::Count { what: "numbers", found, expected, each: "row" }
}

/// Reads the prescribed values for a matrix with `columns` columns, as pairs of DOF and value. DOFs ascend and count from 0.
///
/// A column may occur again with the same value.
///
/// # Errors
/// [`ReadError::Io`], or [`ReadError::Malformed`] if a column is out of range, a value is not finite, or a column has two different values.
/// In the last case the error names both lines.
///
/// ```
/// use qless_io::vectors::read_prescribed;
/// # let place = tempfile::tempdir()?;
/// let path = place.path().join("prescribed.txt");
/// std::fs::write(&path, "# column(1-based) value\n3 0.0\n1 2.5\n")?;
/// assert_eq!(read_prescribed(&path, 3)?, [(0, 2.5), (2, 0.0)]);
///
/// std::fs::write(&path, "3 0.0\n3 1.0\n")?;
/// let error = read_prescribed(&path, 3).unwrap_err().to_string();
/// assert!(error.contains("prescribed.txt:2: column 3 is prescribed as 1, but line 1 prescribes 0"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn read_prescribed(path: &Path, columns: usize) -> Result<Vec<(usize, f64)>, ReadError> {
    let text = read_file(path)?;
    merge_prescribed(path, parse_prescribed(&mut TextLines::new(path, &text), columns)?)
}

/// A line that prescribes a value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrescribedLine {
    /// The column, from 1.
    pub column: usize,
    /// The prescribed value.
    pub value: f64,
    /// The number of the line.
    pub line: usize,
}

/// Parses the prescribed values in a chunk, for a matrix with `columns` columns. `before` counts the lines of the file that precede the
/// chunk.
///
/// # Errors
/// [`ReadError::Malformed`] with the line.
pub fn prescribed_lines(
    lines: &FileChunk,
    before: LineCount,
    columns: usize,
) -> Result<Vec<PrescribedLine>, ReadError> {
    parse_prescribed(&mut lines.after(before.lines), columns)
}

fn parse_prescribed(lines: &mut TextLines, columns: usize) -> Result<Vec<PrescribedLine>, ReadError> {
    let mut prescribed = Vec::new();
    while let Some(line) = lines.content() {
        prescribed.push(prescribed_line(&line, columns)?);
    }
    Ok(prescribed)
}

fn prescribed_line(line: &TextLine, columns: usize) -> Result<PrescribedLine, ReadError> {
    let [word, value] = line.fields().ok_or_else(|| line.malformed(FORM))?;
    let column = whole(word).ok_or_else(|| line.malformed(FORM))?;
    if column == 0 || column > columns {
        return Err(line.fault(TextFault::OutOfRange { what: "column", found: quote(word), size: columns }));
    }
    let value = line.number(value, Quantity::Prescribed { column }, false)?;
    Ok(PrescribedLine { column, value, line: line.number })
}

/// Joins the prescribed values of all chunks, given in the order of the file, into pairs of DOF and value. DOFs ascend and count from 0.
///
/// # Errors
/// [`ReadError::Malformed`] if a column has two different values.
pub fn merge_prescribed(path: &Path, mut prescribed: Vec<PrescribedLine>) -> Result<Vec<(usize, f64)>, ReadError> {
    // The sort is stable, so of two lines for a column the earlier one stays first.
    prescribed.sort_by_key(|line| line.column);
    let differ = |pair: &&[PrescribedLine]| pair[0].column == pair[1].column && pair[0].value != pair[1].value;
    if let Some([first, second]) = prescribed.windows(2).find(differ) {
        let PrescribedLine { column, value, line } = *first;
        let fault = TextFault::PrescribedTwice { column, first: value, first_line: line, second: second.value };
        return Err(ReadError::malformed(path, Some(second.line), fault));
    }
    prescribed.dedup_by_key(|line| line.column);
    Ok(prescribed.iter().map(|line| (line.column - 1, line.value)).collect())
}

/// Reads one label for each of `expected` rows or columns; `each` is "row" or "column".
///
/// A label may contain blanks and `#`; an empty line is an empty label. Invalid UTF-8 is replaced. Empty lines at the
/// end of the file are ignored.
///
/// # Errors
/// [`ReadError::Io`], or [`ReadError::Malformed`] if the number of labels is wrong.
///
/// ```
/// use qless_io::vectors::read_labels;
/// # let place = tempfile::tempdir()?;
/// let path = place.path().join("rows.txt");
/// std::fs::write(&path, "RBE2:130\ntie 7, leg 2\n")?;
/// assert_eq!(read_labels(&path, 2, "row")?, ["RBE2:130", "tie 7, leg 2"]);
///
/// let error = read_labels(&path, 3, "row").unwrap_err().to_string();
/// assert!(error.contains("rows.txt: found 2 labels, expected 3, one for each row"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn read_labels(path: &Path, expected: usize, each: &'static str) -> Result<Vec<String>, ReadError> {
    let text = read_file(path)?;
    let mut lines = TextLines::new(path, &text);
    let mut labels = Vec::new();
    while let Some(line) = lines.any() {
        labels.push(String::from_utf8_lossy(line.text).into_owned());
    }
    let last_filled = labels.iter().rposition(|label| !label.trim().is_empty()).map_or(0, |last| last + 1);
    check_labels(path, (labels.len(), last_filled), expected, each)?;
    labels.truncate(expected);
    Ok(labels)
}

/// Checks that a file of labels has one label for each of `expected` rows or columns. `lines` is the number of its lines, and `last_filled`
/// is its last line that is not blank, from 1. `each` is "row" or "column".
///
/// # Errors
/// [`ReadError::Malformed`] if it has more or fewer labels.
pub fn check_labels(
    path: &Path,
    (lines, last_filled): (usize, usize),
    expected: usize,
    each: &'static str,
) -> Result<(), ReadError> {
    let found = if lines > expected { last_filled.max(expected) } else { lines };
    if found == expected {
        return Ok(());
    }
    Err(ReadError::malformed(path, None, TextFault::Count { what: "labels", found, expected, each }))
}

/// Reads the labels of the rows or columns in `wanted` (from 0, ascending), in one pass over the file. A blank line gives no label.
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
    let mut reader = ChunkedFile::open(path)?.reader()?;
    let (mut line, mut number, mut found) = (Vec::new(), 0, BTreeMap::new());
    for &index in wanted {
        while number <= index {
            line.clear();
            if reader.read_until(b'\n', &mut line).map_err(ReadError::io(path))? == 0 {
                return Ok(found);
            }
            number += 1;
        }
        let mut lines =
            if number == 1 { TextLines::new(path, &line) } else { TextLines::after(path, &line, number - 1) };
        let label = lines.any().map(|line| String::from_utf8_lossy(line.text).into_owned());
        found.extend(label.filter(|label| !label.trim().is_empty()).map(|label| (index, label)));
    }
    Ok(found)
}
