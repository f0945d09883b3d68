//! Converts packed or encoded text to plain text: gzip, then UTF-16 with a byte order mark, then lone carriage returns
//! as line ends.
//!
//! Line numbers stay those that an editor shows.

use std::io::{self, ErrorKind, Read};
use std::path::Path;

use flate2::read::MultiGzDecoder;

use super::{CHUNK, TooMuch, check};

/// A gzip file may always unpack to this many bytes. For a larger result, limits on the line length and on the ratio of sizes apply.
const SMALL: usize = 1 << 26;
/// Largest ratio of unpacked to packed size. Text rarely packs better than 20 to 1 unless it repeats itself.
const RATIO: usize = 200;

/// Why packed or encoded text cannot be read.
#[derive(Debug, thiserror::Error)]
enum Damaged {
    #[error("it starts as gzip data, which are damaged: {0}; pack it again")]
    Gzip(io::Error),
    #[error("it is UTF-16, but ends within a character; save it again, as UTF-8 where possible")]
    OddUtf16,
    #[error("it is UTF-16, but byte {byte} (from 1) begins no character; save it again, as UTF-8 where possible")]
    Surrogate { byte: usize },
}

impl From<Damaged> for io::Error {
    fn from(error: Damaged) -> Self {
        Self::new(ErrorKind::InvalidData, error)
    }
}

/// The file name of a path without the ending `.gz`; `None` if the path has another ending.
///
/// ```
/// use std::path::Path;
/// assert_eq!(qless_io::without_gz(Path::new("C.mtx.gz")), Some(Path::new("C.mtx")));
/// ```
pub fn without_gz(path: &Path) -> Option<&Path> {
    path.extension().filter(|ending| ending.eq_ignore_ascii_case("gz")).and(path.file_stem()).map(Path::new)
}

/// Unpacks and decodes the content of a file to plain text.
pub(super) fn text(bytes: Vec<u8>) -> io::Result<Vec<u8>> {
    let bytes = if bytes.starts_with(b"\x1f\x8b") { unpack(&bytes)? } else { bytes };
    let bytes = match bytes.get(..2) {
        Some(b"\xff\xfe") => utf8(&bytes[2..], u16::from_le_bytes)?,
        Some(b"\xfe\xff") => utf8(&bytes[2..], u16::from_be_bytes)?,
        _ => bytes,
    };
    Ok(lines(bytes))
}

/// Unpacks gzip data of one or several members.
fn unpack(packed: &[u8]) -> io::Result<Vec<u8>> {
    let most = packed.len().saturating_mul(RATIO).max(SMALL);
    let mut unpacked = Vec::new();
    let mut decoder = MultiGzDecoder::new(packed);
    let mut line = 0;
    loop {
        let before = unpacked.len();
        unpacked.try_reserve(CHUNK as usize).map_err(|_| TooMuch::Memory { size: before })?;
        let read = decoder.by_ref().take(CHUNK).read_to_end(&mut unpacked);
        if read.map_err(|error| failed(error, before))? == 0 {
            return Ok(unpacked);
        }
        line = memchr::memrchr(b'\n', &unpacked[before..]).map_or(line, |at| before + at + 1);
        // A carriage return ends a line too. In UTF-16 it is the same byte beside a zero byte, so this search finds it there as well.
        line = memchr::memrchr(b'\r', &unpacked[before..]).map_or(line, |at| line.max(before + at + 1));
        if unpacked.len() > SMALL {
            check(0, unpacked.len() - line)?;
        }
        if unpacked.len() > most {
            return Err(TooMuch::Unpacked { packed: packed.len(), most }.into());
        }
    }
}

fn failed(error: io::Error, size: usize) -> io::Error {
    match error.kind() {
        ErrorKind::OutOfMemory => TooMuch::Memory { size }.into(),
        _ => Damaged::Gzip(error).into(),
    }
}

