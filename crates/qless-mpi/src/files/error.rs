//! Errors of reading a case, the same on all ranks.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use qless_io::ReadError;

use crate::error::{ErrorWords, text, text_of};

/// Why the ranks could not read a case.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum CaseError {
    /// An error of a file, with the message of [`qless_io`].
    #[error("{message}")]
    File {
        /// The line with the error, from 1, if there is one.
        line: Option<u64>,
        /// The whole message, with the name of the file and the line.
        message: String,
        /// The kind of the system's error; `None` for an error in the content.
        kind: Option<ErrorKind>,
    },
    /// The ranks see different content of a file.
    #[error("{}: the ranks do not see the same file; put it where all of them read it, and do not change it meanwhile", path.display())]
    Differs {
        /// The file.
        path: PathBuf,
    },
}

/// Kinds of system errors that are sent to other ranks as they are. Any other kind is sent as the last one of this list.
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

impl ErrorWords for CaseError {
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
        let text = text_of(&words[3..]);
        match words[0] {
            0 => {
                let kind = (words[2] as usize).checked_sub(1).map(|k| KINDS[k]);
                Self::File { line: (words[1] > 0).then_some(words[1]), message: text, kind }
            }
            _ => Self::Differs { path: text.into() },
        }
    }
}
