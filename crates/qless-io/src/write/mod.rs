//! Writes output files: Matrix Market matrices, files with a number on each line, and files with an index, from 1, on each line.
//!
//! Numbers have the fewest digits that read back as the same 64-bit float. [`Output`] creates missing folders, [`OneFile`] does not.
//!
//! All files of one call are first written as hidden files beside their final places, and then renamed. So no file is ever half written.
//! Only two kinds of other files are removed: unchanged ones of an earlier set, and those that the caller names. A set of files has a
//! [`Manifest`](crate::Manifest), which says whether all of them are in place. [`Manifest::check`](crate::Manifest::check) compares the
//! files with the manifest. A new file takes over the mode of the old one, and its owner and group if permitted.
//!
//! | the program ends | state of the folder |
//! | --- | --- |
//! | while files are written | the old files; a signal that cannot be caught also leaves hidden files, which the next writer removes |
//! | while files are renamed (error, or uncatchable signal) | an incomplete set, as its manifest says; the next writer replaces it |
//! | after that | the new files |
//!
//! | module | content, lowest layer first |
//! | --- | --- |
//! | `inputs` | [`Inputs`]: files that no output may replace |
//! | `metadata` | mode, owner, group and links of files |
//! | `text` | matrices, numbers and indices as text |
//! | `scratch` | hidden files and the locks of their writers; [`abandon`] removes them when a signal ends the program |
//! | `output`, `one_file` | [`Output`], a set of files for a folder; [`OneFile`], a single file |

mod inputs;
mod metadata;
mod one_file;
mod output;
mod scratch;
mod text;

use std::path::Path;

use qless::{ConstraintSystem, Csr};

use crate::WriteError;
pub use inputs::Inputs;
pub use one_file::OneFile;
pub use output::Output;
pub use scratch::{abandon, abandon_unless_at_work, is_at_work};

/// Writes `C.mtx`, `b.txt` and, if there are any, `prescribed.txt`, `rows.txt` and `cols.txt`.
///
/// Each of the last three is removed from the folder if the system has no such data. Labels are written if any of them differs from its
/// default, the number of the row or column.
///
/// # Errors
/// Those of [`Output::commit`].
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
    let mut output = Output::new(folder)?.by("qless_io::write_case");
    output.case(system)?;
    output.commit()
}

/// Writes a matrix as a Matrix Market file, `coordinate real general`.
///
/// # Errors
/// [`WriteError`]. A file is then unchanged, but a device or pipe may have received part of the text.
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
    OneFile::at(path, Inputs::default())?.put(|out| text::matrix(out, matrix))
}

/// Writes numbers, one on each line.
///
/// # Errors
/// [`WriteError`]. A file is then unchanged, but a device or pipe may have received part of the text.
///
/// ```
/// # let place = tempfile::tempdir()?;
/// let path = place.path().join("g.txt");
/// qless_io::write::write_numbers(&path, &[0.1, 1e300])?;
/// assert_eq!(std::fs::read_to_string(&path)?, "0.1\n1e300\n");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_numbers(path: &Path, numbers: &[f64]) -> Result<(), WriteError> {
    OneFile::at(path, Inputs::default())?.put(|out| text::numbers(out, numbers))
}

/// Writes indices, one on each line. They count from 0 here and from 1 in the file.
///
/// # Errors
/// [`WriteError`]. A file is then unchanged, but a device or pipe may have received part of the text.
///
/// ```
/// # let place = tempfile::tempdir()?;
/// let path = place.path().join("slaves.txt");
/// qless_io::write::write_indices(&path, &[0, 4])?;
/// assert_eq!(std::fs::read_to_string(&path)?, "1\n5\n");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_indices(path: &Path, indices: &[usize]) -> Result<(), WriteError> {
    OneFile::at(path, Inputs::default())?.put(|out| text::indices(out, indices))
}
