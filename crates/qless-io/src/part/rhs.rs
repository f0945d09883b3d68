//! Parts of a file of right-hand sides.

use super::{Count, File, Lines, head};
use crate::vectors::rhs;
use crate::{ReadError, lines};

/// What stands before the numbers.
#[derive(Debug)]
pub struct RightHandSide {
    head: rhs::Head,
    before: Count,
    start: u64,
}

impl RightHandSide {
    /// Reads header and sizes, if there are any; `rows` numbers are wanted.
    ///
    /// # Errors
    /// [`ReadError::Io`], or [`ReadError::Malformed`] with the line.
    pub fn of(file: &File, rows: usize) -> Result<Self, ReadError> {
        let Some(head) = head::read(file, false)? else {
            return Ok(Self { head: rhs::headless(rows), before: Count::default(), start: 0 });
        };
        let mut lines = lines::Lines::new(&head.text);
        let read = rhs::headed(&mut lines, rows).map_err(|at| at.of(file.path()))?;
        Ok(Self { head: read, before: Count { lines: lines.number(), items: 0 }, start: head.end })
    }

    /// Where the numbers begin, in bytes.
    pub fn start(&self) -> u64 {
        self.start
    }

    /// Lines before the numbers.
    pub fn before(&self) -> Count {
        self.before
    }

    /// The numbers in these lines, before which so many stand: the first is that of row `before.items`, counted from 0.
    ///
    /// # Errors
    /// [`ReadError::Malformed`] with the line.
    pub fn numbers(&self, lines: &Lines, before: Count) -> Result<Vec<f64>, ReadError> {
        rhs::numbers(&mut lines.after(before.lines), &self.head, before.items).map_err(|at| at.of(lines.path()))
    }

    /// Whether there is one number for each row, if so many were found.
    ///
    /// # Errors
    /// [`ReadError::Malformed`] if not.
    pub fn check(&self, file: &File, found: usize) -> Result<(), ReadError> {
        self.head.complete(found).map_err(|at| at.of(file.path()))
    }
}
