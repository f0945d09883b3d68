//! Writes output files: Matrix Market matrices, numbers one a line, 1-based indices one a line.
//!
//! Numbers have the fewest digits that read back as the same 64-bit float. Missing folders are created.
//!
//! All files of one call are first written to a hidden folder, and then put in place at once. Readers see either the
//! old files or the new ones, even if the program is killed. After an error the old files are in place, and nothing
//! else is left. A new file takes over the mode of the old one, and its owner and group if permitted.
//!
//! | module | content, lowest layer first |
//! | --- | --- |
//! | `inputs` | [`Inputs`]: files that no output may replace |
//! | `metadata` | mode, owner, group and links of files |
//! | `stage` | hidden folders for new files, and the lock of their writers; [`abandon`] removes them when a signal ends the program |
//! | `moves`, `switch` | put files in place: one by one, or by an exchange of folders |
//! | `commit` | chooses between the two, with a table of what a kill leaves behind |
//! | `output`, `one_file` | [`Output`], a set of files for a folder; [`OneFile`], a single file |

mod commit;
mod inputs;
mod metadata;
mod moves;
mod one_file;
mod output;
mod stage;
#[cfg(any(target_os = "linux", target_vendor = "apple"))]
mod switch;
/// Without exchange of folders, files are moved one by one.
#[cfg(not(any(target_os = "linux", target_vendor = "apple")))]
mod switch {
    use std::path::Path;

    use super::moves::FolderChange;
    use super::stage::{Stage, WriteLock};
    use crate::WriteError;

    pub(super) fn replace(_: &Path, _: &Stage, _: &FolderChange, _: &WriteLock) -> Option<Result<(), WriteError>> {
        None
    }
}

use std::path::Path;

use qless::{ConstraintSystem, Csr};

use crate::WriteError;
pub use inputs::Inputs;
pub use one_file::OneFile;
pub use output::Output;
use output::write_prescribed;
pub use stage::{abandon, abandon_unless_at_work, is_at_work};

/// Writes `C.mtx`, `b.txt` and, if there are any, `prescribed.txt`, `rows.txt` and `cols.txt`.
///
/// The last three are removed from the folder if the system has no such data. Labels are written if any differs from
/// the default, its number.
///
/// # Errors
/// [`WriteError`]; the folder is then unchanged.
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
        output.absent("prescribed.txt")?;
    } else {
        output.file("prescribed.txt", |out| write_prescribed(out, system.prescribed()))?;
    }
    output.labels("rows.txt", system.equation_labels())?;
    output.labels("cols.txt", system.dof_labels())?;
    output.commit()
}

/// Writes a matrix as `coordinate real general`.
///
/// # Errors
/// [`WriteError`]; nothing has then changed.
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
    OneFile::at(path, Inputs::default())?.put(|output, name| output.matrix(name, matrix))
}

/// Writes numbers, one a line.
///
/// # Errors
/// [`WriteError`]; nothing has then changed.
///
/// ```
/// # let place = tempfile::tempdir()?;
/// let path = place.path().join("g.txt");
/// qless_io::write::write_numbers(&path, &[0.1, 1e300])?;
/// assert_eq!(std::fs::read_to_string(&path)?, "0.1\n1e300\n");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_numbers(path: &Path, numbers: &[f64]) -> Result<(), WriteError> {
    OneFile::at(path, Inputs::default())?.put(|output, name| output.numbers(name, numbers))
}

/// Writes 0-based indices, one a line, as 1-based ones.
///
/// # Errors
/// [`WriteError`]; nothing has then changed.
///
/// ```
/// # let place = tempfile::tempdir()?;
/// let path = place.path().join("slaves.txt");
/// qless_io::write::write_indices(&path, &[0, 4])?;
/// assert_eq!(std::fs::read_to_string(&path)?, "1\n5\n");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_indices(path: &Path, indices: &[usize]) -> Result<(), WriteError> {
    OneFile::at(path, Inputs::default())?.put(|output, name| output.indices(name, indices))
}
