//! What a deck says, by its parts, before it is a model.

use super::lines::Include;
use crate::deck::nastran::cards::bulk::Bulk;
use crate::deck::nastran::control::subcases::Control;

/// A file and a line of it, from 1.
pub type At = (u32, u32);

/// Where the parts of a deck begin, for those who change it.
#[derive(Debug, Default)]
pub struct Landmarks {
    /// The first line of case control.
    pub control: Option<At>,
    /// The line after `BEGIN BULK`.
    pub bulk: Option<At>,
    /// `ENDDATA`.
    pub end: Option<At>,
    pub includes: Vec<Include>,
}

/// What a deck says.
#[derive(Debug)]
pub struct Content {
    pub landmarks: Landmarks,
    pub bulk: Bulk,
    /// None where the deck is bulk data alone.
    pub control: Option<Control>,
}
