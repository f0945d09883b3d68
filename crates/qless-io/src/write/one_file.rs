//! Writes one file, completely or not at all.

use std::io;
use std::path::Path;

use super::inputs::Inputs;
use super::metadata::{check_names, follow};
use super::output::Output;
use crate::WriteError;

/// A file to be written. Links are followed: their target is replaced.
///
/// ```
/// use qless_io::write::{Inputs, OneFile};
/// # let place = tempfile::tempdir()?;
/// let path = place.path().join("clean.inp");
/// OneFile::at(&path, Inputs::default())?.write(b"*NODE\n")?;
/// assert_eq!(std::fs::read(&path)?, b"*NODE\n");
///
/// let error = OneFile::at(&path, Inputs::new([&path])).unwrap_err().to_string();
/// assert!(error.contains("clean.inp: is part of the input"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct OneFile {
    output: Output,
    name: String,
}

impl OneFile {
    /// Starts a file for `path`, which must be none of `inputs`.
    ///
    /// A file with several names (hard links) is refused. A new file would replace only one of the names, and a file
    /// overwritten in place is incomplete if the program is killed.
    ///
    /// # Errors
    /// [`WriteError`]: the file is an input or has several names, its folder is missing, or nothing can be written
    /// there.
    pub fn at(path: &Path, inputs: Inputs) -> Result<Self, WriteError> {
        inputs.check_output(path)?;
        let path = follow(path).map_err(WriteError::io(path))?;
        let (Some(folder), Some(name)) = (path.parent(), path.file_name().and_then(|name| name.to_str())) else {
            return Err(WriteError::NotAFile { path });
        };
        if !folder.as_os_str().is_empty() && !folder.exists() {
            let missing = io::Error::new(io::ErrorKind::NotFound, "there is no such folder; make it first");
            return Err(WriteError::io(folder)(missing));
        }
        check_names(&path)?;
        Ok(Self { output: Output::new(folder)?.protecting(inputs), name: name.to_owned() })
    }

    /// Writes the file.
    ///
    /// # Errors
    /// [`WriteError`]; nothing has then changed.
    pub fn write(self, bytes: &[u8]) -> Result<(), WriteError> {
        self.put(|output, name| output.file(name, |out| out.write_all(bytes)))
    }

    pub(super) fn put(
        mut self,
        add: impl FnOnce(&mut Output, &str) -> Result<(), WriteError>,
    ) -> Result<(), WriteError> {
        add(&mut self.output, &self.name)?;
        self.output.commit()
    }
}
