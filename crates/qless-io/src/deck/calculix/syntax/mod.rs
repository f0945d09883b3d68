//! Syntax of decks: the modules read keyword cards (`card`, `walk`, `assembly`, `parameters`), and this file reads lines of data and their fields.

pub mod assembly;
pub mod card;
pub mod parameters;
pub mod walk;

pub use card::{KeywordCard, Scope};

use std::ops::Range;
use std::sync::Arc;

use crate::NumberFault;
use crate::deck::Problem;
use crate::fault::quote;
use crate::number::{real, whole};

/// Consecutive lines of a file.
#[derive(Clone)]
pub struct DataPiece {
    pub file: u32,
    /// The first line, from 1.
    pub line: u32,
    pub range: Range<usize>,
    pub text: Arc<Vec<u8>>,
}

/// Iterator over lines of data; skips comments and blank lines.
pub struct DataLines<'a> {
    pieces: std::slice::Iter<'a, DataPiece>,
    file: u32,
    number: u32,
    rest: &'a [u8],
}

/// One line of data.
#[derive(Clone, Copy)]
pub struct DataLine<'a> {
    pub file: u32,
    pub number: u32,
    pub text: &'a [u8],
}

impl<'a> DataLines<'a> {
    pub fn new(pieces: &'a [DataPiece]) -> Self {
        Self { pieces: pieces.iter(), file: 0, number: 0, rest: &[] }
    }
}

impl<'a> Iterator for DataLines<'a> {
    type Item = DataLine<'a>;

    fn next(&mut self) -> Option<DataLine<'a>> {
        loop {
            while self.rest.is_empty() {
                let piece = self.pieces.next()?;
                (self.file, self.number, self.rest) = (piece.file, piece.line - 1, &piece.text[piece.range.clone()]);
            }
            let end = memchr::memchr(b'\n', self.rest).unwrap_or(self.rest.len());
            let text = &self.rest[..end];
            self.rest = self.rest.get(end + 1..).unwrap_or_default();
            self.number += 1;
            let begins = text.trim_ascii_start();
            if !begins.is_empty() && !begins.starts_with(b"**") {
                return Some(DataLine { file: self.file, number: self.number, text });
            }
        }
    }
}

impl<'a> DataLine<'a> {
    /// Fields between commas, without surrounding blanks. An empty field after the last comma does not count.
    pub fn fields(&self) -> impl Iterator<Item = &'a [u8]> + use<'a> {
        let text = self.text.trim_ascii();
        let text = text.strip_suffix(b",").unwrap_or(text);
        text.split(|&byte| byte == b',').map(<[u8]>::trim_ascii)
    }
}

/// Folds a name for comparison: capitals, no blanks, no quotes.
pub fn fold_name(text: &str) -> String {
    text.chars().filter(|c| !c.is_whitespace() && *c != '"').map(|c| c.to_ascii_uppercase()).collect()
}

/// A wrong field: its number, from 1, and the problem.
pub type FieldFault = (Option<usize>, Problem);

/// The fault of a field, unless this reader does not follow the field.
pub fn unless_not_followed(fault: FieldFault) -> Result<(), FieldFault> {
    if matches!(fault.1, Problem::NotFollowed { .. }) { Ok(()) } else { Err(fault) }
}

/// Fields of a line, read one by one.
pub struct DataFields<'a> {
    rest: Box<dyn Iterator<Item = &'a [u8]> + 'a>,
    /// Number of the last field read, from 1.
    pub number: usize,
}

impl<'a> DataFields<'a> {
    pub fn new(line: &DataLine<'a>) -> Self {
        Self { rest: Box::new(line.fields()), number: 0 }
    }

    /// The next field; it may be empty.
    pub fn next(&mut self) -> Option<&'a [u8]> {
        self.number += 1;
        self.rest.next()
    }

    /// Reads the number of a node, a DOF or the like; `None` for an empty or missing field.
    pub fn whole(&mut self, expected: &'static str) -> Result<Option<u32>, FieldFault> {
        match self.next() {
            None | Some(b"") => Ok(None),
            Some(field) => number(field, expected).map(Some).map_err(|problem| (Some(self.number), problem)),
        }
    }

    /// Reads a float; `None` for an empty or missing field.
    pub fn real(&mut self) -> Result<Option<f64>, FieldFault> {
        match self.next() {
            None | Some(b"") => Ok(None),
            Some(field) => float(field).map(Some).map_err(|problem| (Some(self.number), problem)),
        }
    }
}

/// Converts a field to a whole number of 32 bits. If it is none, the error says what was `expected`.
pub fn number(field: &[u8], expected: &'static str) -> Result<u32, Problem> {
    whole(field)
        .and_then(|value| u32::try_from(value).ok())
        .ok_or_else(|| parameters::unknown(field).unwrap_or(Problem::Expected { expected, found: quote(field) }))
}

/// Converts a field to a float. An underflow gives zero, as in the solvers.
pub fn float(field: &[u8]) -> Result<f64, Problem> {
    match real(field) {
        Err(NumberFault::Underflow) => Ok(0.0),
        other => other.map_err(|fault| {
            parameters::unknown(field).unwrap_or_else(|| Problem::Number { found: quote(field), fault })
        }),
    }
}

/// Converts a number to a component of a node, which must fit into 8 bits; `field` is for the error.
pub fn component(value: u32, field: usize) -> Result<u8, FieldFault> {
    u8::try_from(value).map_err(|_| {
        let found = quote(value.to_string().as_bytes());
        (Some(field), Problem::Expected { expected: "a degree of freedom", found })
    })
}
