//! Parses the lines after the sizes into triplets, in one pass over the bytes.

use std::path::Path;

use super::Triplets;
use super::array_places::Positions;
use super::header::{self, FileHead, Header, Symmetry};
use crate::ReadError;
use crate::fault::{Quantity, TextFault, quote};
use crate::file_chunk::{ChunkedFile, FileChunk, LineCount};
use crate::lines::{TextLine, TextLines};
use crate::number::whole;

const ENTRY: &str = "row column value";
const SIZES: &str = "rows columns entries";
const VALUE: &str = "value";
const ARRAY_SIZES: &str = "rows columns";

/// Number of bytes of the shortest entry, `1 1 1` and LF. The text can hold no more entries than its bytes divided by this number, and
/// memory is reserved for no more. Entries of an array are shorter, so their list may have to grow.
const SHORTEST_ENTRY: usize = 6;

/// Largest number of empty rows or columns. Larger sizes are probably typing errors, and would cost memory.
const MOST_EMPTY: usize = 10_000_000;

/// Number of bytes read at a time in the search for an entry.
const SEARCHED: u64 = 1 << 24;

/// Entries: row and column, both from 0, and value.
type Entries = Vec<(usize, usize, f64)>;

/// The header and the sizes of a matrix file, and the place where its entries start.
#[derive(Debug)]
pub struct ChunkedMatrix {
    rows: usize,
    columns: usize,
    /// Number of entries that the line with the sizes gives. Each entry is on a line of its own.
    entries: usize,
    header: Header,
    /// Number of the line with the sizes.
    sizes_line: usize,
    start: u64,
}

pub(crate) fn parse(path: &Path, text: &[u8]) -> Result<Triplets, ReadError> {
    let mut lines = TextLines::new(path, text);
    let head = ChunkedMatrix::parse_head(path, &mut lines)?;
    let (entries, found) = head.parse_entries(&mut lines, 0)?;
    head.check_count(path, found)?;
    Ok(Triplets { rows: head.rows, columns: head.columns, entries })
}

impl ChunkedMatrix {
    /// Reads the header and the sizes of a matrix file.
    ///
    /// # Errors
    /// [`ReadError::Io`], or [`ReadError::Malformed`] with the line.
    pub fn open(file: &ChunkedFile) -> Result<Self, ReadError> {
        let head = FileHead::read(file, false)?;
        let read = Self::parse_head(file.path(), &mut TextLines::new(file.path(), &head.text))?;
        Ok(Self { start: head.end, ..read })
    }

    fn parse_head(path: &Path, lines: &mut TextLines) -> Result<Self, ReadError> {
        let header = header::read_matrix(path, lines)?;
        let expected = if header.is_array { ARRAY_SIZES } else { SIZES };
        let Some(line) = lines.content() else {
            return Err(lines.fault(TextFault::Sizes { expected, found: quote(b"") }));
        };
        let malformed = || line.fault(TextFault::Sizes { expected, found: line.quote() });
        let (rows, columns, entries) = if header.is_array {
            let [rows, columns] = line.fields().ok_or_else(malformed)?;
            (rows, columns, header.symmetry.stored(rows, columns).ok_or_else(malformed)?)
        } else {
            let [rows, columns, entries] = line.fields().ok_or_else(malformed)?;
            (rows, columns, whole(entries).ok_or_else(malformed)?)
        };
        let size = |what, word| size(&line, what, word, entries)?.ok_or_else(malformed);
        let (rows, columns) = (size("rows", rows)?, size("columns", columns)?);
        if columns == 0 {
            return Err(line.fault(TextFault::NoColumns { rows }));
        }
        if header.symmetry != Symmetry::General && rows != columns {
            return Err(line.fault(TextFault::NotSquare { rows, columns }));
        }
        Ok(Self { rows, columns, entries, header, sizes_line: line.number, start: 0 })
    }

    /// Number of rows m.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of columns n.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// The byte of the file at which the entries start.
    pub fn start(&self) -> u64 {
        self.start
    }

    /// Counts of the lines that precede the entries.
    pub fn before(&self) -> LineCount {
        LineCount { lines: self.sizes_line, items: 0 }
    }

    /// Parses the entries in a chunk. `before` counts the lines and entries of the file that precede it. Rows and columns count from 0.
    ///
    /// # Errors
    /// [`ReadError::Malformed`] with the line.
    pub fn entries(&self, lines: &FileChunk, before: LineCount) -> Result<Vec<(usize, usize, f64)>, ReadError> {
        self.parse_entries(&mut lines.after(before.lines), before.items).map(|(entries, _)| entries)
    }

