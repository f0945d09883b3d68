//! Prescribed DOFs: `column value` a line, columns counted from 1.

use std::path::Path;

use crate::ReadError;
use crate::error::{At, parse_file};
use crate::fault::{Fault, Quantity, quote};
use crate::lines::{Line, Lines};
use crate::number::{real, whole};

const FORM: &str = "column value";

/// Reads `(DOF, value)` for a matrix of `columns` columns, ascending by DOF; 0-based.
///
/// The same column with the same value twice is accepted.
///
/// # Errors
/// [`ReadError::Io`], or [`ReadError::Malformed`] for a column out of range, a value that is not
/// finite, or one column with two values, which names both lines.
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
    parse_file(path, |bytes| parse(bytes, columns))
}

/// What one line prescribes; the column counts from 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Given {
    /// The column.
    pub column: usize,
    /// Its value.
    pub value: f64,
    /// The line.
    pub line: usize,
}

fn parse(bytes: &[u8], columns: usize) -> Result<Vec<(usize, f64)>, At> {
    unite(given(&mut Lines::new(bytes), columns)?)
}

/// What these lines prescribe.
pub(crate) fn given(lines: &mut Lines, columns: usize) -> Result<Vec<Given>, At> {
    let mut given = Vec::new();
    while let Some(line) = lines.content() {
        given.push(entry(&line, columns)?);
    }
    Ok(given)
}

/// Values by DOF, of lines in the order of the file.
pub(crate) fn unite(mut given: Vec<Given>) -> Result<Vec<(usize, f64)>, At> {
    // Stable, so the earlier line stays first.
    given.sort_by_key(|given| given.column);
    given.windows(2).try_for_each(check_pair)?;
    given.dedup_by_key(|given| given.column);
    Ok(given.iter().map(|given| (given.column - 1, given.value)).collect())
}

fn entry(line: &Line, columns: usize) -> Result<Given, At> {
    let [word, value] = line.fields().ok_or_else(|| line.malformed(FORM))?;
    let column = whole(word).ok_or_else(|| line.malformed(FORM))?;
    if column == 0 || column > columns {
        return Err(line.fault(Fault::OutOfRange { what: "column", found: quote(word), size: columns }));
    }
    let what = Quantity::Prescribed { column };
    let number = real(value).map_err(|problem| line.fault(Fault::Number { what, found: quote(value), problem }))?;
    Ok(Given { column, value: number, line: line.number })
}

fn check_pair(pair: &[Given]) -> Result<(), At> {
    let [first, second] = pair else { return Ok(()) };
    if first.column != second.column || first.value == second.value {
        return Ok(());
    }
    Err(At::line(
        second.line,
        Fault::PrescribedTwice {
            column: first.column,
            first: first.value,
            first_line: first.line,
            second: second.value,
        },
    ))
}
