//! Writes one file, completely or not at all.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use super::inputs::Inputs;
use super::metadata::{check_names, follow};
use super::output::Output;
use crate::WriteError;

/// A single file to be written. If its path is a link, the target of the link is replaced. A device or pipe, such as `/dev/null`, receives
/// the text.
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
pub struct OneFile(OutputPlace);

#[derive(Debug)]
enum OutputPlace {
    File { output: Output, name: String },
    Stream(PathBuf),
}

impl OneFile {
    /// Prepares to write a file at `path`, which must be none of `inputs`.
    ///
    /// A file with several names (hard links) is refused. A new file would replace only one of the names. Overwriting the old file in place
    /// would leave it incomplete if the program is killed.
    ///
    /// # Errors
    /// [`WriteError`] if the file is an input or has several names, or if its folder is missing or not writable.
    pub fn at(path: &Path, inputs: Inputs) -> Result<Self, WriteError> {
        inputs.check_output(path)?;
        if is_stream(path) {
            return Ok(Self(OutputPlace::Stream(path.to_path_buf())));
        }
        let path = follow(path).map_err(WriteError::io(path))?;
        let (Some(folder), Some(name)) = (path.parent(), path.file_name().and_then(|name| name.to_str())) else {
            return Err(WriteError::NotAFile { path });
        };
        if !folder.as_os_str().is_empty() && !folder.exists() {
            let missing = io::Error::new(io::ErrorKind::NotFound, "there is no such folder; make it first");
            return Err(WriteError::io(folder)(missing));
        }
        check_names(&path)?;
        Ok(Self(OutputPlace::File { output: Output::new(folder)?.protecting(inputs), name: name.to_owned() }))
    }

    /// Writes the file.
    ///
    /// # Errors
    /// [`WriteError`]. A file is then unchanged, but a device or pipe may have received part of the text.
    pub fn write(self, bytes: &[u8]) -> Result<(), WriteError> {
        self.put(|out| out.write_all(bytes))
    }

    pub(super) fn put(self, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), WriteError> {
        match self.0 {
            OutputPlace::File { mut output, name } => {
                output.file(&name, write)?;
                output.commit_one()
            }
            OutputPlace::Stream(path) => {
                let stream = |path| {
                    let mut out = BufWriter::new(File::options().write(true).open(path)?);
                    write(&mut out)?;
                    out.flush()
                };
                stream(&path).map_err(WriteError::io(&path))
            }
        }
    }
}

/// Whether the path is a device or a pipe. It keeps no content that could be lost or half written.
#[cfg(unix)]
fn is_stream(path: &Path) -> bool {
    use std::os::unix::fs::FileTypeExt;
    fs::metadata(path).is_ok_and(|file| file.file_type().is_char_device() || file.file_type().is_fifo())
}

#[cfg(not(unix))]
fn is_stream(_: &Path) -> bool {
    false
}
