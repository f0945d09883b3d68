//! Reads files into memory, within limits.
//!
//! A regular file may be as large as memory. A device or a pipe has no size and may never end: reading stops after
//! [`STREAM`] bytes, or after [`LINE`] bytes without a line end. The path `-` is standard input. Packed or encoded
//! text is converted to plain text ([`plain`]).

mod plain;

use std::fs::File;
use std::io::{self, ErrorKind, Read};
use std::path::Path;

pub use plain::without_gz;

/// Largest number of bytes that are read from a source without a size.
const STREAM: usize = 1 << 28;
/// Largest length of a line, in bytes, in a source without a size.
pub(crate) const LINE: usize = 1 << 20;
/// Bytes read at a time.
const CHUNK: u64 = 1 << 16;

/// Why reading stopped before the end of a file.
#[derive(Debug, thiserror::Error)]
enum TooMuch {
    #[error(
        "it continues after {read} bytes, but at most {STREAM} are read from a source without a size; save it as a file and name that file"
    )]
    Stream { read: usize },
    #[error("no line ends within {read} bytes, but a line may have at most {LINE}; name a text file")]
    Line { read: usize },
    #[error("its {size} bytes do not fit into the free memory; free some or split the file")]
    Memory { size: usize },
    #[error("its {packed} packed bytes unpack to more than the limit of {most}; unpack it and name the unpacked file")]
    Unpacked { packed: usize, most: usize },
}

impl From<TooMuch> for io::Error {
    fn from(error: TooMuch) -> Self {
        let kind =
            if matches!(error, TooMuch::Memory { .. }) { ErrorKind::OutOfMemory } else { ErrorKind::FileTooLarge };
        Self::new(kind, error)
    }
}

/// Whether an error of [`read`] means that a limit of size or memory was exceeded.
pub(crate) fn is_too_much(error: &io::Error) -> bool {
    matches!(error.kind(), ErrorKind::OutOfMemory | ErrorKind::FileTooLarge)
}

/// Reads the whole text of a file.
pub(crate) fn read(path: &Path) -> io::Result<Vec<u8>> {
    if path == Path::new("-") {
        return plain::text(stored(io::stdin().lock(), 0)?);
    }
    let file = File::open(path)?;
    let kind = file.metadata()?;
    plain::text(stored(file, if kind.is_file() { kind.len() } else { 0 })?)
}

/// Reads all bytes of a source. `size` is the expected number of bytes, or 0 if it is unknown.
fn stored(mut file: impl Read, size: u64) -> io::Result<Vec<u8>> {
    let whole = usize::try_from(size).unwrap_or(usize::MAX);
    let mut bytes = room_for(size)?;
    let mut line = 0;
    loop {
        let before = bytes.len();
        let room = |error: io::Error| match error.kind() {
            ErrorKind::OutOfMemory => TooMuch::Memory { size: before.max(whole) }.into(),
            _ => error,
        };
        if file.by_ref().take(size.max(CHUNK)).read_to_end(&mut bytes).map_err(room)? == 0 {
            return Ok(bytes);
        }
        line = memchr::memrchr(b'\n', &bytes[before..]).map_or(line, |at| before + at + 1);
        if bytes.len() > whole {
            check(bytes.len(), bytes.len() - line)?;
        }
    }
}

/// Reserves `size` bytes and one more. With this byte the end of the file is found without enlarging the buffer.
pub(crate) fn room_for(size: u64) -> io::Result<Vec<u8>> {
    let size = usize::try_from(size).unwrap_or(usize::MAX);
    let mut bytes = Vec::new();
    bytes.try_reserve_exact(size.saturating_add(1)).map_err(|_| TooMuch::Memory { size })?;
    Ok(bytes)
}

/// Checks the limits of a source without a size. `read` is the number of bytes so far, and `open` the number of bytes after the last line
/// end.
fn check(read: usize, open: usize) -> Result<(), TooMuch> {
    if open > LINE {
        return Err(TooMuch::Line { read: open });
    }
    if read > STREAM { Err(TooMuch::Stream { read }) } else { Ok(()) }
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn endless_sources_are_refused() {
        let error = read(Path::new("/dev/zero")).expect_err("no end");
        assert!(
            is_too_much(&error)
                && error.to_string().contains("no line ends within 1114112 bytes, but a line may have at most 1048576")
        );
        assert!(check(STREAM, LINE).is_ok());
        let error = io::Error::from(check(STREAM + 1, 0).expect_err("too much"));
        assert!(is_too_much(&error) && error.to_string().contains("after 268435457 bytes"), "{error}");
    }

    #[test]
    fn files_and_streams_are_read_whole() {
        let place = tempfile::tempdir().expect("a temporary folder");
        let path = place.path().join("long");
        // A regular file may have lines of any length; its parser refuses long ones.
        let text = "x".repeat(2 * LINE);
        std::fs::write(&path, &text).expect("written");
        assert!(read(&path).expect("read") == text.as_bytes());
        assert!(!read(Path::new("/proc/self/stat")).unwrap_or_else(|_| b"no /proc".to_vec()).is_empty());
    }

    #[test]
    fn a_file_larger_than_memory_is_refused_before_it_is_read() {
        let place = tempfile::tempdir().expect("a temporary folder");
        let path = place.path().join("sparse");
        let file = File::create(&path).expect("created");
        if file.set_len(1 << 43).is_ok() {
            let error = read(&path).expect_err("8 TiB");
            assert!(is_too_much(&error) && error.to_string().contains("its 8796093022208 bytes"), "{error}");
        }
    }
}
