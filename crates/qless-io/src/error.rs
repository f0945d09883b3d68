//! Errors of reading and writing files. Each names the path of the file.

use std::io;
use std::path::{Path, PathBuf};

use crate::deck::{Format, Problem, Solver, UnrecognizedText};
use crate::{TextFault, bytes};

/// Why an input was refused. Lines, rows and columns count from 1.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// The operating system could not read the file.
    #[error("{}: cannot be read: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The reason that the operating system gives.
        source: io::Error,
    },
    /// The content is malformed.
    #[error(
        "{}{}{}: {fault}",
        path.display(),
        line.map(|n| format!(":{n}")).unwrap_or_default(),
        fault.column().map(|n| format!(":{n}")).unwrap_or_default()
    )]
    Malformed {
        /// The file.
        path: PathBuf,
        /// The line, unless the whole file is at fault.
        line: Option<usize>,
        /// What is wrong.
        fault: TextFault,
    },
    /// The folder is not a case.
    #[error("{}: the folder holds no C.mtx; name a folder with one, or a .mtx file", path.display())]
    NoMatrix {
        /// The folder.
        path: PathBuf,
    },
    /// The finite-element deck has an error.
    #[error(transparent)]
    Deck(#[from] crate::deck::DeckError),
    /// No reader recognises the content.
    #[error(
        "{}: cannot tell what this is: {seen}; decks of CalculiX and Abaqus (as .inp), Nastran (.bdf, .dat, .nas), ANSYS (.cdb), \
         LS-DYNA (.k) and Radioss (_0000.rad) are read, Matrix Market files (.mtx), relations (.rel), and folders with a C.mtx",
        path.display()
    )]
    Unknown {
        /// The file.
        path: PathBuf,
        /// How the content starts.
        seen: UnrecognizedText,
    },
    /// The solver does not read decks of this format.
    #[error(
        "{}: {solver} does not read it: it is a deck of {format}; leave --solver out, or name {}",
        path.display(),
        Solver::that_read(*format).map(Solver::name).collect::<Vec<_>>().join(" or ")
    )]
    Solver {
        /// The deck.
        path: PathBuf,
        /// The requested solver.
        solver: Solver,
        /// The deck's format.
        format: Format,
    },
    /// The content is a matrix instead of a deck, or a deck instead of a matrix.
    #[error("{}: {problem}", path.display())]
    OtherContent {
        /// The file.
        path: PathBuf,
        /// What the content is, and what to do.
        problem: &'static str,
    },
    /// The writing of the case was interrupted.
    #[error(
        "{}: writing this case was interrupted, or has not ended; write it again, or remove the file if C.mtx and all others are right",
        path.display()
    )]
    Interrupted {
        /// The manifest.
        path: PathBuf,
    },
    /// The library rejects the system, although the reader found no error.
    #[error("{}: {source} (rows and DOFs counted from 0)", path.display())]
    System {
        /// The matrix file.
        path: PathBuf,
        /// The reason that the library gives.
        source: qless::SystemError,
    },
}

/// Why an output was not written. No temporary files are left.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WriteError {
    /// The operating system could not write.
    #[error("{}: cannot be written: {source}", path.display())]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// The reason that the operating system gives.
        source: io::Error,
    },
    /// Writing was interrupted after some of the new files were put in place. The manifest says that the set is incomplete.
    #[error("{}: {source}; the files of this folder are incomplete, as qless.json records; remove the cause and run again", folder.display())]
    Incomplete {
        /// The folder.
        folder: PathBuf,
        /// The error that interrupted the writing.
        source: Box<WriteError>,
    },
    /// The path of the output folder is not a folder.
    #[error("{}: is not a folder; name another place or remove it", path.display())]
    NotAFolder {
        /// The path where the folder should be.
        path: PathBuf,
    },
    /// The path of the output file is not a file.
    #[error("{}: is not a regular file; name another place or remove it", path.display())]
    NotAFile {
        /// The path where the file should be.
        path: PathBuf,
    },
    /// The output would replace an input.
    #[error("{}: is part of the input, which would be overwritten; name another place", path.display())]
    IsInput {
        /// The path of the output.
        path: PathBuf,
    },
    /// The file to be replaced has several names (hard links).
    #[error(
        "{}: the file has {names} names (hard links), and a new file would replace only this name; name another \
         place, or remove this name first",
        path.display()
    )]
    Linked {
        /// The file.
        path: PathBuf,
        /// The number of names.
        names: u64,
    },
    /// Another process has held the lock of the folder for too long.
    #[error("{}: another process has been writing to this folder for more than a minute; end it, or name another place", path.display())]
    Busy {
        /// The folder.
        path: PathBuf,
    },
    /// The manifest of the folder cannot be read, or it is no manifest of this library.
    #[error(transparent)]
    Manifest(crate::ManifestError),
    /// A label has a line break.
    #[error("{}: label {index} ({label:?}) has a line break; a label is one line", path.display())]
    LabelLineBreak {
        /// The file of labels.
        path: PathBuf,
        /// The row or column of the label, from 1.
        index: usize,
        /// The label.
        label: String,
    },
}

impl ReadError {
    /// Whether a limit of size or memory was exceeded. If so, the content itself may be valid.
    pub fn is_resource(&self) -> bool {
        match self {
            Self::Io { source, .. } => bytes::is_too_much(source),
            Self::Deck(error) => matches!(error.problem, Problem::IncludeTooLarge { .. }),
            _ => false,
        }
    }

    pub(crate) fn io(path: &Path) -> impl FnOnce(io::Error) -> Self + '_ {
        |source| Self::Io { path: path.to_path_buf(), source }
    }

    pub(crate) fn malformed(path: &Path, line: Option<usize>, fault: TextFault) -> Self {
        Self::Malformed { path: path.to_path_buf(), line, fault }
    }
}

impl WriteError {
    pub(crate) fn io(path: &Path) -> impl FnOnce(io::Error) -> Self + '_ {
        |source| Self::Io { path: path.to_path_buf(), source }
    }
}

/// Reads a whole file. An error names the path of the file.
pub(crate) fn read_file(path: &Path) -> Result<Vec<u8>, ReadError> {
    bytes::read(path).map_err(ReadError::io(path))
}
