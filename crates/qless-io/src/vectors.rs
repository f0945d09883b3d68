//! The files beside `C.mtx`, with one item a line: right-hand side, prescribed values, labels.
//!
//! Files of numbers may have blank lines and `#` or `%` comments; in a file of labels every line is a label. Columns
//! count from 1 in the files, DOFs from 0 here.

use std::path::Path;

use crate::ReadError;
use crate::error::{FaultAt, parse_file};
use crate::fault::{NumberFault, Quantity, TextFault, quote};
use crate::lines::{TextLine, TextLines};
use crate::matrix_market::header::{self, MarketHeader, MarketLayout};
use crate::number::{real, whole};

const SIZES: &str = "rows 1";
const FORM: &str = "column value";

/// Reads the right-hand side of `rows` equations.
///
/// # Errors
/// [`ReadError::Io`], or [`ReadError::Malformed`] for text that is no finite number (with line and row) and for a
/// wrong number of values.
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
    parse_file(path, |bytes| {
        let mut lines = TextLines::new(bytes);
        let head = if header::is_present(bytes) { RhsHead::read(&mut lines, rows)? } else { RhsHead::absent(rows) };
        let numbers = head.numbers(&mut lines, 0)?;
        head.check_count(numbers.len())?;
        Ok(numbers)
    })
}

/// Head of a file of right-hand sides: nothing, or a Matrix Market header and sizes.
#[derive(Debug)]
pub(crate) struct RhsHead {
    rows: usize,
    integer: bool,
}

impl RhsHead {
    /// Head of a file without header.
    pub(crate) fn absent(rows: usize) -> Self {
        Self { rows, integer: false }
    }

    pub(crate) fn read(lines: &mut TextLines, rows: usize) -> Result<Self, FaultAt> {
        let header = header::read(lines, MarketLayout::Array)?;
        check_sizes(lines, &header, rows)?;
        Ok(Self { rows, integer: header.integer })
    }

    /// Parses the numbers in these lines, which follow `before` others.
    pub(crate) fn numbers(&self, lines: &mut TextLines, before: usize) -> Result<Vec<f64>, FaultAt> {
        let mut numbers = Vec::new();
        while let Some(line) = lines.content() {
            numbers.push(number(&line, before + numbers.len() + 1, self.integer)?);
        }
        Ok(numbers)
    }

    /// Checks that there is one number for each row.
    pub(crate) fn check_count(&self, found: usize) -> Result<(), FaultAt> {
        if found == self.rows { Ok(()) } else { Err(FaultAt::whole_file(wrong_count(found, self.rows))) }
    }
}

fn check_sizes(lines: &mut TextLines, header: &MarketHeader, rows: usize) -> Result<(), FaultAt> {
    let Some(line) = lines.content() else {
        return Err(FaultAt::line(header.line, TextFault::Sizes { expected: SIZES, found: quote(b"") }));
    };
    match line.fields().map(|[rows, columns]| (whole(rows), whole(columns))) {
        Some((Some(found), Some(1))) if found == rows => Ok(()),
        Some((Some(found), Some(1))) => Err(line.fault(wrong_count(found, rows))),
        _ => Err(line.fault(TextFault::Sizes { expected: SIZES, found: line.quote() })),
    }
}

fn number(line: &TextLine, row: usize, integer: bool) -> Result<f64, FaultAt> {
    let [word] = line.fields().ok_or_else(|| line.malformed("one number"))?;
    match real(word) {
        Ok(number) if !integer || number.fract() == 0.0 => Ok(number),
        other => Err(line.fault(TextFault::Number {
            what: Quantity::RightHandSide { row },
            found: quote(word),
            problem: other.err().unwrap_or(NumberFault::NotAnInteger),
        })),
    }
}

fn wrong_count(found: usize, expected: usize) -> TextFault {
    TextFault::Count { what: "numbers", found, expected, each: "row" }
}

