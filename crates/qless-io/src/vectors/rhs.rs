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

fn parse(bytes: &[u8], rows: usize) -> Result<Vec<f64>, At> {
    let mut lines = Lines::new(bytes);
    let mut integer = false;
    if header::is_present(bytes) {
        let header = header::read(&mut lines, Layout::Array)?;
        check_sizes(&mut lines, &header, rows)?;
        integer = header.integer;
    }
    let mut numbers = Vec::new();
    while let Some(line) = lines.content() {
        numbers.push(number(&line, numbers.len() + 1, integer)?);
    }
    if numbers.len() == rows { Ok(numbers) } else { Err(At::whole_file(wrong_count(numbers.len(), rows))) }
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
