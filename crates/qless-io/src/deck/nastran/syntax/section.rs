//! The part of a deck in which its first line lies.

use super::lines::{Include, Line, Visitor, walk};
use super::word::keyword;
use crate::deck::{DeckError, Problem, Sources};

/// Which part of the deck a line is in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Section {
    /// Up to `CEND`.
    Executive,
    /// Up to `BEGIN BULK`.
    Control,
    Bulk,
    /// Bulk data of a part that this reader does not follow.
    Passed,
}

/// A deck with neither `CEND` nor `BEGIN BULK`, in the main file or an included one, is bulk data from its first line.
pub fn first(sources: &mut Sources) -> Result<Section, DeckError> {
    let mut landmark = Landmark(Section::Bulk);
    walk(sources, &mut landmark)?;
    Ok(landmark.0)
}

/// The section that the first landmark ends.
struct Landmark(Section);

impl Visitor for Landmark {
    fn quick(&mut self, line: &Line, _: &Sources) -> Result<bool, DeckError> {
        // Most lines are grid points and equations.
        Ok(matches!(line.text.first(), Some(b'G' | b'M')))
    }

    fn line(&mut self, line: &Line, _: &Sources) -> Result<bool, DeckError> {
        match keyword(line.text).0.as_str() {
            "CEND" => self.0 = Section::Executive,
            "BEGIN" => self.0 = Section::Control,
            "ENDDATA" => {}
            _ => return Ok(true),
        }
        Ok(false)
    }

    fn included(&mut self, _: Include) {}

    /// Whether it is needed is known when its section is.
    fn unreadable(&mut self, error: DeckError) -> Result<(), DeckError> {
        if matches!(error.problem, Problem::Include { .. }) { Ok(()) } else { Err(error) }
    }
}
