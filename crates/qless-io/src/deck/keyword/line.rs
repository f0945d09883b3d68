//! Reads the fields of a line, which are in columns of fixed width or between commas. Parameters `&name` may stand in place of numbers.
//! Widths in characters:
//!
//! | layout | standard | I10 | long |
//! | --- | --- | --- | --- |
//! | most cards | 10 | 10 | 20 |
//! | elements | 8 | 10 | 20 |
//! | `*NODE` | 8, 3 x 16, 2 x 8 | 10, 3 x 16, 2 x 10 | 20 |
//!
//! Cards of Radioss mix fields of 10 and 20 characters. So the number of a field is that of its first ten columns, and the layout `Wide` reads
//! ten more.

use rustc_hash::FxHashMap;

use crate::NumberFault;
use crate::deck::Problem;
use crate::fault::quote;
use crate::number::real;

/// How wide the fields of a card are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FieldWidth {
    #[default]
    Standard,
    /// Fields of 10 characters: `I10=Y` on `*KEYWORD`, or `%` after the keyword.
    Ten,
    /// Fields of 20 characters: `LONG=Y` or `LONG=K` on `*KEYWORD`, or `+` after the keyword.
    Long,
    /// Fields of 10 characters, which no comma separates: Radioss.
    Columns,
}

/// How the fields of a line are laid out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FieldLayout {
    Common,
    Element,
    Node,
    /// Fields of 20 characters, counted by tens.
    Wide,
}

impl FieldLayout {
    /// The first column of a field, from 0, and the width of the field.
    fn place(self, field: usize, width: FieldWidth) -> (usize, usize) {
        let narrow = if width == FieldWidth::Standard { 8 } else { 10 };
        match (self, width) {
            (Self::Wide, _) => (10 * field, 20),
            (_, FieldWidth::Long) => (20 * field, 20),
            (Self::Common, _) => (10 * field, 10),
            (Self::Element, _) => (narrow * field, narrow),
            (Self::Node, _) => match field {
                0 => (0, narrow),
                1..=3 => (narrow + 16 * (field - 1), 16),
                _ => (narrow + 48 + narrow * (field - 4), narrow),
            },
        }
    }
}

/// The texts of the parameters that `*PARAMETER` defines, by name in capitals; `None` if the value is not known.
pub type Parameters = FxHashMap<Vec<u8>, Option<Vec<u8>>>;

/// A fault in a line: the number of the line, the field (from 1) if one is at fault, and the problem.
#[derive(Debug)]
pub struct KeywordFault {
    pub line: u32,
    pub field: Option<usize>,
    pub problem: Problem,
}

/// A data line. Its fields are counted from 0.
#[derive(Clone, Copy)]
pub struct KeywordLine<'a> {
    pub number: u32,
    pub text: &'a [u8],
    pub width: FieldWidth,
    pub layout: FieldLayout,
    pub parameters: &'a Parameters,
}

impl<'a> KeywordLine<'a> {
    pub fn is_blank(&self) -> bool {
        self.text.trim_ascii().is_empty()
    }

    /// The same line, with its fields read in another layout.
    pub fn laid_out(self, layout: FieldLayout) -> Self {
        Self { layout, ..self }
    }

