//! Writes a set of files to a folder, with a manifest that says whether all of them are in place.

use std::collections::BTreeMap;
use std::fs;
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Component, Path, PathBuf};

use flate2::Crc;
use qless::{ConstraintSystem, Csr};

use super::inputs::Inputs;
use super::metadata;
use super::scratch::{self, Scratch, WriteLock};
use super::text;
use crate::WriteError;
use crate::manifest::{FileRecord, Manifest, ManifestError};

/// A set of files to be written to a folder. [`Output::commit`] puts them in place, with a [`Manifest`]. If the value is dropped without
/// it, they are removed.
///
/// ```
/// use qless_io::{Manifest, write::Output};
/// # let place = tempfile::tempdir()?;
/// let folder = place.path().join("reduced");
/// let mut output = Output::new(&folder)?;
/// output.numbers("g.txt", &[0.5])?;
/// output.indices("slaves.txt", &[0])?;
/// assert!(!folder.join("g.txt").exists());
/// output.commit()?;
/// assert_eq!(std::fs::read_to_string(folder.join("g.txt"))?, "0.5\n");
/// assert_eq!(Manifest::check(&folder)?.files.len(), 2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Output {
    folder: PathBuf,
    scratch: Scratch,
    /// The files by name, each with the path of its temporary file and the record for the manifest.
    files: BTreeMap<String, (PathBuf, FileRecord)>,
    absent: Vec<String>,
    inputs: Inputs,
    command: String,
}

impl Output {
    /// Starts a set of files for `folder`, which is created if it does not exist.
    ///
    /// # Errors
    /// [`WriteError`] if `folder` is no folder or is not writable.
    pub fn new(folder: &Path) -> Result<Self, WriteError> {
        let missing = missing(folder)?;
        let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        Ok(Self {
            folder: folder.to_path_buf(),
            scratch: Scratch::new(folder, &missing)?,
            files: BTreeMap::new(),
            absent: Vec::new(),
            inputs: Inputs::default(),
            command: String::new(),
        })
    }

    /// Sets the command that the manifest records.
    #[must_use]
    pub fn by(self, command: &str) -> Self {
        Self { command: command.to_owned(), ..self }
    }

    /// From now on, refuses files that would replace one of `inputs`.
    #[must_use]
    pub fn protecting(self, inputs: Inputs) -> Self {
        Self { inputs, ..self }
    }

    /// Checks that a file of this set may have this name.
    ///
    /// # Errors
    /// [`WriteError::IsInput`].
    pub fn check(&self, name: &str) -> Result<(), WriteError> {
        self.inputs.check_output(&self.folder.join(name))
    }

    /// Adds a file with the text that `write` produces. `name` must be a plain file name, without folders.
    ///
    /// # Errors
    /// [`WriteError::IsInput`] if the file is an input, [`WriteError::NotAFile`] if `name` is not plain or is reserved, or
    /// [`WriteError::Io`] with the error of `write` or of the system.
    pub fn file(&mut self, name: &str, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), WriteError> {
        self.check(name)?;
        let place = self.folder.join(name);
        if !is_plain(name) {
            return Err(WriteError::NotAFile { path: place });
        }
        if self.files.contains_key(name) {
            return Err(WriteError::io(&place)(ErrorKind::AlreadyExists.into()));
        }
        let file = self.fill(name, write).map_err(WriteError::io(&place))?;
        self.files.insert(name.to_owned(), file);
        Ok(())
    }

