//! b: one number a line, or a Matrix Market `array real general` of one column.

use std::path::Path;

use crate::ReadError;
use crate::error::{At, parse_file};
use crate::fault::{Fault, NumberFault, Quantity, quote};
use crate::lines::{Line, Lines};
use crate::matrix_market::header::{self, Header, Layout};
use crate::number::{real, whole};

const SIZES: &str = "rows 1";

/// Reads the right-hand side of `rows` equations.
///
/// # Errors
/// [`ReadError::Io`], or [`ReadError::Malformed`] for what is no finite number (with line and row) or
/// another count than `rows`.
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
    parse_file(path, |bytes| parse(bytes, rows))
}

/// What stands before the numbers: nothing, or header and sizes.
#[derive(Debug)]
pub(crate) struct Head {
    rows: usize,
    integer: bool,
}

fn parse(bytes: &[u8], rows: usize) -> Result<Vec<f64>, At> {
    let mut lines = Lines::new(bytes);
    let head = if header::is_present(bytes) { headed(&mut lines, rows)? } else { headless(rows) };
    let numbers = numbers(&mut lines, &head, 0)?;
    head.complete(numbers.len())?;
    Ok(numbers)
}

pub(crate) fn headless(rows: usize) -> Head {
    Head { rows, integer: false }
}

pub(crate) fn headed(lines: &mut Lines, rows: usize) -> Result<Head, At> {
    let header = header::read(lines, Layout::Array)?;
    check_sizes(lines, &header, rows)?;
    Ok(Head { rows, integer: header.integer })
}

/// The numbers in these lines, which come after `before` others.
pub(crate) fn numbers(lines: &mut Lines, head: &Head, before: usize) -> Result<Vec<f64>, At> {
    let mut numbers = Vec::new();
    while let Some(line) = lines.content() {
        numbers.push(number(&line, before + numbers.len() + 1, head.integer)?);
    }
    Ok(numbers)
}

impl Head {
    /// Whether there is one number for each row, if so many were found.
    pub(crate) fn complete(&self, found: usize) -> Result<(), At> {
        if found == self.rows { Ok(()) } else { Err(At::whole_file(wrong_count(found, self.rows))) }
    }
}

fn check_sizes(lines: &mut Lines, header: &Header, rows: usize) -> Result<(), At> {
    let Some(line) = lines.content() else {
        return Err(At::line(header.line, Fault::Sizes { expected: SIZES, found: quote(b"") }));
    };
    match line.fields().map(|[rows, columns]| (whole(rows), whole(columns))) {
        Some((Some(found), Some(1))) if found == rows => Ok(()),
        Some((Some(found), Some(1))) => Err(line.fault(wrong_count(found, rows))),
        _ => Err(line.fault(Fault::Sizes { expected: SIZES, found: line.quote() })),
    }
}

fn number(line: &Line, row: usize, integer: bool) -> Result<f64, At> {
    let [word] = line.fields().ok_or_else(|| line.malformed("one number"))?;
    match real(word) {
        Ok(number) if !integer || number.fract() == 0.0 => Ok(number),
        other => Err(line.fault(Fault::Number {
            what: Quantity::RightHandSide { row },
            found: quote(word),
            problem: other.err().unwrap_or(NumberFault::NotAnInteger),
        })),
    }
}

fn wrong_count(found: usize, expected: usize) -> Fault {
    Fault::Count { what: "numbers", found, expected, each: "row" }
}