    /// Parses the entries of these lines. Also returns the number of lines with an entry. `before` entries of the file precede them.
    fn parse_entries(&self, lines: &mut TextLines, before: usize) -> Result<(Entries, usize), ReadError> {
        let room = self.entries.saturating_sub(before).min((lines.unread_bytes() + 1) / SHORTEST_ENTRY);
        let mut entries = Vec::with_capacity(room);
        let mut positions = self.positions(before);
        let mut found = 0;
        while let Some(line) = lines.content() {
            if before + found >= self.entries {
                return Err(line.fault(TextFault::TooMany { promised: self.entries }));
            }
            found += 1;
            entries.extend(self.both(self.entry(&line, &mut positions)?));
        }
        Ok((entries, found))
    }

    fn positions(&self, before: usize) -> Positions {
        Positions::after(before, self.rows, self.header.symmetry)
    }

    /// Checks that the file has no fewer entries than the line with the sizes says. `found` entries were read from it.
    ///
    /// # Errors
    /// [`ReadError::Malformed`] if entries are missing.
    pub fn check(&self, file: &ChunkedFile, found: usize) -> Result<(), ReadError> {
        self.check_count(file.path(), found)
    }

    fn check_count(&self, path: &Path, found: usize) -> Result<(), ReadError> {
        let (promised, line) = (self.entries, Some(self.sizes_line));
        if found < promised {
            return Err(ReadError::malformed(path, line, TextFault::TooFew { promised, found }));
        }
        Ok(())
    }

    /// Parses the entry of a line. In an array file, `positions` gives its row and column.
    fn entry(&self, line: &TextLine, positions: &mut Positions) -> Result<(usize, usize, f64), ReadError> {
        let (row, column, value) = if self.header.is_array {
            let [value] = line.fields().ok_or_else(|| line.malformed(VALUE))?;
            let (row, column) = positions.next_place();
            (row, column, value)
        } else {
            let [row, column, value] = line.fields().ok_or_else(|| line.malformed(ENTRY))?;
            let row = index(line, "row", row, self.rows)?;
            (row, index(line, "column", column, self.columns)?, value)
        };
        self.header.symmetry.check(line, row, column)?;
        let what = Quantity::Coefficient { row: row + 1, column: column + 1 };
        Ok((row, column, line.number(value, what, self.header.is_integer)?))
    }

    /// An entry and its mirror image, if it has one. A zero of an array file gives no entry.
    fn both(&self, (row, column, value): (usize, usize, f64)) -> impl Iterator<Item = (usize, usize, f64)> + use<> {
        let mirrored = match self.header.symmetry {
            Symmetry::General => None,
            Symmetry::Symmetric => (row != column).then_some((column, row, value)),
            Symmetry::Skew => Some((column, row, -value)),
        };
        let is_kept = !self.header.is_array || value != 0.0;
        is_kept.then_some((row, column, value)).into_iter().chain(mirrored.filter(|_| is_kept))
    }
}

/// The first and the last line with an entry for this row and column, which count from 0. `None` if there is none.
pub(crate) fn find_entry(path: &Path, place: (usize, usize)) -> Result<Option<(usize, usize)>, ReadError> {
    let file = ChunkedFile::open(path)?;
    let matrix = ChunkedMatrix::open(&file)?;
    let (mut before, mut start, mut found) = (matrix.sizes_line, matrix.start, None);
    let mut positions = matrix.positions(0);
    while start < file.len() {
        let chunk = file.lines(start..start.saturating_add(SEARCHED))?;
        let mut lines = chunk.after(before);
        while let Some(line) = lines.content() {
            let entry = matrix.entry(&line, &mut positions)?;
            if matrix.both(entry).any(|(row, column, _)| (row, column) == place) {
                found = Some((found.map_or(line.number, |(first, _)| first), line.number));
            }
        }
        (before, start) = (lines.number().max(before), start.saturating_add(SEARCHED));
    }
    Ok(found)
}

/// Parses the number of rows or columns; `None` if the word is no number. A size of `u32::MAX` or more is an error, because the library
/// reserves the largest index.
fn size(line: &TextLine, what: &'static str, word: &[u8], entries: usize) -> Result<Option<usize>, ReadError> {
    match whole(word) {
        Some(size) if size >= u32::MAX as usize => {
            Err(line.fault(TextFault::SizeTooLarge { what, found: quote(word) }))
        }
        Some(found) if found.saturating_sub(entries) > MOST_EMPTY => {
            Err(line.fault(TextFault::SizeImplausible { what, found, entries }))
        }
        size => Ok(size),
    }
}

/// Converts an index of the file, which counts from 1, to one that counts from 0.
fn index(line: &TextLine, what: &'static str, word: &[u8], size: usize) -> Result<usize, ReadError> {
    let index = whole(word).ok_or_else(|| line.malformed(ENTRY))?;
    if index == 0 || index > size {
        return Err(line.fault(TextFault::OutOfRange { what, found: quote(word), size }));
    }
    Ok(index - 1)
}
