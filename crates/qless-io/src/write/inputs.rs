//! Makes sure that outputs do not overwrite inputs.

use std::ffi::OsString;
use std::fs;
use std::path::Path;
#[cfg(not(unix))]
use std::path::PathBuf;

use crate::WriteError;

/// Files that a program reads, and that no output may replace.
///
/// Two paths are equal if they lead to the same file, also through links or with another spelling. A file that does not exist is identified
/// by its name and its folder.
///
/// ```
/// use qless_io::write::Inputs;
/// # let place = tempfile::tempdir()?;
/// let deck = place.path().join("tie.inp");
/// std::fs::write(&deck, "*NODE\n")?;
/// let inputs = Inputs::new([&deck]);
/// let error = inputs.check_output(&place.path().join("./tie.inp")).unwrap_err().to_string();
/// assert!(error.ends_with("tie.inp: is part of the input, which would be overwritten; name another place"));
/// assert!(inputs.check_output(&place.path().join("report.txt")).is_ok());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct Inputs(Vec<FileIdentity>);

impl Inputs {
    /// Records the files at these paths as inputs.
    pub fn new(paths: impl IntoIterator<Item: AsRef<Path>>) -> Self {
        Self(paths.into_iter().filter_map(|path| FileIdentity::from_path(path.as_ref())).collect())
    }

    /// Checks that an output is none of the inputs.
    ///
    /// # Errors
    /// [`WriteError::IsInput`].
    pub fn check_output(&self, output: &Path) -> Result<(), WriteError> {
        match FileIdentity::from_path(output) {
            Some(identity) if self.0.contains(&identity) => Err(WriteError::IsInput { path: output.to_path_buf() }),
            _ => Ok(()),
        }
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
enum FileIdentity {
    Existing(FileId),
    Absent { folder: FileId, name: OsString },
}

impl FileIdentity {
    fn from_path(path: &Path) -> Option<Self> {
        if let Some(node) = node(path) {
            return Some(Self::Existing(node));
        }
        let folder = path.parent().map(|folder| if folder.as_os_str().is_empty() { Path::new(".") } else { folder });
        Some(Self::Absent { folder: node(folder?)?, name: path.file_name()?.to_owned() })
    }
}

/// What identifies a file: device and inode on Unix, elsewhere the path without links.
#[cfg(unix)]
type FileId = (u64, u64);
#[cfg(not(unix))]
type FileId = PathBuf;

#[cfg(unix)]
fn node(path: &Path) -> Option<FileId> {
    use std::os::unix::fs::MetadataExt;
    fs::metadata(path).ok().map(|file| (file.dev(), file.ino()))
}

#[cfg(not(unix))]
fn node(path: &Path) -> Option<FileId> {
    fs::canonicalize(path).ok()
}
