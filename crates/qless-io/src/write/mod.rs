//! Output files: Matrix Market matrices, numbers one a line, 1-based indices one a line.
//!
//! Numbers have the fewest digits that read back as the same 64-bit float. All files of one call are
//! written to a hidden folder beside their place, then moved there; if anything fails, what was there
//! before is there again and nothing else is left. Missing folders are created.
//!
//! [`Output`] does this for any set of files; the functions are its common uses.

mod commit;
mod output;
mod text;

use std::path::Path;

use qless::{ConstraintSystem, Csr};

use crate::WriteError;
pub use output::Output;

/// Writes `C.mtx`, `b.txt` and, if there are any, `prescribed.txt`, `rows.txt` and `cols.txt`.
///
/// Those of the last three that the folder holds of an earlier case are removed. Labels are written if
/// any differs from the plain number that stands where there is none.
///
/// # Errors
/// [`WriteError`]; then the folder is as it was.
///
/// ```
/// # let place = tempfile::tempdir()?;
/// let folder = place.path().join("models/tie");
/// let system = qless::ConstraintSystem::from_triplets(1, 2, &[(0, 0, 0.1), (0, 1, -1.0)], &[0.5], &[(1, 2.0)])?;
/// qless_io::write_case(&folder, &system)?;
/// assert_eq!(
///     std::fs::read_to_string(folder.join("C.mtx"))?,
///     "%%MatrixMarket matrix coordinate real general\n1 2 2\n1 1 0.1\n1 2 -1.0\n"
/// );
/// assert_eq!(std::fs::read_to_string(folder.join("prescribed.txt"))?, "# column(1-based) value\n2 2.0\n");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_case(folder: &Path, system: &ConstraintSystem) -> Result<(), WriteError> {
    let mut output = Output::new(folder)?;
    output.matrix("C.mtx", system.matrix())?;
    output.numbers("b.txt", system.rhs())?;
    if system.prescribed().is_empty() {
        output.absent("prescribed.txt");
    } else {
        output.file("prescribed.txt", |out| text::prescribed(out, system.prescribed()))?;
    }
    output.labels("rows.txt", system.equation_labels())?;
    output.labels("cols.txt", system.dof_labels())?;
    output.commit()
}

/// Writes a matrix as `coordinate real general`.
///
/// # Errors
/// [`WriteError`]; then nothing has changed.
///
/// ```
/// # let place = tempfile::tempdir()?;
/// let path = place.path().join("T.mtx");
/// let mut matrix = qless::Csr::empty(3);
/// matrix.push_row([(0, 1e-7), (2, -2.0)])?;
/// qless_io::write::write_matrix(&path, &matrix)?;
/// assert_eq!(qless_io::matrix_market::read(&path)?.entries, [(0, 0, 1e-7), (0, 2, -2.0)]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_matrix(path: &Path, matrix: &Csr) -> Result<(), WriteError> {
    one_file(path, |output, name| output.matrix(name, matrix))
}

/// Writes numbers, one a line.
///
/// # Errors
/// [`WriteError`]; then nothing has changed.
///
/// ```
/// # let place = tempfile::tempdir()?;
/// let path = place.path().join("g.txt");
/// qless_io::write::write_numbers(&path, &[0.1, 1e300])?;
/// assert_eq!(std::fs::read_to_string(&path)?, "0.1\n1e300\n");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_numbers(path: &Path, numbers: &[f64]) -> Result<(), WriteError> {
    one_file(path, |output, name| output.numbers(name, numbers))
}

/// Writes 0-based indices, one a line, as 1-based ones.
///
/// # Errors
/// [`WriteError`]; then nothing has changed.
///
/// ```
/// # let place = tempfile::tempdir()?;
/// let path = place.path().join("slaves.txt");
/// qless_io::write::write_indices(&path, &[0, 4])?;
/// assert_eq!(std::fs::read_to_string(&path)?, "1\n5\n");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_indices(path: &Path, indices: &[usize]) -> Result<(), WriteError> {
    one_file(path, |output, name| output.indices(name, indices))
}

/// Writes a file of these bytes, whole or not at all.
///
/// # Errors
/// [`WriteError`]; then nothing has changed.
///
/// ```
/// # let place = tempfile::tempdir()?;
/// let path = place.path().join("clean.inp");
/// qless_io::write::write_bytes(&path, b"*NODE\n")?;
/// assert_eq!(std::fs::read(&path)?, b"*NODE\n");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_bytes(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    one_file(path, |output, name| output.file(name, |out| out.write_all(bytes)))
}

fn one_file(path: &Path, add: impl FnOnce(&mut Output, &str) -> Result<(), WriteError>) -> Result<(), WriteError> {
    let (Some(folder), Some(name)) = (path.parent(), path.file_name().and_then(|name| name.to_str())) else {
        return Err(WriteError::NotAFile { path: path.to_path_buf() });
    };
    let mut output = Output::new(folder)?;
    add(&mut output, name)?;
    output.commit()
}
