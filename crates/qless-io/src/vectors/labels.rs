//! Labels of equations or DOFs: one a line, taken as it stands.

use std::path::Path;

use crate::ReadError;
use crate::error::{At, parse_file};
use crate::fault::Fault;
use crate::lines::Lines;

/// Reads one label for each of `expected` rows or columns (`each` says which).
///
/// A label may hold blanks and `#`; an empty line is an empty label. Bytes that are not UTF-8 are
/// replaced. Empty lines at the end of the file are passed over.
///
/// # Errors
/// [`ReadError::Io`], or [`ReadError::Malformed`] for another number of labels.
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
    parse_file(path, |bytes| parse(bytes, expected, each))
}

fn parse(bytes: &[u8], expected: usize, each: &'static str) -> Result<Vec<String>, At> {
    let mut lines = Lines::new(bytes);
    let mut labels = Vec::new();
    while let Some(line) = lines.any() {
        labels.push(String::from_utf8_lossy(line.text).into_owned());
    }
    let filled = labels.iter().rposition(|label| !label.trim().is_empty()).map_or(0, |last| last + 1);
    complete(labels.len(), filled, expected, each)?;
    labels.truncate(expected);
    Ok(labels)
}

/// Whether there is one label for each row or column in so many lines, the last of which that is not empty is line `filled`.
pub(crate) fn complete(lines: usize, filled: usize, expected: usize, each: &'static str) -> Result<(), At> {
    let found = if lines > expected { filled.max(expected) } else { lines };
    if found == expected {
        return Ok(());
    }
    Err(At::whole_file(Fault::Count { what: "labels", found, expected, each }))
}