/// Reads `(DOF, value)` for a matrix of `columns` columns; ascending by DOF, 0-based.
///
/// A column may repeat with the same value.
///
/// # Errors
/// [`ReadError::Io`], or [`ReadError::Malformed`] for a column out of range, a value that is not finite, or one column
/// with two values; the error names both lines.
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
    parse_file(path, |bytes| merge_prescribed(prescribed_lines(&mut TextLines::new(bytes), columns)?))
}

/// One line of prescribed values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrescribedLine {
    /// Column, from 1.
    pub column: usize,
    /// Prescribed value.
    pub value: f64,
    /// Line number.
    pub line: usize,
}

/// Parses lines of prescribed values.
pub(crate) fn prescribed_lines(lines: &mut TextLines, columns: usize) -> Result<Vec<PrescribedLine>, FaultAt> {
    let mut prescribed = Vec::new();
    while let Some(line) = lines.content() {
        prescribed.push(prescribed_line(&line, columns)?);
    }
    Ok(prescribed)
}

/// Joins prescribed values, in the order of the file, into values by DOF.
pub(crate) fn merge_prescribed(mut prescribed: Vec<PrescribedLine>) -> Result<Vec<(usize, f64)>, FaultAt> {
    // The sort is stable, so that the earlier line stays first.
    prescribed.sort_by_key(|line| line.column);
    prescribed.windows(2).try_for_each(check_pair)?;
    prescribed.dedup_by_key(|line| line.column);
    Ok(prescribed.iter().map(|line| (line.column - 1, line.value)).collect())
}

fn prescribed_line(line: &TextLine, columns: usize) -> Result<PrescribedLine, FaultAt> {
    let [word, value] = line.fields().ok_or_else(|| line.malformed(FORM))?;
    let column = whole(word).ok_or_else(|| line.malformed(FORM))?;
    if column == 0 || column > columns {
        return Err(line.fault(TextFault::OutOfRange { what: "column", found: quote(word), size: columns }));
    }
    let what = Quantity::Prescribed { column };
    let number = real(value).map_err(|problem| line.fault(TextFault::Number { what, found: quote(value), problem }))?;
    Ok(PrescribedLine { column, value: number, line: line.number })
}

fn check_pair(pair: &[PrescribedLine]) -> Result<(), FaultAt> {
    let [first, second] = pair else { return Ok(()) };
    if first.column != second.column || first.value == second.value {
        return Ok(());
    }
    Err(FaultAt::line(
        second.line,
        TextFault::PrescribedTwice {
            column: first.column,
            first: first.value,
            first_line: first.line,
            second: second.value,
        },
    ))
}

/// Reads one label for each of `expected` rows or columns; `each` is "row" or "column".
///
/// A label may contain blanks and `#`; an empty line is an empty label. Invalid UTF-8 is replaced. Empty lines at the
/// end of the file are ignored.
///
/// # Errors
/// [`ReadError::Io`], or [`ReadError::Malformed`] for a wrong number of labels.
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
    parse_file(path, |bytes| {
        let mut lines = TextLines::new(bytes);
        let mut labels = Vec::new();
        while let Some(line) = lines.any() {
            labels.push(String::from_utf8_lossy(line.text).into_owned());
        }
        let filled = labels.iter().rposition(|label| !label.trim().is_empty()).map_or(0, |last| last + 1);
        check_label_count(labels.len(), filled, expected, each)?;
        labels.truncate(expected);
        Ok(labels)
    })
}

/// Checks that there is one label for each row or column. `filled` is the last line that is not empty, from 1.
pub(crate) fn check_label_count(
    lines: usize,
    filled: usize,
    expected: usize,
    each: &'static str,
) -> Result<(), FaultAt> {
    let found = if lines > expected { filled.max(expected) } else { lines };
    if found == expected {
        return Ok(());
    }
    Err(FaultAt::whole_file(TextFault::Count { what: "labels", found, expected, each }))
}
