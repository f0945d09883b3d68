//! A card of bulk data: its name and the data fields of its line and of the lines that continue it.

use super::fields::{Fields, split};
use super::number::real;
use crate::deck::kinematics::components::Components;
use crate::deck::nastran::fault::CardFault;
use crate::deck::{CardName, Problem};
use crate::fault::quote;
use crate::number::whole;

/// Data fields of a line; fields of continuations count on from multiples of it.
pub const PER_LINE: usize = 8;

/// A card. It is filled anew for each one, so that a deck of a million cards allocates no more than one of ten.
#[derive(Debug, Default)]
pub struct Card {
    /// The name in capitals.
    pub name: &'static str,
    /// File and first line.
    pub file: u32,
    pub line: u32,
    text: Vec<u8>,
    /// Where each data field ends in `text`.
    ends: Vec<u32>,
    /// Line number and first data field of each line.
    lines: Vec<(u32, u32)>,
    /// How the last line names its continuation.
    mark: Vec<u8>,
}

/// Where and why a card was refused.
#[derive(Debug)]
pub struct Refused {
    pub line: u32,
    pub field: Option<usize>,
    pub problem: Problem,
}

impl Card {
    /// Starts anew at a line that has been cleaned of its comment.
    pub fn begin(&mut self, name: &'static str, line: &[u8], file: u32, number: u32) -> Result<(), Refused> {
        self.clear();
        (self.name, self.file, self.line) = (name, file, number);
        let fields = split(line).map_err(|problem| refused(number, problem))?;
        self.take(&fields, number);
        Ok(())
    }

    /// Goes on with a continuation line.
    pub fn extend(&mut self, line: &[u8], file: u32, number: u32) -> Result<(), Refused> {
        if file != self.file {
            let expected = "the card's continuation in the same file";
            return Err(refused(self.line, Problem::Expected { expected, found: "that of another".into() }));
        }
        let fields = split(line).map_err(|problem| refused(number, problem))?;
        if let Some(fault) = self.belongs_elsewhere(&fields) {
            return Err(refused(number, fault.into()));
        }
        self.take(&fields, number);
        Ok(())
    }

    pub fn clear(&mut self) {
        self.text.clear();
        self.ends.clear();
        self.lines.clear();
        self.mark.clear();
    }

    fn take(&mut self, fields: &Fields, number: u32) {
        // Half a line in large field before one in small field counts as a whole one.
        if fields.data().len() == PER_LINE {
            while !self.ends.len().is_multiple_of(PER_LINE) {
                self.ends.push(self.text.len() as u32);
            }
        }
        self.lines.push((number, self.ends.len() as u32));
        for field in fields.data() {
            self.text.extend_from_slice(field);
            self.ends.push(self.text.len() as u32);
        }
        self.mark.clear();
        self.mark.extend_from_slice(fields.mark);
    }

    fn belongs_elsewhere(&self, fields: &Fields) -> Option<CardFault> {
        let expected = self.mark.strip_prefix(b"+").or(self.mark.strip_prefix(b"*"))?.trim_ascii();
        let differs = !expected.is_empty() && !fields.name.is_empty() && !expected.eq_ignore_ascii_case(fields.name);
        differs.then(|| CardFault::Continuation { expected: quote(expected).into(), found: quote(fields.name).into() })
    }

    /// Data field `i` from 0; blank beyond the last.
    pub fn field(&self, i: usize) -> &[u8] {
        let Some(&end) = self.ends.get(i) else { return b"" };
        let start = if i == 0 { 0 } else { self.ends[i - 1] };
        &self.text[start as usize..end as usize]
    }

    pub fn is_blank(&self, i: usize) -> bool {
        self.field(i).is_empty()
    }

    /// Number of data fields up to the last that is filled.
    pub fn len(&self) -> usize {
        (0..self.ends.len()).rev().find(|&i| !self.is_blank(i)).map_or(0, |i| i + 1)
    }

    /// Number of lines from the first to the last.
    pub fn span(&self) -> u32 {
        self.lines.last().map_or(1, |&(last, _)| (last + 1).saturating_sub(self.line).max(1))
    }

    /// The card's name with its number, as `RBE2 12`.
    pub fn title(&self) -> CardName {
        match whole(self.field(0)).map(|id| (id, u32::try_from(id))) {
            Some((_, Ok(id))) => CardName::numbered(self.name, id),
            Some((id, _)) => format!("{} {id}", self.name).into(),
            None => self.name.into(),
        }
    }

    /// A whole number from 1.
    pub fn id(&self, i: usize, what: &'static str) -> Result<u32, Refused> {
        self.optional_id(i, what)?.ok_or_else(|| self.expected(i, what))
    }

    /// A whole number from 0; none where the field is blank.
    pub fn optional_whole(&self, i: usize, what: &'static str) -> Result<Option<u32>, Refused> {
        let word = self.field(i);
        if word.is_empty() {
            return Ok(None);
        }
        let number = whole(word).and_then(|value| u32::try_from(value).ok());
        number.map(Some).ok_or_else(|| self.expected(i, what))
    }

    pub fn optional_id(&self, i: usize, what: &'static str) -> Result<Option<u32>, Refused> {
        match self.optional_whole(i, what)? {
            Some(0) => Err(self.expected(i, what)),
            other => Ok(other),
        }
    }

    /// A real number; none where the field is blank.
    pub fn real(&self, i: usize) -> Result<Option<f64>, Refused> {
        let word = self.field(i);
        if word.is_empty() {
            return Ok(None);
        }
        let number = |fault| self.at(i, Problem::Number { found: quote(word), fault });
        match real(word) {
            // Too small to be told from zero is zero, as in the solver.
            Err(crate::NumberFault::Underflow) => Ok(Some(0.0)),
            other => other.map(Some).map_err(number),
        }
    }

    /// Component numbers; the empty set where the field is blank or 0.
    pub fn components(&self, i: usize) -> Result<Components, Refused> {
        const EXPECTED: &str = "component numbers: digits from 1 to 6 without blanks";
        Components::parse(self.field(i)).ok_or_else(|| self.expected(i, EXPECTED))
    }

    /// Component numbers, at least one.
    pub fn some_components(&self, i: usize) -> Result<Components, Refused> {
        const EXPECTED: &str = "one or more component numbers from 1 to 6";
        Some(self.components(i)?).filter(|set| !set.is_empty()).ok_or_else(|| self.expected(i, EXPECTED))
    }

    /// Field `i` holds something else than `what`.
    pub fn expected(&self, i: usize, what: &'static str) -> Refused {
        self.at(i, Problem::Expected { expected: what, found: quote(self.field(i)) })
    }

    /// A problem of field `i`, which counts from 2 in its line as the card's name is field 1.
    pub fn at(&self, i: usize, problem: Problem) -> Refused {
        let own = self.lines.iter().rfind(|&&(_, first)| first as usize <= i);
        let (line, first) = own.copied().unwrap_or((self.line, 0));
        Refused { line, field: Some(i - first as usize + 2), problem }
    }
}

fn refused(line: u32, problem: Problem) -> Refused {
    Refused { line, field: None, problem }
}
