//! Writes a set of files, completely or not at all.

use std::fs::{self, File};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Component, Path, PathBuf};

use qless::Csr;

use super::commit;
use super::inputs::Inputs;
use super::moves::FolderChange;
use super::stage::{NEW, Stage, WriteLock};
use crate::WriteError;

/// Files to be written to a folder. [`Output::commit`] puts them in place; dropping removes them.
///
/// ```
/// use qless_io::write::Output;
/// # let place = tempfile::tempdir()?;
/// let folder = place.path().join("reduced");
/// let mut output = Output::new(&folder)?;
/// output.numbers("g.txt", &[0.5])?;
/// output.indices("slaves.txt", &[0])?;
/// assert!(!folder.exists());
/// output.commit()?;
/// assert_eq!(std::fs::read_to_string(folder.join("g.txt"))?, "0.5\n");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Output {
    /// The existing part of the target path.
    base: PathBuf,
    /// Folders below `base` that will be created.
    missing: PathBuf,
    /// A folder in `base`, on the same file system.
    stage: Stage,
    names: Vec<String>,
    absent: Vec<String>,
    inputs: Inputs,
}

impl Output {
    /// Starts a set of files for `folder`, which may not exist yet.
    ///
    /// # Errors
    /// [`WriteError`] if `folder` is no folder or is not writable.
    pub fn new(folder: &Path) -> Result<Self, WriteError> {
        let (base, missing) = split(folder)?;
        let lock = WriteLock::take();
        let stage = Stage::new(&base, &lock).map_err(WriteError::io(folder))?;
        let output = Self { base, missing, stage, names: Vec::new(), absent: Vec::new(), inputs: Inputs::default() };
        fs::create_dir_all(output.staged()).map_err(WriteError::io(folder))?;
        Ok(output)
    }

    /// Refuses files, added from now on, that would replace one of `inputs`.
    #[must_use]
    pub fn protecting(self, inputs: Inputs) -> Self {
        Self { inputs, ..self }
    }

    /// Checks that a file of this set may have this name.
    ///
    /// # Errors
    /// [`WriteError::IsInput`].
    pub fn check(&self, name: &str) -> Result<(), WriteError> {
        self.inputs.check_output(&self.place(name))
    }

    /// Adds a file with the text that `write` produces; `name` is a plain file name.
    ///
    /// # Errors
    /// [`WriteError::IsInput`], or [`WriteError::Io`] with the error of `write` or of the system.
    pub fn file(&mut self, name: &str, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), WriteError> {
        self.check(name)?;
        fill(&self.staged().join(name), write).map_err(WriteError::io(&self.place(name)))?;
        self.names.push(name.to_owned());
        Ok(())
    }

    /// Adds a matrix as `coordinate real general`.
    ///
    /// # Errors
    /// Those of [`Output::file`].
    pub fn matrix(&mut self, name: &str, matrix: &Csr) -> Result<(), WriteError> {
        self.file(name, |out| write_matrix(out, matrix))
    }

    /// Adds numbers, one a line.
    ///
    /// # Errors
    /// Those of [`Output::file`].
    pub fn numbers(&mut self, name: &str, numbers: &[f64]) -> Result<(), WriteError> {
        self.file(name, |out| numbers.iter().try_for_each(|number| writeln!(out, "{number:?}")))
    }

    /// Adds 0-based indices, one a line, as 1-based ones.
    ///
    /// # Errors
    /// Those of [`Output::file`].
    pub fn indices(&mut self, name: &str, indices: &[usize]) -> Result<(), WriteError> {
        self.file(name, |out| indices.iter().try_for_each(|index| writeln!(out, "{}", *index as u128 + 1)))
    }

    /// Removes a file of this name, which an earlier run may have written.
    ///
    /// # Errors
    /// [`WriteError::IsInput`].
    pub fn absent(&mut self, name: &str) -> Result<(), WriteError> {
        self.check(name)?;
        self.absent.push(name.to_owned());
        Ok(())
    }

    /// Adds labels, one a line; removes the file if there are none.
    pub(super) fn labels(&mut self, name: &str, labels: &[String]) -> Result<(), WriteError> {
        if labels.is_empty() {
            return self.absent(name);
        }
        if let Some(index) = labels.iter().position(|label| label.contains(['\n', '\r'])) {
            let label = labels[index].clone();
            return Err(WriteError::LabelLineBreak { path: self.place(name), index: index + 1, label });
        }
        self.file(name, |out| labels.iter().try_for_each(|label| writeln!(out, "{label}")))
    }

    /// Puts the files in their place.
    ///
    /// # Errors
    /// [`WriteError`]; the folder is then unchanged.
    pub fn commit(self) -> Result<(), WriteError> {
        let Self { base, missing, stage, names, absent, .. } = self;
        let Some(first) = missing.components().next() else {
            return commit::commit(&base, &stage, FolderChange { names, absent });
        };
        let (_lock, target) = (WriteLock::take(), base.join(first));
        fs::rename(stage.path().join(NEW).join(first), &target).map_err(WriteError::io(&target))
    }

    /// Folder for the new files.
    fn staged(&self) -> PathBuf {
        self.stage.path().join(NEW).join(&self.missing)
    }

    /// Final path of a file.
    fn place(&self, name: &str) -> PathBuf {
        self.base.join(&self.missing).join(name)
    }
}

/// Creates and fills a file. It is synchronised, because some systems report a full disk only then.
fn fill(path: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let file = {
        let _lock = WriteLock::take();
        File::create_new(path)?
    };
    let mut out = BufWriter::with_capacity(1 << 16, file);
    write(&mut out)?;
    out.into_inner()?.sync_all()
}

/// Splits `folder` into its longest existing part and the rest.
fn split(folder: &Path) -> Result<(PathBuf, PathBuf), WriteError> {
    for base in folder.ancestors() {
        let existing = if base.as_os_str().is_empty() { Path::new(".") } else { base };
        match fs::metadata(existing) {
            Ok(kind) if kind.is_dir() => return Ok((existing.to_path_buf(), rest(folder, base)?)),
            Ok(_) => return Err(WriteError::NotAFolder { path: existing.to_path_buf() }),
            Err(error) if matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => {}
            Err(error) => return Err(WriteError::io(folder)(error)),
        }
    }
    Err(WriteError::io(folder)(ErrorKind::NotFound.into()))
}

/// `folder` relative to `base`. A `..` below a missing folder leads nowhere.
fn rest(folder: &Path, base: &Path) -> Result<PathBuf, WriteError> {
    let rest = folder.strip_prefix(base).unwrap_or(Path::new(""));
    if rest.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir)) {
        return Ok(rest.components().filter(|part| matches!(part, Component::Normal(_))).collect());
    }
    Err(WriteError::io(folder)(ErrorKind::NotFound.into()))
}

fn write_matrix(out: &mut dyn Write, matrix: &Csr) -> io::Result<()> {
    writeln!(out, "%%MatrixMarket matrix coordinate real general")?;
    writeln!(out, "{} {} {}", matrix.rows(), matrix.cols(), matrix.nnz())?;
    for row in 0..matrix.rows() {
        for (column, value) in matrix.row(row) {
            writeln!(out, "{} {} {value:?}", row + 1, column + 1)?;
        }
    }
    Ok(())
}

pub(super) fn write_prescribed(out: &mut dyn Write, prescribed: &[(usize, f64)]) -> io::Result<()> {
    writeln!(out, "# column(1-based) value")?;
    prescribed.iter().try_for_each(|(dof, value)| writeln!(out, "{} {value:?}", dof + 1))
}
