//! Faults in the text of a file, and what to do about them.

use std::fmt;

/// A fault in the text of a file. Text found is quoted, shortened and escaped.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TextFault {
    /// The first line is no Matrix Market header.
    #[error(
        "expected the header `%%MatrixMarket matrix coordinate real general`, found {found}; make it the first line"
    )]
    Header {
        /// The line found.
        found: String,
    },
    /// A header word this reader does not support.
    #[error("the header says {word}: {advice}")]
    HeaderWord {
        /// The word.
        word: String,
        /// Why it is refused and how to convert.
        advice: &'static str,
    },
    /// The line of sizes is missing or malformed.
    #[error("expected the sizes `{expected}` as whole numbers, found {found}; correct the line after the header")]
    Sizes {
        /// Required form of the line.
        expected: &'static str,
        /// The line found.
        found: String,
    },
    /// A size beyond the 32-bit indices of the library.
    #[error("the number of {what} is {found}; at most {} are supported", u32::MAX - 1)]
    SizeTooLarge {
        /// "rows" or "columns".
        what: &'static str,
        /// The size found.
        found: String,
    },
    /// A size far beyond the number of entries.
    #[error("{found} {what} for {entries} entries are implausible; correct the sizes")]
    SizeImplausible {
        /// "rows" or "columns".
        what: &'static str,
        /// The size found.
        found: usize,
        /// Entries promised.
        entries: usize,
    },
    /// A matrix without columns.
    #[error("the matrix has {rows} rows and no columns; constraints need at least one DOF")]
    NoColumns {
        /// Number of rows.
        rows: usize,
    },
    /// A symmetric matrix that is not square.
    #[error(
        "a symmetric matrix has as many rows as columns, found {rows} and {columns}; correct the sizes or write `general`"
    )]
    NotSquare {
        /// Number of rows.
        rows: usize,
        /// Number of columns.
        columns: usize,
    },
    /// An entry of a symmetric matrix outside of the triangle that such files store.
    #[error(
        "row {row}, column {column} is not in the triangle that the header says is stored, the lower one (below the diagonal if \
         skew-symmetric); remove the entry, or write all entries and `general`"
    )]
    OtherTriangle {
        /// Row, 1-based.
        row: usize,
        /// Column, 1-based.
        column: usize,
    },
    /// A line that is no entry.
    #[error("expected `{expected}`, found {found}; correct or remove the line")]
    Entry {
        /// Required form of the line.
        expected: &'static str,
        /// The line found.
        found: String,
    },
    /// A 1-based index that is 0 or above the size.
    #[error(
        "{what} {found} is out of range: the matrix has {size} {what}s, counted from 1; correct the index or the sizes"
    )]
    OutOfRange {
        /// "row" or "column".
        what: &'static str,
        /// The index found.
        found: String,
        /// The size.
        size: usize,
    },
    /// A number that cannot be used.
    #[error("{what} is {found}: {problem}")]
    Number {
        /// Which number.
        what: Quantity,
        /// The text found.
        found: String,
        /// What is wrong with it.
        problem: NumberFault,
    },
    /// An entry beyond the promised number.
    #[error("one entry more than the {promised} promised; correct the number of entries or remove the line")]
    TooMany {
        /// Entries promised by the sizes.
        promised: usize,
    },
    /// The file ends before the last entry promised.
    #[error(
        "{promised} entries are promised, but the file ends after {found}; correct the number or complete the file"
    )]
    TooFew {
        /// Entries promised by the sizes.
        promised: usize,
        /// Entries found.
        found: usize,
    },
    /// A list with a wrong number of items.
    #[error(
        "found {found} {what}, expected {expected}, one for each {each}; correct the file or the sizes of the matrix"
    )]
    Count {
        /// "numbers" or "labels".
        what: &'static str,
        /// Number found.
        found: usize,
        /// Number needed.
        expected: usize,
        /// "row" or "column".
        each: &'static str,
    },
    /// One column prescribed with two values.
    #[error("column {column} is prescribed as {second}, but line {first_line} prescribes {first}; remove one")]
    PrescribedTwice {
        /// The column, 1-based.
        column: usize,
        /// The earlier value.
        first: f64,
        /// The line of the earlier value.
        first_line: usize,
        /// The later value.
        second: f64,
    },
    /// Repeated coefficients of a row and column overflow when summed.
    #[error(
        "the coefficients given for row {row}, column {column} add up to {sum} (the first is in line {first_line}); rescale the row or remove the repeats"
    )]
    SumNotFinite {
        /// Row, 1-based.
        row: usize,
        /// Column, 1-based.
        column: usize,
        /// Line of the first coefficient.
        first_line: usize,
        /// Their sum.
        sum: f64,
    },
    /// A file of relations without any.
    #[error("there is no relation; write one a line, such as `tie_1: 1.0 N12.DX - 1.0 N13.DX = 0.5`")]
    NoRelations,
    /// A word that does not fit into a relation.
    #[error(
        "expected {expected}, found {found}; a relation is `label: 1.0 NAME - 1.0 NAME = 0.5`, with blanks between words"
    )]
    Relation {
        /// Column of the word, in bytes from 1.
        column: usize,
        /// What fits.
        expected: &'static str,
        /// The word.
        found: String,
    },
    /// A number of a relation that cannot be used.
    #[error("{found} is no usable number: {problem}")]
    RelationNumber {
        /// Column of the number, in bytes from 1.
        column: usize,
        /// The text found.
        found: String,
        /// What is wrong with it.
        problem: NumberFault,
    },
}

