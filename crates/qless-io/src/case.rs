//! A case: the files of one system `C u = b`.

use std::path::{Path, PathBuf};

use qless::{ConstraintSystem, Place, SystemError};

use crate::fault::TextFault;
use crate::vectors::{read_labels, read_prescribed, read_rhs};
use crate::{Manifest, ReadError, matrix_market};

/// The files that [`read_case`](crate::read_case) reads, including optional ones that may be missing.
///
/// ```
/// use std::path::Path;
/// let files = qless_io::case_files(Path::new("C.mtx"), Some(Path::new("gap.txt")), None);
/// assert_eq!(files, [Path::new("C.mtx"), Path::new("gap.txt")]);
/// ```
pub fn case_files(path: &Path, rhs: Option<&Path>, prescribed: Option<&Path>) -> Vec<PathBuf> {
    let mut files = if path.is_dir() { PARTS.map(|name| path.join(name)).into() } else { vec![path.to_path_buf()] };
    files.extend([rhs, prescribed].into_iter().flatten().map(Path::to_path_buf));
    files
}

/// Names of the files of a case within its folder.
const PARTS: [&str; 5] = ["C.mtx", "b.txt", "prescribed.txt", "rows.txt", "cols.txt"];

/// Paths of the files of a case.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct CaseFiles {
    /// Matrix C.
    pub matrix: PathBuf,
    /// Right-hand side b; absent if it is zero.
    pub rhs: Option<PathBuf>,
    /// Prescribed DOFs, if any.
    pub prescribed: Option<PathBuf>,
    /// Labels of the equations, if any.
    pub rows: Option<PathBuf>,
    /// Labels of the DOFs, if any.
    pub columns: Option<PathBuf>,
}

impl CaseFiles {
    /// Finds the files that [`read_case`](crate::read_case) reads, without reading them.
    ///
    /// # Errors
    /// [`ReadError`]: the path is not a case.
    pub fn find(path: &Path, rhs: Option<&Path>, prescribed: Option<&Path>) -> Result<Self, ReadError> {
        let kind = std::fs::metadata(path).map_err(ReadError::io(path))?;
        let files = if kind.is_dir() { Self::in_folder(path)? } else { Self::lone(path) };
        Ok(files.with(rhs, prescribed))
    }

    /// Uses the files in the arguments, if given, in place of the case's own right-hand side and prescribed DOFs.
    pub(crate) fn with(mut self, rhs: Option<&Path>, prescribed: Option<&Path>) -> Self {
        self.rhs = rhs.map(Path::to_path_buf).or(self.rhs);
        self.prescribed = prescribed.map(Path::to_path_buf).or(self.prescribed);
        self
    }

    pub(crate) fn in_folder(folder: &Path) -> Result<Self, ReadError> {
        let part = |name: &str| {
            let path = folder.join(name);
            // A broken link counts as present, so that reading it fails with a message.
            path.symlink_metadata().is_ok().then_some(path)
        };
        let [matrix, rhs, prescribed, rows, columns] = PARTS.map(part);
        let matrix = matrix.ok_or_else(|| ReadError::NoMatrix { path: folder.to_path_buf() })?;
        // Only an incomplete set of files makes the case invalid. All other faults of a manifest are ignored: edited files still form a
        // case, and a `qless.json` of another program does no harm.
        if Manifest::read(folder).is_ok_and(|manifest| manifest.is_some_and(|manifest| !manifest.complete)) {
            return Err(ReadError::Interrupted { path: folder.join(Manifest::NAME) });
        }
        Ok(Self { matrix, rhs, prescribed, rows, columns })
    }

    pub(crate) fn lone(path: &Path) -> Self {
        Self { matrix: path.to_path_buf(), rhs: None, prescribed: None, rows: None, columns: None }
    }

    /// Builds the system; `text` is the content of the matrix file.
    pub(crate) fn read_from(&self, text: Vec<u8>) -> Result<ConstraintSystem, ReadError> {
        let matrix = matrix_market::parse(&self.matrix, &text)?;
        // Frees memory: the text may be as large as the system built from it.
        drop(text);
        let (m, n) = (matrix.rows, matrix.columns);
        let rhs = self.rhs.as_deref().map_or_else(|| Ok(vec![0.0; m]), |path| read_rhs(path, m))?;
        let prescribed = self.prescribed.as_deref().map_or_else(|| Ok(Vec::new()), |path| read_prescribed(path, n))?;
        let rows = labels(self.rows.as_deref(), m, "row", "row")?;
        let columns = labels(self.columns.as_deref(), n, "column", "DOF")?;
        ConstraintSystem::from_triplets(m, n, &matrix.entries, &rhs, &prescribed)
            .and_then(|system| system.with_labels(rows, columns))
            .map_err(|error| self.explain(error))
    }

    /// Adds file and line to an error of the library. Only the sum of repeated entries can be wrong here: the reader has checked everything
    /// else.
    fn explain(&self, error: SystemError) -> ReadError {
        let path = self.matrix.clone();
        let SystemError::NotFinite { what: Place::Coefficient { row, dof }, value } = error else {
            return ReadError::System { path, source: error };
        };
        // Packed files and standard input cannot be read again in chunks: their error has no line.
        let lines = self.sum_not_finite(row, dof, value).ok().flatten();
        lines.unwrap_or(ReadError::System { path, source: error })
    }

    /// The error that the coefficients of row `row` and column `dof` (both from 0) add up to `sum`, which is not finite. `None` if the file
    /// has no such coefficients.
    ///
    /// # Errors
    /// Errors of reading the matrix again.
    pub fn sum_not_finite(&self, row: usize, dof: usize, sum: f64) -> Result<Option<ReadError>, ReadError> {
        let path = &self.matrix;
        Ok(matrix_market::find_entry(path, (row, dof))?.map(|(first_line, last)| {
            let fault = TextFault::SumNotFinite { row: row + 1, column: dof + 1, first_line, sum };
            ReadError::malformed(path, Some(last), fault)
        }))
    }
}

/// Reads labels. An empty label becomes the word `fallback` with the 1-based number of its row or column, such as `DOF 5`. Without a file
/// there are no labels.
fn labels(path: Option<&Path>, count: usize, each: &'static str, fallback: &str) -> Result<Vec<String>, ReadError> {
    let Some(path) = path else { return Ok(Vec::new()) };
    let mut labels = read_labels(path, count, each)?;
    for (index, label) in labels.iter_mut().enumerate().filter(|(_, label)| label.trim().is_empty()) {
        *label = format!("{fallback} {}", index + 1);
    }
    Ok(labels)
}
