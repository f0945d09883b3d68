//! Fields of a line of data as numbers, and what is wrong with those that are none.

use crate::NumberFault;
use crate::deck::Problem;
use crate::deck::calculix::syntax::data::DataLine;
use crate::fault::quote;
use crate::number::{real, whole};

/// A field at fault: its number from 1, and what is wrong.
pub type Fault = (Option<usize>, Problem);

/// The fields of a line, taken one by one.
pub struct Fields<'a> {
    rest: Box<dyn Iterator<Item = &'a [u8]> + 'a>,
    /// Number of the field taken last, from 1.
    pub number: usize,
}

impl<'a> Fields<'a> {
    pub fn of(line: &DataLine<'a>) -> Self {
        Self { rest: Box::new(line.fields()), number: 0 }
    }

    /// The next field, empty ones included.
    pub fn next(&mut self) -> Option<&'a [u8]> {
        self.number += 1;
        self.rest.next()
    }

    /// A number of a node, a DOF or the like; `None` for an empty or missing field.
    pub fn whole(&mut self, expected: &'static str) -> Result<Option<u32>, Fault> {
        match self.next() {
            None | Some(b"") => Ok(None),
            Some(field) => number(field, expected).map(Some).map_err(|problem| (Some(self.number), problem)),
        }
    }

    /// A float; `None` for an empty or missing field.
    pub fn real(&mut self) -> Result<Option<f64>, Fault> {
        match self.next() {
            None | Some(b"") => Ok(None),
            Some(field) => float(field).map(Some).map_err(|problem| (Some(self.number), problem)),
        }
    }
}

/// A whole number that fits 32 bits.
pub fn number(field: &[u8], expected: &'static str) -> Result<u32, Problem> {
    whole(field)
        .and_then(|value| u32::try_from(value).ok())
        .ok_or_else(|| Problem::Expected { expected, found: quote(field) })
}

/// A float; one that is too small to be told from zero is zero, as in the solvers.
pub fn float(field: &[u8]) -> Result<f64, Problem> {
    match real(field) {
        Err(NumberFault::Underflow) => Ok(0.0),
        other => other.map_err(|fault| Problem::Number { found: quote(field), fault }),
    }
}

/// A component of a node.
pub fn component(value: u32, field: usize) -> Result<u8, Fault> {
    u8::try_from(value).map_err(|_| {
        let found = quote(value.to_string().as_bytes());
        (Some(field), Problem::Expected { expected: "a degree of freedom", found })
    })
}
