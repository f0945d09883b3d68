//! A case: the files of one system, read and checked together.

use std::path::{Path, PathBuf};

use qless::{ConstraintSystem, Place, SystemError};

use crate::fault::TextFault;
use crate::vectors::{read_labels, read_prescribed, read_rhs};
use crate::{ReadError, chunk, matrix_market};

/// The files that [`read_case`](crate::read_case) reads, and those that it would read if they were there.
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

/// What a folder may hold of a case.
const PARTS: [&str; 5] = ["C.mtx", "b.txt", "prescribed.txt", "rows.txt", "cols.txt"];

/// Where the files of a case are.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct CaseFiles {
    /// C.
    pub matrix: PathBuf,
    /// b, if it is not zero.
    pub rhs: Option<PathBuf>,
    /// Prescribed DOFs, if there are any.
    pub prescribed: Option<PathBuf>,
    /// Labels of the equations, if they have any.
    pub rows: Option<PathBuf>,
    /// Labels of the DOFs, if they have any.
    pub columns: Option<PathBuf>,
}

impl CaseFiles {
    /// The files that [`read_case`](crate::read_case) reads, none of which is read yet.
    ///
    /// # Errors
    /// [`ReadError`]: the path is no case.
    pub fn find(path: &Path, rhs: Option<&Path>, prescribed: Option<&Path>) -> Result<Self, ReadError> {
        let kind = std::fs::metadata(path).map_err(ReadError::io(path))?;
        let files = if kind.is_dir() { Self::in_folder(path)? } else { Self::lone(path) };
        Ok(files.with(rhs, prescribed))
    }

    /// With these files instead of its own, where they are named.
    pub(crate) fn with(mut self, rhs: Option<&Path>, prescribed: Option<&Path>) -> Self {
        self.rhs = rhs.map(Path::to_path_buf).or(self.rhs);
        self.prescribed = prescribed.map(Path::to_path_buf).or(self.prescribed);
        self
    }

    pub(crate) fn in_folder(folder: &Path) -> Result<Self, ReadError> {
        let part = |name: &str| {
            let path = folder.join(name);
            // A link that leads nowhere is there: reading it says so, rather than taking it for absent.
            path.symlink_metadata().is_ok().then_some(path)
        };
        let [matrix, rhs, prescribed, rows, columns] = PARTS.map(part);
        let matrix = matrix.ok_or_else(|| ReadError::NoMatrix { path: folder.to_path_buf() })?;
        Ok(Self { matrix, rhs, prescribed, rows, columns })
    }

    pub(crate) fn lone(path: &Path) -> Self {
        Self { matrix: path.to_path_buf(), rhs: None, prescribed: None, rows: None, columns: None }
    }

    /// The system, of which `text` is the matrix.
    pub(crate) fn read_from(&self, text: Vec<u8>) -> Result<ConstraintSystem, ReadError> {
        let matrix = matrix_market::parse(&self.matrix, &text)?;
        // It may be as large as what is made of it.
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

    /// The library's error with file and line. The reader has checked all but the sums of repeats.
    fn explain(&self, error: SystemError) -> ReadError {
        let path = self.matrix.clone();
        let SystemError::NotFinite { what: Place::Coefficient { row, dof }, value } = error else {
            return ReadError::System { path, source: error };
        };
        // What is packed, or was standard input, cannot be gone through again in pieces.
        let lines = self.sum_not_finite(row, dof, value).ok().flatten();
        lines.unwrap_or(ReadError::System { path, source: error })
    }

    /// What to say where the coefficients given for a 0-based row and DOF add up to `sum`: none if there are no such coefficients.
    ///
    /// # Errors
    /// Those of reading the matrix once more.
    pub fn sum_not_finite(&self, row: usize, dof: usize, sum: f64) -> Result<Option<ReadError>, ReadError> {
        let path = self.matrix.clone();
        Ok(chunk::lines_of(&path, row, dof)?.map(|(first_line, last)| {
            let fault = TextFault::SumNotFinite { row: row + 1, column: dof + 1, first_line, sum };
            ReadError::Malformed { path, line: Some(last), fault }
        }))
    }
}

/// The labels in the file, `fallback` and the 1-based number where a line is empty; none without a file.
fn labels(path: Option<&Path>, count: usize, each: &'static str, fallback: &str) -> Result<Vec<String>, ReadError> {
    let Some(path) = path else { return Ok(Vec::new()) };
    let mut labels = read_labels(path, count, each)?;
    for (index, label) in labels.iter_mut().enumerate().filter(|(_, label)| label.trim().is_empty()) {
        *label = format!("{fallback} {}", index + 1);
    }
    Ok(labels)
}
