//! Some of the labels in a file of them.

use std::collections::BTreeMap;
use std::io::BufRead;
use std::path::Path;

use super::File;
use crate::ReadError;
use crate::lines::Lines;
use crate::vectors::labels;

/// Whether there is one label for each of `expected` rows or columns (`each` says which) in so many lines, `last_filled` being the
/// last that is not blank, from 1.
///
/// # Errors
/// [`ReadError::Malformed`] if not.
pub fn check_labels(
    path: &Path,
    (lines, last_filled): (usize, usize),
    expected: usize,
    each: &'static str,
) -> Result<(), ReadError> {
    labels::complete(lines, last_filled, expected, each).map_err(|at| at.of(path))
}

/// The labels of these rows or columns, 0-based and ascending, in one pass over the file; none for one whose line is blank.
///
/// # Errors
/// [`ReadError::Io`].
///
/// ```
/// # let place = tempfile::tempdir()?;
/// let path = place.path().join("rows.txt");
/// std::fs::write(&path, "RBE2:130\n\ntie 7, leg 2\n")?;
/// let labels = qless_io::part::find_labels(&path, &[1, 2])?;
/// assert_eq!(labels.into_iter().collect::<Vec<_>>(), [(2, "tie 7, leg 2".to_owned())]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn find_labels(path: &Path, wanted: &[usize]) -> Result<BTreeMap<usize, String>, ReadError> {
    let file = File::open(path)?;
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
        let mut lines = if number == 1 { Lines::new(&line) } else { Lines::after(&line, 0) };
        let label = lines.any().map(|line| String::from_utf8_lossy(line.text).into_owned());
        found.extend(label.filter(|label| !label.trim().is_empty()).map(|label| (index, label)));
    }
    Ok(found)
}
