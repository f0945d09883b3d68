//! What can be wrong in the text of a file, and what the user can do.

use std::fmt;

/// What is wrong in the text of a file. Text that was found is quoted, shortened and escaped.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TextFault {
    /// The first line is no Matrix Market header.
    #[error(
        "expected the header `%%MatrixMarket matrix coordinate real general`, found {found}; make it the first line"
    )]
    Header {
        /// The text of the line.
        found: String,
    },
    /// The header has a word that this reader does not support.
    #[error("the header says {word}: {advice}")]
    HeaderWord {
        /// The word.
        word: String,
        /// Why the word is refused, and how to convert the file.
        advice: &'static str,
    },
    /// The line with the sizes is missing or malformed.
    #[error("expected the sizes `{expected}` as whole numbers, found {found}; correct the line after the header")]
    Sizes {
        /// The form that the line should have.
        expected: &'static str,
        /// The text of the line.
        found: String,
    },
    /// A size exceeds the 32-bit indices of the library.
    #[error("the number of {what} is {found}; at most {} are supported", u32::MAX - 1)]
    SizeTooLarge {
        /// Which size: "rows" or "columns".
        what: &'static str,
        /// The text of the size.
        found: String,
    },
    /// A size is far larger than the number of entries.
    #[error("{found} {what} for {entries} entries are implausible; correct the sizes")]
    SizeImplausible {
        /// Which size: "rows" or "columns".
        what: &'static str,
        /// The size in the file.
        found: usize,
        /// The number of entries that the line with the sizes gives.
        entries: usize,
    },
    /// The matrix has no columns.
    #[error("the matrix has {rows} rows and no columns; constraints need at least one DOF")]
    NoColumns {
        /// Number of rows.
        rows: usize,
    },
    /// The matrix is called symmetric but is not square.
    #[error(
        "a symmetric matrix has as many rows as columns, found {rows} and {columns}; correct the sizes or write `general`"
    )]
    NotSquare {
        /// Number of rows.
        rows: usize,
        /// Number of columns.
        columns: usize,
    },
    /// An entry of a symmetric matrix lies outside of the triangle that such files store.
    #[error(
        "row {row}, column {column} is not in the triangle that the header says is stored, the lower one (below the diagonal if \
         skew-symmetric); remove the entry, or write all entries and `general`"
    )]
    OtherTriangle {
        /// The row, from 1.
        row: usize,
        /// The column, from 1.
        column: usize,
    },
    /// A line holds no valid entry.
    #[error("expected `{expected}`, found {found}; correct or remove the line")]
    Entry {
        /// The form that the line should have.
        expected: &'static str,
        /// The text of the line.
        found: String,
    },
    /// An index is 0 or exceeds the size; indices count from 1.
    #[error(
        "{what} {found} is out of range: the matrix has {size} {what}s, counted from 1; correct the index or the sizes"
    )]
    OutOfRange {
        /// Which index: "row" or "column".
        what: &'static str,
        /// The text of the index.
        found: String,
        /// The number of rows or columns of the matrix.
        size: usize,
    },
    /// The text is no usable number.
    #[error("{what} is {found}: {problem}")]
    Number {
        /// What the number should be: an entry of the matrix, a right-hand side or a prescribed value.
        what: Quantity,
        /// The text of the number.
        found: String,
        /// What is wrong with the number.
        problem: NumberFault,
    },
    /// The file has more entries than the line with the sizes says.
    #[error("one entry more than the {promised} promised; correct the number of entries or remove the line")]
    TooMany {
        /// The number of entries that the line with the sizes gives.
        promised: usize,
    },
    /// The file has fewer entries than the line with the sizes says.
    #[error(
        "{promised} entries are promised, but the file ends after {found}; correct the number or complete the file"
    )]
    TooFew {
        /// The number of entries that the line with the sizes gives.
        promised: usize,
        /// The number of entries in the file.
        found: usize,
    },
    /// A list has the wrong number of items.
    #[error(
        "found {found} {what}, expected {expected}, one for each {each}; correct the file or the sizes of the matrix"
    )]
    Count {
        /// What the list holds: "numbers" or "labels".
        what: &'static str,
        /// The number of items in the list.
        found: usize,
        /// The number of items that it should have.
        expected: usize,
        /// What each item belongs to: "row" or "column".
        each: &'static str,
    },
    /// A column is prescribed twice, with different values.
    #[error("column {column} is prescribed as {second}, but line {first_line} prescribes {first}; remove one")]
    PrescribedTwice {
        /// The column, from 1.
        column: usize,
        /// The value that is given first.
        first: f64,
        /// The line of the earlier value.
        first_line: usize,
        /// The value that is given later.
        second: f64,
    },
    /// Repeated coefficients of one row and column overflow when they are summed.
    #[error(
        "the coefficients given for row {row}, column {column} add up to {sum} (the first is in line {first_line}); rescale the row or remove the repeats"
    )]
    SumNotFinite {
        /// The row, from 1.
        row: usize,
        /// The column, from 1.
        column: usize,
        /// The line of the first of these coefficients.
        first_line: usize,
        /// The sum of the coefficients.
        sum: f64,
    },
    /// A file of relations holds no relation.
    #[error("there is no relation; write one a line, such as `tie_1: 1.0 N12.DX - 1.0 N13.DX = 0.5`")]
    NoRelations,
    /// A word does not fit into a relation at its place.
    #[error(
        "expected {expected}, found {found}; a relation is `label: 1.0 NAME - 1.0 NAME = 0.5`, with blanks between words"
    )]
    Relation {
        /// Where the word starts in its line, in bytes from 1.
        column: usize,
        /// What would fit at this place.
        expected: &'static str,
        /// The text of the word.
        found: String,
    },
    /// The text of a number in a relation is no usable number.
    #[error("{found} is no usable number: {problem}")]
    RelationNumber {
        /// Where the number starts in its line, in bytes from 1.
        column: usize,
        /// The text of the number.
        found: String,
        /// What is wrong with the number.
        problem: NumberFault,
    },
}

