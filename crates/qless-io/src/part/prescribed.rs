//! Parts of a file of prescribed DOFs.

use std::path::Path;

use super::{Count, Given, Lines};
use crate::ReadError;
use crate::vectors::prescribed;

/// What these lines prescribe, before which so many stand, for a matrix of `columns` columns.
///
/// # Errors
/// [`ReadError::Malformed`] with the line.
pub fn given(lines: &Lines, before: Count, columns: usize) -> Result<Vec<Given>, ReadError> {
    prescribed::given(&mut lines.after(before.lines), columns).map_err(|at| at.of(lines.path()))
}

/// `(DOF, value)`, ascending by DOF, 0-based, of what lines of any parts prescribe, in the order of the file.
///
/// # Errors
/// [`ReadError::Malformed`] for one column with two values.
pub fn unite(path: &Path, given: Vec<Given>) -> Result<Vec<(usize, f64)>, ReadError> {
    prescribed::unite(given).map_err(|at| at.of(path))
}