    /// The text of a field, trimmed. It is empty if the line ends before the field.
    pub fn field(&self, field: usize) -> &'a [u8] {
        if self.width != FieldWidth::Columns && memchr::memchr(b',', self.text).is_some() {
            return self.text.split(|&byte| byte == b',').nth(field).unwrap_or_default().trim_ascii();
        }
        let (start, width) = self.layout.place(field, self.width);
        let rest = self.text.get(start..).unwrap_or_default();
        rest[..rest.len().min(width)].trim_ascii()
    }

    /// The text of the first field, and all of the line after it. A comma ends the first field only if no blank or parenthesis is before it.
    /// If the columns of the first field are blank, so is the field.
    pub fn split_first(&self) -> (&'a [u8], &'a [u8]) {
        let width = self.layout.place(1, self.width).0;
        if self.text.get(..width).is_some_and(|first| first.trim_ascii().is_empty()) {
            return (b"", self.text.trim_ascii());
        }
        let ends_name = |comma: &usize| {
            let name = self.text[..*comma].trim_ascii().get(1..).unwrap_or_default().trim_ascii();
            !name.iter().any(|byte| byte.is_ascii_whitespace() || *byte == b'(')
        };
        let (first, rest) = match memchr::memchr(b',', self.text).filter(ends_name) {
            Some(comma) => (&self.text[..comma], &self.text[comma + 1..]),
            None => self.text.split_at(width.min(self.text.len())),
        };
        (first.trim_ascii(), rest.trim_ascii())
    }

    /// The number of fields up to the last one that is not empty; at most `most` fields are examined.
    pub fn count(&self, most: usize) -> usize {
        (0..most).rev().find(|&field| !self.field(field).is_empty()).map_or(0, |last| last + 1)
    }

    /// The number in a field; `None` if the field is blank.
    pub fn number(&self, field: usize) -> Result<Option<f64>, KeywordFault> {
        let text = self.field(field);
        let (sign, name) = match text {
            [b'&', name @ ..] => (1.0, name),
            [b'-', b'&', name @ ..] => (-1.0, name),
            _ => return self.parse(field, text),
        };
        let shown = String::from_utf8_lossy(name);
        match self.parameters.get(name.trim_ascii().to_ascii_uppercase().as_slice()) {
            Some(Some(value)) => Ok(self.parse(field, value)?.map(|value| sign * value)),
            Some(None) => {
                let what = format!("the value of the parameter {shown}");
                Err(self.fault_at(field, Problem::NotFollowed { what }))
            }
            None => Err(self.fault_at(field, Problem::Undefined { what: "parameter", name: shown.into_owned() })),
        }
    }

    fn parse(&self, field: usize, text: &[u8]) -> Result<Option<f64>, KeywordFault> {
        match real(text) {
            _ if text.is_empty() => Ok(None),
            // An underflow gives zero, as in the solver.
            Err(NumberFault::Underflow) => Ok(Some(0.0)),
            Ok(value) => Ok(Some(value)),
            Err(fault) => Err(self.fault_at(field, Problem::Number { found: quote(text), fault })),
        }
    }

    /// The whole number in a field; 0 if the field is blank. `1.0` counts as whole, because flags may be written so.
    pub fn whole(&self, field: usize) -> Result<i64, KeywordFault> {
        let value = self.number(field)?.unwrap_or(0.0);
        if value.fract() == 0.0 && value.abs() <= f64::from(u32::MAX) {
            return Ok(value as i64);
        }
        Err(self.expected(field, "a whole number of at most 32 bits"))
    }

    /// The number of a node, a set and the like in a field; 0 if the field is blank.
    pub fn id(&self, field: usize) -> Result<u32, KeywordFault> {
        u32::try_from(self.whole(field)?).map_err(|_| self.expected(field, "a number from 0 to 4294967295"))
    }

    /// Three coordinates, in the fields from `first` on. Blank fields are 0.
    pub fn vector(&self, first: usize) -> Result<[f64; 3], KeywordFault> {
        let mut vector = [0.0; 3];
        for (k, x) in vector.iter_mut().enumerate() {
            *x = self.number(first + k)?.unwrap_or(0.0);
        }
        Ok(vector)
    }

    /// The numbers in `most` fields from `first` on, without blank fields and zeros.
    pub fn ids(&self, first: usize, most: usize) -> Result<Vec<u32>, KeywordFault> {
        let ids: Result<Vec<u32>, KeywordFault> = (first..first + most).map(|field| self.id(field)).collect();
        Ok(ids?.into_iter().filter(|&id| id != 0).collect())
    }

    /// The fault that a field does not hold `expected`.
    pub fn expected(&self, field: usize, expected: &'static str) -> KeywordFault {
        self.fault_at(field, Problem::Expected { expected, found: quote(self.field(field)) })
    }

    pub fn fault_at(&self, field: usize, problem: Problem) -> KeywordFault {
        KeywordFault { line: self.number, field: Some(field + 1), problem }
    }

    pub fn fault(&self, problem: Problem) -> KeywordFault {
        KeywordFault { line: self.number, field: None, problem }
    }
}