impl TextFault {
    /// Where the fault starts in its line, in bytes from 1; `None` if this is not known.
    pub fn column(&self) -> Option<usize> {
        match self {
            Self::Relation { column, .. } | Self::RelationNumber { column, .. } => Some(*column),
            _ => None,
        }
    }
}

/// What is wrong with the text of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum NumberFault {
    /// The text is no number.
    #[error("not a number; write it as 1.5 or 1.5e-3")]
    NotANumber,
    /// The number is `nan` or `inf`.
    #[error("every number must be finite")]
    NotFinite,
    /// The magnitude of the number is above the range of 64-bit floats.
    #[error("too large for a 64-bit number; rescale the row")]
    Overflow,
    /// The number is not zero, but its magnitude is below the range of 64-bit floats.
    #[error("too small for a 64-bit number, which would make it zero; rescale the row or write 0")]
    Underflow,
    /// The number has a fraction, but the header of the file says `integer`.
    #[error("not an integer, as the header promises; write `real` in the header")]
    NotAnInteger,
}

/// Which number of a case is meant. Rows and columns count from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// An entry of the matrix C.
    Coefficient {
        /// The row of the entry.
        row: usize,
        /// The column of the entry.
        column: usize,
    },
    /// An entry of the right-hand side b.
    RightHandSide {
        /// The row of the entry.
        row: usize,
    },
    /// The value of a prescribed DOF.
    Prescribed {
        /// The column of the DOF.
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

/// Quotes `text` in backquotes. At most 60 characters are shown, and control characters are escaped.
pub(crate) fn quote(text: &[u8]) -> String {
    const LONGEST: usize = 60;
    if text.is_empty() {
        return "nothing".into();
    }
    // The limit in bytes may split a character. A character has at most four bytes, so a split one is never among the first `LONGEST`.
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
