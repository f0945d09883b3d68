//! The manifest `qless.json` of a folder: which files belong together, and whether all of them are in place.
//!
//! ```json
//! {
//!   "program": "qless 0.1.0",
//!   "command": "qless reduce model -o out",
//!   "complete": true,
//!   "files": [{ "name": "T.mtx", "size": 1204, "crc32": 3632233996 }]
//! }
//! ```
//!
//! A writer stores the manifest twice: with `complete: false` before it changes the first file, and with `complete: true` after it has
//! changed the last one. So `false` marks a set whose writing was interrupted. While a set is incomplete, `replaces` lists the files of the
//! previous set, so that the next writer can remove those that no longer belong to a set.

use std::fs::{self, File};
use std::io::{self, ErrorKind, Read};
use std::path::{Path, PathBuf};

use flate2::Crc;
use serde::{Deserialize, Serialize};

/// The manifest of a set of files.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Manifest {
    /// Name and version of the program that wrote the files.
    pub program: String,
    /// The command that wrote the files, or the library function that wrote them.
    pub command: String,
    /// Whether all files of the set are in place.
    pub complete: bool,
    /// The files of the set.
    pub files: Vec<FileRecord>,
    /// The files of the previous set, listed only while this set is incomplete.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub replaces: Vec<FileRecord>,
}

/// A file of a set, as the manifest records it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct FileRecord {
    /// The name of the file in the folder.
    pub name: String,
    /// Number of bytes of the file.
    pub size: u64,
    /// CRC-32 of the bytes of the file, as `zlib.crc32` of Python computes it.
    pub crc32: u32,
}

/// Why the files of a folder are not known to belong together.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ManifestError {
    /// The operating system could not read a file.
    #[error("{}: cannot be read: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The reason that the operating system gives.
        source: io::Error,
    },
    /// The folder has no manifest.
    #[error("{}: there is no such file, so nothing says which files belong together; write them again", path.display())]
    Missing {
        /// The path where the manifest should be.
        path: PathBuf,
    },
    /// A file has the name of the manifest, but it is no manifest of this library.
    #[error("{}: it is no manifest of qless; name another folder, or move this file away", path.display())]
    NotOurs {
        /// The file.
        path: PathBuf,
    },
    /// The writing of the set was interrupted.
    #[error("{}: writing this set of files was interrupted, or has not ended; write it again", path.display())]
    Incomplete {
        /// The path of the manifest.
        path: PathBuf,
    },
    /// The manifest does not list the file.
    #[error("{}: {manifest} does not list this file, so it belongs to another set; write the set again", path.display())]
    NotListed {
        /// The file.
        path: PathBuf,
        /// The name of the manifest.
        manifest: &'static str,
    },
    /// The file was changed after it was written.
    #[error("{}: the file has changed since the set was written; write the set again", path.display())]
    Changed {
        /// The file.
        path: PathBuf,
    },
}

impl Manifest {
    /// The name of the manifest in every folder.
    pub const NAME: &str = "qless.json";

    /// Reads the manifest of a folder; `None` if there is none.
    ///
    /// # Errors
    /// [`ManifestError::Io`] or [`ManifestError::NotOurs`].
    pub fn read(folder: &Path) -> Result<Option<Self>, ManifestError> {
        let path = folder.join(Self::NAME);
        match fs::read(&path) {
            Ok(text) => serde_json::from_slice(&text).map(Some).map_err(|_| ManifestError::NotOurs { path }),
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
            Err(source) => Err(ManifestError::Io { path, source }),
        }
    }

    /// Reads the manifest of a folder and compares size and checksum of every file with it. Call it before a set of files,
    /// such as those of a reduction, is read.
    ///
    /// # Errors
    /// [`ManifestError`] if the files are not known to belong together.
    ///
    /// ```
    /// use qless_io::{Manifest, ManifestError, write::Output};
    /// # let place = tempfile::tempdir()?;
    /// let mut output = Output::new(place.path())?.by("an example");
    /// output.numbers("g.txt", &[0.5])?;
    /// output.indices("slaves.txt", &[0])?;
    /// output.commit()?;
    /// let manifest = Manifest::check(place.path())?;
    /// assert_eq!(manifest.command, "an example");
    /// assert_eq!(manifest.files[0].size, 4);
    ///
    /// std::fs::write(place.path().join("g.txt"), "0.7\n")?;
    /// assert!(matches!(Manifest::check(place.path()), Err(ManifestError::Changed { .. })));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn check(folder: &Path) -> Result<Self, ManifestError> {
        let path = || folder.join(Self::NAME);
        let manifest = Self::read(folder)?.ok_or_else(|| ManifestError::Missing { path: path() })?;
        if !manifest.complete {
            return Err(ManifestError::Incomplete { path: path() });
        }
        for record in &manifest.files {
            let path = folder.join(&record.name);
            if !record.is_of(folder).map_err(|source| ManifestError::Io { path: path.clone(), source })? {
                return Err(ManifestError::Changed { path });
            }
        }
        Ok(manifest)
    }

    /// Returns the record of the file with this name, if the set has it.
    ///
    /// # Errors
    /// [`ManifestError::NotListed`] if the set does not have it.
    pub fn file(&self, folder: &Path, name: &str) -> Result<&FileRecord, ManifestError> {
        let not_listed = || ManifestError::NotListed { path: folder.join(name), manifest: Self::NAME };
        self.files.iter().find(|record| record.name == name).ok_or_else(not_listed)
    }

    /// The text of the manifest, in JSON.
    pub(crate) fn text(&self) -> io::Result<String> {
        Ok(serde_json::to_string_pretty(self)? + "\n")
    }
}

impl FileRecord {
    pub(crate) fn new(name: &str, crc: &Crc, size: u64) -> Self {
        Self { name: name.to_owned(), size, crc32: crc.sum() }
    }

    /// Whether the folder has this file with the recorded size and checksum. False if the name leads out of the folder.
    pub(crate) fn is_of(&self, folder: &Path) -> io::Result<bool> {
        if self.name.contains(['/', '\\']) {
            return Ok(false);
        }
        let path = folder.join(&self.name);
        let found = match path.metadata() {
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(false),
            found => found?,
        };
        // A pipe must not be opened, because opening it would wait for a writer.
        if !found.is_file() || found.len() != self.size {
            return Ok(false);
        }
        let mut file = File::open(path)?;
        let (mut crc, mut buffer) = (Crc::new(), vec![0; 1 << 16]);
        loop {
            match file.read(&mut buffer)? {
                0 => return Ok(crc.sum() == self.crc32),
                count => crc.update(&buffer[..count]),
            }
        }
    }
}
