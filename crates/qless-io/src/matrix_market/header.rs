//! The header `%%MatrixMarket matrix FORMAT FIELD SYMMETRY`: variants that are read, and advice for the others.

use crate::error::FaultAt;
use crate::fault::{TextFault, quote};
use crate::lines::{TextLine, TextLines};

/// Layout of the entries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum MarketLayout {
    /// `row column value`.
    Coordinate,
    /// Values only, column by column.
    Array,
}

/// Content of a supported header.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct MarketHeader {
    pub integer: bool,
    pub line: usize,
}

/// Whether a text starts with a Matrix Market header.
pub(crate) fn is_present(bytes: &[u8]) -> bool {
    first_line(&mut TextLines::new(bytes)).is_some_and(|line| is_banner(&line))
}

/// Reads the header of a `layout` file.
pub(crate) fn read(lines: &mut TextLines, layout: MarketLayout) -> Result<MarketHeader, FaultAt> {
    let Some(line) = first_line(lines) else {
        return Err(FaultAt::whole_file(TextFault::Header { found: quote(b"") }));
    };
    let words: Vec<&[u8]> = line.text.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty()).collect();
    let &[_, object, format, field, symmetry] = words.as_slice() else {
        return Err(line.fault(TextFault::Header { found: line.quote() }));
    };
    if !is_banner(&line) {
        return Err(line.fault(TextFault::Header { found: line.quote() }));
    }
    accept(&line, object, &["matrix"])?;
    let format_read = if layout == MarketLayout::Coordinate { "coordinate" } else { "array" };
    accept(&line, format, &[format_read])?;
    accept(&line, field, &["real", "integer"])?;
    accept(&line, symmetry, &["general"])?;
    Ok(MarketHeader { integer: field.eq_ignore_ascii_case(b"integer"), line: line.number })
}

fn first_line<'a>(lines: &mut TextLines<'a>) -> Option<TextLine<'a>> {
    loop {
        let line = lines.any()?;
        if !line.text.trim_ascii().is_empty() {
            return Some(line);
        }
    }
}

pub(crate) fn is_banner(line: &TextLine) -> bool {
    let word = line.text.trim_ascii().split(u8::is_ascii_whitespace).next().unwrap_or_default();
    [&b"%%MatrixMarket"[..], b"%MatrixMarket"].iter().any(|banner| word.eq_ignore_ascii_case(banner))
}

fn accept(line: &TextLine, word: &[u8], known: &[&str]) -> Result<(), FaultAt> {
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
        b"symmetric" => "only one triangle is stored; write both triangles and `general`",
        b"skew-symmetric" => {
            "only one triangle is stored; write both triangles, the upper with the sign changed, and `general`"
        }
        b"array" => "the matrix is dense; write its nonzero entries as `row column value` and `coordinate`",
        b"coordinate" => "the vector is sparse; write all its values, one a line, and `array`",
        _ => "unknown; expected `matrix coordinate real general` (`array` for a vector)",
    }
}
