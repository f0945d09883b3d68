//! Why a case was not read: the same on all ranks.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use qless_io::ReadError;

use crate::error::{Spoken, text, text_of};

/// Why the ranks could not read a case.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum CaseError {
    /// What one rank would say of the file as well.
    #[error("{message}")]
    File {
        /// The line, from 1, if one is at fault.
        line: Option<u64>,
        /// The whole message, with the name of the file and the line.
        message: String,
        /// What the system said, if the content is not at fault.
        kind: Option<ErrorKind>,
    },
    /// A file that looks different from another rank.
    #[error("{}: the ranks do not see the same file; put it where all of them read it, and change nothing meanwhile", path.display())]
    Differs {
        /// The file.
        path: PathBuf,
    },
}

/// Kinds that reach the other ranks; the rest arrives as the last.
const KINDS: [ErrorKind; 7] = [
    ErrorKind::NotFound,
    ErrorKind::PermissionDenied,
    ErrorKind::IsADirectory,
    ErrorKind::OutOfMemory,
    ErrorKind::FileTooLarge,
    ErrorKind::Unsupported,
    ErrorKind::Other,
];

impl From<ReadError> for CaseError {
    fn from(error: ReadError) -> Self {
        let (line, kind) = match &error {
            ReadError::Malformed { line, .. } => (line.map(|line| line as u64), None),
            ReadError::Io { source, .. } => (None, Some(source.kind())),
            _ => (None, None),
        };
        Self::File { line, message: error.to_string(), kind }
    }
}

impl CaseError {
    pub(super) fn differs(path: &Path) -> Self {
        Self::Differs { path: path.to_path_buf() }
    }
}

impl Spoken for CaseError {
    fn to_words(&self) -> Vec<u64> {
        match self {
            Self::File { line, message, kind } => {
                let kind = kind.map_or(0, |kind| 1 + KINDS.iter().position(|k| *k == kind).unwrap_or(KINDS.len() - 1));
                [vec![0, line.unwrap_or(0), kind as u64], text(message)].concat()
            }
            Self::Differs { path } => [vec![1, 0, 0], text(&path.to_string_lossy())].concat(),
        }
    }

    fn from_words(words: &[u64]) -> Self {
        let said = text_of(&words[3..]);
        match words[0] {
            0 => {
                let kind = (words[2] as usize).checked_sub(1).map(|k| KINDS[k]);
                Self::File { line: (words[1] > 0).then_some(words[1]), message: said, kind }
            }
            _ => Self::Differs { path: said.into() },
        }
    }
}
