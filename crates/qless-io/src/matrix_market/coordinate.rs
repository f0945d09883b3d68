//! Parses `row column value` lines into triplets, in one pass over the bytes.

use super::Triplets;
use super::header::{self, MarketLayout};
use crate::error::FaultAt;
use crate::fault::{NumberFault, Quantity, TextFault, quote};
use crate::lines::{TextLine, TextLines};
use crate::number::{real, whole};

const ENTRY: &str = "row column value";
const SIZES: &str = "rows columns entries";

/// Bytes of the shortest entry, `1 1 1` and LF.
const SHORTEST_ENTRY: usize = 6;

/// Most empty rows or columns. Larger sizes are typing errors, and cost memory.
const MOST_EMPTY: usize = 10_000_000;

/// Header and sizes of a matrix file.
#[derive(Debug)]
pub(crate) struct MatrixHead {
    pub rows: usize,
    pub columns: usize,
    pub entries: usize,
    /// Line of the sizes.
    line: usize,
    integer: bool,
}

pub(super) fn parse(bytes: &[u8]) -> Result<Triplets, FaultAt> {
    let mut lines = TextLines::new(bytes);
    let head = MatrixHead::read(&mut lines)?;
    let entries = head.entries(&mut lines, 0)?;
    head.check_count(entries.len())?;
    Ok(Triplets { rows: head.rows, columns: head.columns, entries })
}

impl MatrixHead {
    pub(crate) fn read(lines: &mut TextLines) -> Result<Self, FaultAt> {
        let integer = header::read(lines, MarketLayout::Coordinate)?.integer;
        sizes(lines, integer)
    }

    /// The entries in these lines, which follow `before` others.
    pub(crate) fn entries(&self, lines: &mut TextLines, before: usize) -> Result<Vec<(usize, usize, f64)>, FaultAt> {
        let room = self.entries.saturating_sub(before).min((lines.unread_bytes() + 1) / SHORTEST_ENTRY);
        let mut entries = Vec::with_capacity(room);
        while let Some(line) = lines.content() {
            if before + entries.len() >= self.entries {
                return Err(line.fault(TextFault::TooMany { promised: self.entries }));
            }
            entries.push(entry(&line, self)?);
        }
        Ok(entries)
    }

    /// First and last of these lines with an entry of this row and column.
    pub(crate) fn lines_of(
        &self,
        lines: &mut TextLines,
        place: (usize, usize),
    ) -> Result<Option<(usize, usize)>, FaultAt> {
        let mut found = None;
        while let Some(line) = lines.content() {
            let (row, column, _) = entry(&line, self)?;
            if (row, column) == place {
                found = Some((found.map_or(line.number, |(first, _)| first), line.number));
            }
        }
        Ok(found)
    }

    /// Checks that all promised entries were found.
    pub(crate) fn check_count(&self, found: usize) -> Result<(), FaultAt> {
        let promised = self.entries;
        if found < promised { Err(FaultAt::line(self.line, TextFault::TooFew { promised, found })) } else { Ok(()) }
    }
}

fn sizes(lines: &mut TextLines, integer: bool) -> Result<MatrixHead, FaultAt> {
    let Some(line) = lines.content() else {
        return Err(FaultAt::line(lines.number(), TextFault::Sizes { expected: SIZES, found: quote(b"") }));
    };
    let malformed = || line.fault(TextFault::Sizes { expected: SIZES, found: line.quote() });
    let [rows, columns, entries] = line.fields().ok_or_else(malformed)?;
    let entries = whole(entries).ok_or_else(malformed)?;
    let size = |what, word| size(&line, what, word, entries)?.ok_or_else(malformed);
    let (rows, columns) = (size("rows", rows)?, size("columns", columns)?);
    if columns == 0 {
        return Err(line.fault(TextFault::NoColumns { rows }));
    }
    Ok(MatrixHead { rows, columns, entries, line: line.number, integer })
}

/// Parses a number of rows or columns; `None` if the word is no number. The library reserves the largest index.
fn size(line: &TextLine, what: &'static str, word: &[u8], entries: usize) -> Result<Option<usize>, FaultAt> {
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

fn entry(line: &TextLine, head: &MatrixHead) -> Result<(usize, usize, f64), FaultAt> {
    let [row, column, value] = line.fields().ok_or_else(|| line.malformed(ENTRY))?;
    let row = index(line, "row", row, head.rows)?;
    let column = index(line, "column", column, head.columns)?;
    match real(value) {
        Ok(number) if !head.integer || number.fract() == 0.0 => Ok((row, column, number)),
        other => Err(line.fault(TextFault::Number {
            what: Quantity::Coefficient { row: row + 1, column: column + 1 },
            found: quote(value),
            problem: other.err().unwrap_or(NumberFault::NotAnInteger),
        })),
    }
}

/// Converts a 1-based index of the file to a 0-based one.
fn index(line: &TextLine, what: &'static str, word: &[u8], size: usize) -> Result<usize, FaultAt> {
    let index = whole(word).ok_or_else(|| line.malformed(ENTRY))?;
    if index == 0 || index > size {
        return Err(line.fault(TextFault::OutOfRange { what, found: quote(word), size }));
    }
    Ok(index - 1)
}