    /// Creates a temporary file and writes its text. The file is synchronised with the disk, because some systems report a full disk only
    /// then.
    fn fill(
        &mut self,
        name: &str,
        write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> io::Result<(PathBuf, FileRecord)> {
        let (file, path) = self.scratch.file()?;
        let mut out = Summed { out: BufWriter::with_capacity(1 << 16, file), crc: Crc::new(), size: 0 };
        write(&mut out)?;
        out.out.into_inner()?.sync_all()?;
        Ok((path, FileRecord::new(name, &out.crc, out.size)))
    }

    /// Adds a Matrix Market file, `coordinate real general`, with a matrix.
    ///
    /// # Errors
    /// Those of [`Output::file`].
    pub fn matrix(&mut self, name: &str, matrix: &Csr) -> Result<(), WriteError> {
        self.file(name, |out| text::matrix(out, matrix))
    }

    /// Adds a file with numbers, one on each line.
    ///
    /// # Errors
    /// Those of [`Output::file`].
    pub fn numbers(&mut self, name: &str, numbers: &[f64]) -> Result<(), WriteError> {
        self.file(name, |out| text::numbers(out, numbers))
    }

    /// Adds a file with indices, one on each line. They count from 0 here and from 1 in the file.
    ///
    /// # Errors
    /// Those of [`Output::file`].
    pub fn indices(&mut self, name: &str, indices: &[usize]) -> Result<(), WriteError> {
        self.file(name, |out| text::indices(out, indices))
    }

    /// Makes [`Output::commit`] remove the file of this name if it exists. An earlier run may have written it.
    ///
    /// # Errors
    /// [`WriteError::IsInput`].
    pub fn absent(&mut self, name: &str) -> Result<(), WriteError> {
        self.check(name)?;
        self.absent.push(name.to_owned());
        Ok(())
    }

    /// Adds the files that [`write_case`](super::write_case) writes.
    ///
    /// # Errors
    /// Those of [`Output::file`], and [`WriteError::LabelLineBreak`].
    pub fn case(&mut self, system: &ConstraintSystem) -> Result<(), WriteError> {
        self.matrix("C.mtx", system.matrix())?;
        self.numbers("b.txt", system.rhs())?;
        if system.prescribed().is_empty() {
            self.absent("prescribed.txt")?;
        } else {
            self.file("prescribed.txt", |out| text::prescribed(out, system.prescribed()))?;
        }
        self.labels("rows.txt", system.equation_labels())?;
        self.labels("cols.txt", system.dof_labels())
    }

    /// Adds a file of labels, one on each line. If there are no labels, makes [`Output::commit`] remove the file.
    fn labels(&mut self, name: &str, labels: &[String]) -> Result<(), WriteError> {
        if labels.is_empty() {
            return self.absent(name);
        }
        if let Some(index) = labels.iter().position(|label| label.contains(['\n', '\r'])) {
            let label = labels[index].clone();
            return Err(WriteError::LabelLineBreak { path: self.folder.join(name), index: index + 1, label });
        }
        self.file(name, |out| labels.iter().try_for_each(|label| writeln!(out, "{label}")))
    }

    /// Puts the files in their places, one after another. The manifest says that the set is incomplete before the first file is put in
    /// place, and that it is complete after the last. Files of an earlier set that are not in this one are removed, unless they have
    /// changed since.
    ///
    /// # Errors
    /// [`WriteError`]. The folder is then unchanged, unless the error is [`WriteError::Incomplete`].
    pub fn commit(mut self) -> Result<(), WriteError> {
        let _folder = scratch::lock(&self.folder)?;
        self.check(Manifest::NAME)?;
        self.check_places()?;
        let before = Manifest::read(&self.folder).map_err(WriteError::from)?.unwrap_or_default();
        let mut manifest = Manifest {
            program: concat!("qless ", env!("CARGO_PKG_VERSION")).to_owned(),
            command: self.command.clone(),
            complete: false,
            files: self.files.values().map(|(_, record)| record.clone()).collect(),
            replaces: before.files.into_iter().chain(before.replaces).collect(),
        };
        // Both manifests are prepared before the [`WriteLock`] is taken, to keep the lock for a short time only. A handled signal ends the
        // program only after the lock is released.
        let incomplete = self.add_manifest(&manifest)?;
        let replaced = std::mem::take(&mut manifest.replaces);
        manifest.complete = true;
        let complete = self.add_manifest(&manifest)?;
        let _lock = WriteLock::take();
        self.put(Manifest::NAME, &incomplete)?;
        self.scratch.keep_folders();
        let files = self.files.iter().try_for_each(|(name, (file, _))| self.put(name, file));
        let all = files.and_then(|()| self.remove(&replaced)).and_then(|()| self.put(Manifest::NAME, &complete));
        all.map_err(|error| WriteError::Incomplete { folder: self.folder.clone(), source: Box::new(error) })
    }

    /// Puts the files in their places, without a manifest.
    pub(super) fn commit_one(self) -> Result<(), WriteError> {
        self.check_places()?;
        let _lock = WriteLock::take();
        self.scratch.keep_folders();
        self.files.iter().try_for_each(|(name, (file, _))| self.put(name, file))
    }

    fn add_manifest(&mut self, manifest: &Manifest) -> Result<PathBuf, WriteError> {
        let place = self.folder.join(Manifest::NAME);
        let text = manifest.text().map_err(WriteError::io(&place))?;
        let filled = self.fill(Manifest::NAME, |out| out.write_all(text.as_bytes())).map_err(WriteError::io(&place))?;
        Ok(filled.0)
    }

    /// Refuses to write if a folder or a device is in the place of a file.
    fn check_places(&self) -> Result<(), WriteError> {
        for name in self.files.keys().chain(&self.absent) {
            let path = self.folder.join(name);
            if fs::metadata(&path).is_ok_and(|kind| !kind.is_file()) {
                return Err(WriteError::NotAFile { path });
            }
        }
        Ok(())
    }

    fn put(&self, name: &str, file: &Path) -> Result<(), WriteError> {
        let place = self.folder.join(name);
        metadata::keep(&place, file).and_then(|()| fs::rename(file, &place)).map_err(WriteError::io(&place))
    }

    /// Removes files of earlier sets, if they are not in this set and have not changed. Also removes the files that [`Output::absent`]
    /// names.
    fn remove(&self, replaced: &[FileRecord]) -> Result<(), WriteError> {
        let is_ours = |record: &&FileRecord| {
            !self.files.contains_key(&record.name)
                && self.check(&record.name).is_ok()
                && record.is_of(&self.folder).unwrap_or(false)
        };
        let replaced = replaced.iter().filter(is_ours).map(|record| &record.name);
        for name in self.absent.iter().chain(replaced) {
            let place = self.folder.join(name);
            match fs::remove_file(&place) {
                Err(error) if error.kind() != ErrorKind::NotFound => return Err(WriteError::io(&place)(error)),
                _ => {}
            }
        }
        Ok(())
    }
}

impl From<ManifestError> for WriteError {
    fn from(error: ManifestError) -> Self {
        match error {
            ManifestError::Io { path, source } => Self::Io { path, source },
            error => Self::Manifest(error),
        }
    }
}

/// A writer that also computes the size and the checksum of what it writes.
struct Summed<W: Write> {
    out: W,
    crc: Crc,
    size: u64,
}

impl<W: Write> Write for Summed<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let count = self.out.write(bytes)?;
        self.crc.update(&bytes[..count]);
        self.size += count as u64;
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

/// Whether a name is that of a file directly in the folder, and is not reserved for the writer itself.
fn is_plain(name: &str) -> bool {
    let mut parts = Path::new(name).components();
    let is_one = matches!((parts.next(), parts.next()), (Some(Component::Normal(part)), None) if part == name);
    is_one && name != Manifest::NAME && !name.starts_with(scratch::PREFIX)
}

/// The folders that do not exist among `folder` and those above it, outermost first. It is an error if `..` follows a missing folder.
fn missing(folder: &Path) -> Result<Vec<PathBuf>, WriteError> {
    let mut missing = Vec::new();
    for part in folder.ancestors() {
        let existing = if part.as_os_str().is_empty() { Path::new(".") } else { part };
        match fs::metadata(existing) {
            Ok(kind) if kind.is_dir() => {
                missing.reverse();
                return Ok(missing);
            }
            Ok(_) => return Err(WriteError::NotAFolder { path: existing.to_path_buf() }),
            Err(error) if matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => {
                if part.file_name().is_none() {
                    return Err(WriteError::io(folder)(error));
                }
                missing.push(part.to_path_buf());
            }
            Err(error) => return Err(WriteError::io(folder)(error)),
        }
    }
    Err(WriteError::io(folder)(ErrorKind::NotFound.into()))
}
