//! A file that is read in chunks of lines.

use std::fs;
use std::io::{self, ErrorKind, Read, Seek, SeekFrom};
use std::ops::{Add, Range};
use std::path::{Path, PathBuf};

use crate::lines::TextLines;
use crate::{ReadError, bytes};

/// Number of bytes read at a time to find the end of the last line of a range.
const PIECE: u64 = 1 << 16;

/// A file that is read in chunks.
#[derive(Debug)]
pub struct ChunkedFile {
    path: PathBuf,
    size: u64,
}

impl ChunkedFile {
    /// Finds the size of the file.
    ///
    /// # Errors
    /// [`ReadError::Io`] if the file does not exist, or if it has no size, like a device or a pipe.
    pub fn open(path: &Path) -> Result<Self, ReadError> {
        let kind = fs::metadata(path).map_err(ReadError::io(path))?;
        if !kind.is_file() && !kind.is_dir() {
            let problem = "it has no size, so that it cannot be read in parts; save it as a file and name that file";
            return Err(ReadError::io(path)(io::Error::new(ErrorKind::Unsupported, problem)));
        }
        let mut byte = [0];
        fs::File::open(path).and_then(|mut file| file.read(&mut byte)).map_err(ReadError::io(path))?;
        Ok(Self { path: path.to_path_buf(), size: kind.len() })
    }

    /// Size of the file in bytes.
    #[expect(clippy::len_without_is_empty, reason = "callers treat an empty file as any other")]
    pub fn len(&self) -> u64 {
        self.size
    }

    /// The path of the file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Reads the lines that start in this range of bytes. The last of them may end beyond the range.
    ///
    /// # Errors
    /// [`ReadError::Io`], also if memory runs out.
    pub fn lines(&self, range: Range<u64>) -> Result<FileChunk, ReadError> {
        let bytes = self.read(range.clone()).map_err(ReadError::io(&self.path))?;
        Ok(FileChunk { path: self.path.clone(), is_first: range.start == 0, bytes })
    }

    fn read(&self, Range { start, end }: Range<u64>) -> io::Result<Vec<u8>> {
        let end = end.min(self.size);
        if start >= end {
            return Ok(Vec::new());
        }
        let mut file = fs::File::open(&self.path)?;
        // Reading starts one byte before the range. If that byte ends a line, a line starts at the range.
        let from = start.saturating_sub(1);
        file.seek(SeekFrom::Start(from))?;
        let mut bytes = bytes::room_for(end - from)?;
        file.by_ref().take(end - from).read_to_end(&mut bytes)?;
        if start > 0 {
            let searched = bytes.len().saturating_sub(1);
            let Some(last) = memchr::memchr(b'\n', &bytes[..searched]) else { return Ok(Vec::new()) };
            bytes.drain(..=last);
        }
        to_end_of_line(&mut file, &mut bytes)?;
        Ok(bytes)
    }

    pub(crate) fn reader(&self) -> Result<io::BufReader<fs::File>, ReadError> {
        fs::File::open(&self.path).map(io::BufReader::new).map_err(ReadError::io(&self.path))
    }
}

fn to_end_of_line(file: &mut fs::File, bytes: &mut Vec<u8>) -> io::Result<()> {
    while bytes.last().is_some_and(|&last| last != b'\n') {
        let before = bytes.len();
        if file.take(PIECE).read_to_end(bytes)? == 0 {
            break;
        }
        if let Some(end) = memchr::memchr(b'\n', &bytes[before..]) {
            bytes.truncate(before + end + 1);
        }
    }
    Ok(())
}

/// Consecutive lines of a file.
#[derive(Debug)]
pub struct FileChunk {
    path: PathBuf,
    /// Whether the chunk is the start of the file.
    is_first: bool,
    bytes: Vec<u8>,
}

/// Counts of the lines of a file or chunk.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LineCount {
    /// Number of all lines.
    pub lines: usize,
    /// Number of lines that are neither blank nor comments.
    pub items: usize,
}

impl Add for LineCount {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self { lines: self.lines + other.lines, items: self.items + other.items }
    }
}

impl FileChunk {
    /// Counts the lines of the chunk.
    pub fn count(&self) -> LineCount {
        let (mut lines, mut items) = (self.after(0), 0);
        while lines.content().is_some() {
            items += 1;
        }
        LineCount { lines: lines.number(), items }
    }

    /// Number of the chunk's last line that is not blank, counted from 1; 0 if all lines are blank.
    pub fn last_filled(&self) -> usize {
        let (mut lines, mut last) = (self.after(0), 0);
        while let Some(line) = lines.any() {
            if !String::from_utf8_lossy(line.text).trim().is_empty() {
                last = line.number;
            }
        }
        last
    }

    /// The lines of the chunk. `number` lines of the file precede it.
    pub(crate) fn after(&self, number: usize) -> TextLines<'_> {
        if self.is_first {
            TextLines::new(&self.path, &self.bytes)
        } else {
            TextLines::after(&self.path, &self.bytes, number)
        }
    }
}