impl TextFault {
    /// The column of the fault in its line, in bytes from 1, if it is known.
    pub fn column(&self) -> Option<usize> {
        match self {
            Self::Relation { column, .. } | Self::RelationNumber { column, .. } => Some(*column),
            _ => None,
        }
    }
}

/// A fault in the text of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum NumberFault {
    /// No number at all.
    #[error("not a number; write it as 1.5 or 1.5e-3")]
    NotANumber,
    /// `nan` or `inf`.
    #[error("every number must be finite")]
    NotFinite,
    /// Above the range of 64-bit floats.
    #[error("too large for a 64-bit number; rescale the row")]
    Overflow,
    /// Not zero, but below the range of 64-bit floats.
    #[error("too small for a 64-bit number, which would make it zero; rescale the row or write 0")]
    Underflow,
    /// A fraction in a file that promises integers.
    #[error("not an integer, as the header promises; write `real` in the header")]
    NotAnInteger,
}

/// A number in a case; rows and columns count from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// An entry of C.
    Coefficient {
        /// Row.
        row: usize,
        /// Column.
        column: usize,
    },
    /// An entry of b.
    RightHandSide {
        /// Row.
        row: usize,
    },
    /// The value of a prescribed DOF.
    Prescribed {
        /// Column.
        column: usize,
    },
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Coefficient { row, column } => write!(f, "the coefficient in row {row}, column {column}"),
            Self::RightHandSide { row } => write!(f, "the right-hand side of row {row}"),
            Self::Prescribed { column } => write!(f, "the prescribed value of column {column}"),
        }
    }
}

/// Quotes `text` in backquotes: at most 60 characters, with control characters escaped.
pub(crate) fn quote(text: &[u8]) -> String {
    const LONGEST: usize = 60;
    if text.is_empty() {
        return "nothing".into();
    }
    // A character has at most four bytes, so that the cut below drops any character split here.
    let text = String::from_utf8_lossy(&text[..text.len().min(4 * (LONGEST + 1))]);
    let mut quoted: String = text.chars().take(LONGEST).flat_map(plain).collect();
    if text.chars().nth(LONGEST).is_some() {
        quoted.push_str("...");
    }
    format!("`{quoted}`")
}

fn plain(c: char) -> impl Iterator<Item = char> {
    let escape = c.is_control();
    c.escape_default().filter(move |_| escape).chain(std::iter::once(c).filter(move |_| !escape))
}

#[cfg(test)]
mod tests {
    use super::quote;

    #[test]
    fn quotes_are_short_and_printable() {
        assert_eq!(quote(b""), "nothing");
        assert_eq!(quote(b"1 2\tx"), "`1 2\\tx`");
        assert_eq!(quote("größe".as_bytes()), "`größe`");
        assert_eq!(quote(b"\x1f\x8b"), "`\\u{1f}\u{fffd}`");
        assert_eq!(quote(&[b'7'; 400]), format!("`{}...`", "7".repeat(60)));
        assert_eq!(quote(&[b'7'; 60]), format!("`{}`", "7".repeat(60)));
    }
}
