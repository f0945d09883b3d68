//! Describes text that is neither a deck nor a matrix.

use std::fmt;

use crate::fault::quote;

/// Number of bytes that are searched for control characters.
const HEAD: usize = 1024;
/// Number of bytes that a message shows.
const SHOWN: usize = 8;

/// How a text starts that no reader recognises.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum UnrecognizedText {
    /// The text is empty or holds only blanks.
    Nothing,
    /// A known file type, such as "an HTML page".
    Known(&'static str),
    /// The file is no text; these are its first bytes.
    Bytes(Vec<u8>),
    /// The file holds letters with zero bytes between them.
    ZeroBytes,
    /// The first line of the text that is not blank.
    Line {
        /// The number of the line, from 1.
        line: usize,
        /// The text of the line, quoted, shortened and printable.
        found: String,
    },
}

/// First bytes of files of other types, each with a description of the type.
const STARTS: [(&[u8], &str); 15] = [
    (b"PK\x03\x04", "a zip archive"),
    (b"BZh", "bzip2 data"),
    (b"\xfd7zXZ", "xz data"),
    (b"\x28\xb5\x2f\xfd", "zstd data"),
    (b"%PDF", "a PDF document"),
    (b"\x89HDF", "an HDF5 file"),
    (b"\x89PNG", "a picture"),
    (b"\x7fELF", "a program"),
    (b"<!DOCTYPE html", "an HTML page"),
    (b"<html", "an HTML page"),
    (b"<?xml", "an XML file"),
    (b"#RADIOSS ENGINE", "an engine file of Radioss, which has no model; name the starter file (_0000.rad)"),
    (b"$MeshFormat", "a mesh of Gmsh"),
    (b"# vtk", "a VTK file"),
    (b"ISO-10303-21", "a STEP file"),
];

impl UnrecognizedText {
    /// Recognises files that are certainly no deck, even if they seem to hold cards.
    pub(super) fn foreign(text: &[u8]) -> Option<Self> {
        let start = text.trim_ascii_start();
        let is_start = |known: &[u8]| start.len() >= known.len() && start[..known.len()].eq_ignore_ascii_case(known);
        if let Some((_, what)) = STARTS.iter().find(|(known, _)| is_start(known)) {
            return Some(Self::Known(what));
        }
        let head = &text[..text.len().min(HEAD)];
        let zeros = memchr::memchr_iter(0, head).count();
        if 3 * zeros > head.len() && head.iter().any(u8::is_ascii_alphanumeric) {
            return Some(Self::ZeroBytes);
        }
        let is_strange = |byte: &&u8| byte.is_ascii_control() && !matches!(byte, b'\t' | b'\n' | b'\r' | 0x0c | 0x1a);
        let strange = head.iter().filter(is_strange).count();
        (zeros > 0 || 50 * strange > head.len()).then(|| Self::Bytes(head[..head.len().min(SHOWN)].to_vec()))
    }

    /// Describes a text without cards by its first line that is not blank.
    pub(super) fn from_text(text: &[u8]) -> Self {
        let mut lines = text.split(|&byte| byte == b'\n').map(<[u8]>::trim_ascii).zip(1..);
        match lines.find(|(line, _)| !line.is_empty()) {
            Some((found, line)) => Self::Line { line, found: quote(found) },
            None => Self::Nothing,
        }
    }
}

impl fmt::Display for UnrecognizedText {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Nothing => f.write_str("it is empty"),
            Self::Known(what) => write!(f, "it starts as {what}"),
            Self::ZeroBytes => {
                f.write_str("there are zero bytes, as in UTF-16 without a byte order mark (save it as UTF-8)")
            }
            Self::Bytes(bytes) => {
                f.write_str("it starts with the bytes")?;
                bytes.iter().try_for_each(|byte| write!(f, " {byte:02x}"))
            }
            Self::Line { line, found } => write!(f, "line {line} is {found}, and no card follows"),
        }
    }
}