/// Converts UTF-16 to UTF-8.
fn utf8(bytes: &[u8], unit: fn([u8; 2]) -> u16) -> io::Result<Vec<u8>> {
    let (pairs, odd) = bytes.as_chunks::<2>();
    if !odd.is_empty() {
        return Err(Damaged::OddUtf16.into());
    }
    let mut text = String::new();
    // ASCII needs one byte for each UTF-16 unit of two bytes. The string grows if the text has other characters.
    text.try_reserve(bytes.len() / 2).map_err(|_| TooMuch::Memory { size: bytes.len() })?;
    let mut units = 0;
    for character in char::decode_utf16(pairs.iter().map(|pair| unit(*pair))) {
        // Byte numbers count from 1, and the byte order mark takes two bytes.
        let c = character.map_err(|_| Damaged::Surrogate { byte: 2 * units + 3 })?;
        units += c.len_utf16();
        text.push(c);
    }
    Ok(text.into_bytes())
}

/// Turns carriage returns into line feeds if the text has no line feed at all.
fn lines(mut bytes: Vec<u8>) -> Vec<u8> {
    if memchr::memchr(b'\n', &bytes).is_none() {
        bytes.iter_mut().filter(|byte| **byte == b'\r').for_each(|byte| *byte = b'\n');
    }
    bytes
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use flate2::Compression;
    use flate2::write::GzEncoder;

    use super::*;

    const TEXT: &str = "*NODE\r\n1,0.,0.,0.\n** \u{e4}\u{1d11e}\n";

    fn packed(bytes: &[u8]) -> Vec<u8> {
        let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
        encoder.write_all(bytes).expect("packed");
        encoder.finish().expect("packed")
    }

    fn utf16(mark: [u8; 2], of: fn(u16) -> [u8; 2]) -> Vec<u8> {
        mark.into_iter().chain(TEXT.encode_utf16().flat_map(of)).collect()
    }

    #[test]
    fn every_encoding_gives_the_same_text() {
        let little = utf16([0xff, 0xfe], u16::to_le_bytes);
        let big = utf16([0xfe, 0xff], u16::to_be_bytes);
        let two = [packed(&TEXT.as_bytes()[..9]), packed(&TEXT.as_bytes()[9..])].concat();
        for bytes in [TEXT.as_bytes().to_vec(), packed(TEXT.as_bytes()), packed(&little), little, big, two] {
            assert_eq!(text(bytes).expect("text"), TEXT.as_bytes());
        }
        assert_eq!(text(b"a\rb\r".to_vec()).expect("text"), b"a\nb\n");
        assert_eq!(text(b"a\rb\n".to_vec()).expect("text"), b"a\rb\n");
    }

    #[test]
    fn damaged_data_are_reported() {
        let whole = packed(TEXT.as_bytes());
        for (bytes, said) in [
            (whole[..whole.len() / 2].to_vec(), "gzip data, which are damaged"),
            (b"\x1f\x8b".to_vec(), "gzip data, which are damaged"),
            (b"\xff\xfea\0b".to_vec(), "ends within a character"),
            (b"\xff\xfea\0\0\xd8a\0".to_vec(), "byte 5 (from 1) begins no character"),
        ] {
            let error = text(bytes).expect_err(said);
            assert_eq!(error.kind(), ErrorKind::InvalidData);
            assert!(error.to_string().contains(said), "{error}");
        }
    }

    #[test]
    fn a_small_file_cannot_unpack_to_a_large_one() {
        let line = [&[b'x'; 1023][..], b"\n"].concat();
        let error = text(packed(&line.repeat(SMALL / 1024 + 1))).expect_err("too much");
        assert!(super::super::is_too_much(&error), "{error}");
        assert!(error.to_string().contains("unpack to more than"), "{error}");
        let error = text(packed(&vec![0; SMALL + 2])).expect_err("too much");
        assert!(super::super::is_too_much(&error) && error.to_string().contains("no line ends"), "{error}");
    }
}
