//! Reads the header `%%MatrixMarket matrix FORMAT FIELD SYMMETRY`. For variants that are not supported, says what to do.

use std::io::BufRead;
use std::path::Path;

use crate::ReadError;
use crate::fault::{TextFault, quote};
use crate::file_chunk::ChunkedFile;
use crate::lines::{TextLine, TextLines};

/// Whether a text starts with a Matrix Market header.
pub(crate) fn is_present(bytes: &[u8]) -> bool {
    TextLines::new(Path::new(""), bytes).not_blank().is_some_and(|line| is_banner(&line))
}

/// What the header says about the lines after the sizes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Header {
    /// Whether a line holds only a value, column after column (`array`), and not `row column value`.
    pub is_array: bool,
    pub is_integer: bool,
    pub symmetry: Symmetry,
}

/// Which entries a file leaves out because others imply them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Symmetry {
    /// The file leaves out no entries.
    General,
    /// The file leaves out the entries above the diagonal, because `a_ji = a_ij`.
    Symmetric,
    /// The file leaves out the entries above the diagonal, because `a_ji = -a_ij`, and those on the diagonal, which are zero.
    Skew,
}

/// Reads the header of a vector. Returns true if it says `integer`.
pub(crate) fn read_vector(path: &Path, lines: &mut TextLines) -> Result<bool, ReadError> {
    read(path, lines, &["array"], &["general"]).map(|header| header.is_integer)
}

/// Reads the header of a matrix.
pub(crate) fn read_matrix(path: &Path, lines: &mut TextLines) -> Result<Header, ReadError> {
    read(path, lines, &["coordinate", "array"], &["general", "symmetric", "skew-symmetric"])
}

fn read(path: &Path, lines: &mut TextLines, formats: &[&str], symmetries: &[&str]) -> Result<Header, ReadError> {
    let Some(line) = lines.not_blank() else {
        return Err(ReadError::malformed(path, None, TextFault::Header { found: quote(b"") }));
    };
    let words: Vec<&[u8]> = line.text.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty()).collect();
    let (true, &[_, object, format_found, field, symmetry]) = (is_banner(&line), words.as_slice()) else {
        return Err(line.fault(TextFault::Header { found: line.quote() }));
    };
    accept(&line, object, &["matrix"])?;
    accept(&line, format_found, formats)?;
    accept(&line, field, &["real", "integer"])?;
    accept(&line, symmetry, symmetries)?;
    let symmetry = match symmetry.to_ascii_lowercase().as_slice() {
        b"symmetric" => Symmetry::Symmetric,
        b"skew-symmetric" => Symmetry::Skew,
        _ => Symmetry::General,
    };
    let is = |word: &[u8], known: &str| word.eq_ignore_ascii_case(known.as_bytes());
    Ok(Header { is_array: is(format_found, "array"), is_integer: is(field, "integer"), symmetry })
}

/// The header and the sizes of a file. Each comment in between is replaced by a blank line: so line numbers stay right, and the text is
/// short.
#[derive(Default)]
pub(crate) struct FileHead {
    pub text: Vec<u8>,
    /// Number of bytes that the head has in the file.
    pub end: u64,
}

impl FileHead {
    /// Reads the header and the sizes. If `is_optional` is true and the first line that is not blank is no header, returns an empty head.
    pub fn read(file: &ChunkedFile, is_optional: bool) -> Result<Self, ReadError> {
        let mut reader = file.reader()?;
        let mut head = Self::default();
        let (mut line, mut found) = (Vec::new(), 0);
        while found < 2 {
            line.clear();
            if reader.read_until(b'\n', &mut line).map_err(ReadError::io(file.path()))? == 0 {
                break;
            }
            let mut lines = if head.end == 0 {
                TextLines::new(file.path(), &line)
            } else {
                TextLines::after(file.path(), &line, 0)
            };
            let is_first = found == 0;
            head.end += line.len() as u64;
            match if is_first { lines.not_blank() } else { lines.content() } {
                None => head.text.push(b'\n'),
                Some(text) if is_first && is_optional && !is_banner(&text) => return Ok(Self::default()),
                Some(_) => {
                    found += 1;
                    head.text.extend_from_slice(&line);
                }
            }
        }
        Ok(if is_optional && found == 0 { Self::default() } else { head })
    }
}

fn is_banner(line: &TextLine) -> bool {
    let word = line.text.trim_ascii().split(u8::is_ascii_whitespace).next().unwrap_or_default();
    [&b"%%MatrixMarket"[..], b"%MatrixMarket"].iter().any(|banner| word.eq_ignore_ascii_case(banner))
}

fn accept(line: &TextLine, word: &[u8], known: &[&str]) -> Result<(), ReadError> {
    if known.iter().any(|known| word.eq_ignore_ascii_case(known.as_bytes())) {
        return Ok(());
    }
    Err(line.fault(TextFault::HeaderWord { word: quote(word), advice: advice(word) }))
}

fn advice(word: &[u8]) -> &'static str {
    match word.to_ascii_lowercase().as_slice() {
        b"pattern" => "there are no coefficients; add a value to each entry and write `real`",
        b"complex" => "coefficients must be real; split each equation in its real and imaginary part and write `real`",
        b"hermitian" => "only one triangle is stored, of a complex matrix; write all entries as `real general`",
        b"symmetric" | b"skew-symmetric" => "a vector has no triangles; write `general`",
        b"coordinate" => "the vector is sparse; write all its values, one a line, and `array`",
        _ => "unknown; expected `matrix coordinate real general` (`array` for a vector)",
    }
}
