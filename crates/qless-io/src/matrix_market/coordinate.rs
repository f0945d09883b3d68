//! `row column value` lines to triplets, in one pass over the bytes.

use super::Triplets;
use super::header::{self, Layout};
use crate::error::At;
use crate::fault::{Fault, NumberFault, Quantity, quote};
use crate::lines::{Line, Lines};
use crate::number::{real, whole};

const ENTRY: &str = "row column value";
const SIZES: &str = "rows columns entries";

/// Shortest entry with its line end: `1 1 1` and LF.
const SHORTEST_ENTRY: usize = 6;

/// Empty rows or columns beyond this many are a slip of the size line, not a model; they cost memory.
const MOST_EMPTY: usize = 10_000_000;

struct Sizes {
    rows: usize,
    columns: usize,
    entries: usize,
    line: usize,
}

pub(super) fn parse(bytes: &[u8]) -> Result<Triplets, At> {
    let mut lines = Lines::new(bytes);
    let integer = header::read(&mut lines, Layout::Coordinate)?.integer;
    let sizes = sizes(&mut lines)?;
    let mut entries = Vec::with_capacity(sizes.entries.min((lines.left() + 1) / SHORTEST_ENTRY));
    while let Some(line) = lines.content() {
        if entries.len() == sizes.entries {
            return Err(line.fault(Fault::TooMany { promised: sizes.entries }));
        }
        entries.push(entry(&line, &sizes, integer)?);
    }
    if entries.len() < sizes.entries {
        return Err(At::line(sizes.line, Fault::TooFew { promised: sizes.entries, found: entries.len() }));
    }
    Ok(Triplets { rows: sizes.rows, columns: sizes.columns, entries })
}

pub(super) fn lines_of(bytes: &[u8], row: usize, column: usize) -> Result<Option<(usize, usize)>, At> {
    let mut lines = Lines::new(bytes);
    let integer = header::read(&mut lines, Layout::Coordinate)?.integer;
    let sizes = sizes(&mut lines)?;
    let mut found = None;
    while let Some(line) = lines.content() {
        let (i, j, _) = entry(&line, &sizes, integer)?;
        if (i, j) == (row, column) {
            found = Some((found.map_or(line.number, |(first, _)| first), line.number));
        }
    }
    Ok(found)
}

fn sizes(lines: &mut Lines) -> Result<Sizes, At> {
    let Some(line) = lines.content() else {
        return Err(At::line(lines.number(), Fault::Sizes { expected: SIZES, found: quote(b"") }));
    };
    let malformed = || line.fault(Fault::Sizes { expected: SIZES, found: line.quote() });
    let [rows, columns, entries] = line.fields().ok_or_else(malformed)?;
    let entries = whole(entries).ok_or_else(malformed)?;
    let size = |what, word| size(&line, what, word, entries)?.ok_or_else(malformed);
    let sizes = Sizes { rows: size("rows", rows)?, columns: size("columns", columns)?, entries, line: line.number };
    if sizes.columns == 0 {
        return Err(line.fault(Fault::NoColumns { rows: sizes.rows }));
    }
    Ok(sizes)
}

/// A number of rows or columns, if it is one; the library's largest index is kept back.
fn size(line: &Line, what: &'static str, word: &[u8], entries: usize) -> Result<Option<usize>, At> {
    match whole(word) {
        Some(size) if size >= u32::MAX as usize => Err(line.fault(Fault::SizeTooLarge { what, found: quote(word) })),
        Some(found) if found.saturating_sub(entries) > MOST_EMPTY => {
            Err(line.fault(Fault::SizeImplausible { what, found, entries }))
        }
        size => Ok(size),
    }
}

fn entry(line: &Line, sizes: &Sizes, integer: bool) -> Result<(usize, usize, f64), At> {
    let [row, column, value] = line.fields().ok_or_else(|| line.malformed(ENTRY))?;
    let row = index(line, "row", row, sizes.rows)?;
    let column = index(line, "column", column, sizes.columns)?;
    match real(value) {
        Ok(number) if !integer || number.fract() == 0.0 => Ok((row, column, number)),
        other => Err(line.fault(Fault::Number {
            what: Quantity::Coefficient { row: row + 1, column: column + 1 },
            found: quote(value),
            problem: other.err().unwrap_or(NumberFault::NotAnInteger),
        })),
    }
}

/// A 1-based index of the file as a 0-based one.
fn index(line: &Line, what: &'static str, word: &[u8], size: usize) -> Result<usize, At> {
    let index = whole(word).ok_or_else(|| line.malformed(ENTRY))?;
    if index == 0 || index > size {
        return Err(line.fault(Fault::OutOfRange { what, found: quote(word), size }));
    }
    Ok(index - 1)
}
