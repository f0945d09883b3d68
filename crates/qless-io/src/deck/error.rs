//! Why a deck was refused: file, line, card, field, what was found and what to do.

use std::path::PathBuf;

use crate::NumberFault;

/// A fault in a deck. Lines and fields count from 1.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error(
    "{}{}: {card}{}: {problem}",
    path.display(),
    if *line == 0 { String::new() } else { format!(":{line}") },
    field.map(|field| format!(", field {field}")).unwrap_or_default()
)]
#[non_exhaustive]
pub struct DeckError {
    /// The file that holds the line.
    pub path: PathBuf,
    /// The line; 0 if the whole file is at fault.
    pub line: usize,
    /// The card that the line belongs to, such as `*EQUATION` or `RBE2 12`.
    pub card: String,
    /// The field of the line, where one is at fault.
    pub field: Option<usize>,
    /// What is wrong, and what to do.
    pub problem: Problem,
}

/// What can be wrong in a deck.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Problem {
    /// Something else was expected.
    #[error("expected {expected}, found {found}; correct it")]
    Expected {
        /// What the format asks for here.
        expected: &'static str,
        /// What stands there, quoted.
        found: String,
    },
    /// A number that cannot be used.
    #[error("{found} is no usable number: {fault}")]
    Number {
        /// The text found, quoted.
        found: String,
        /// What is wrong with it.
        fault: NumberFault,
    },
    /// A card ends before all that it promises is there.
    #[error("{promised} {what} are promised, but the card ends after {found}; complete it or correct the number")]
    TooFew {
        /// What is counted.
        what: &'static str,
        /// How many the card promises.
        promised: usize,
        /// How many there are.
        found: usize,
    },
    /// Something that the deck names but does not define.
    #[error("{what} {name} is not defined; define it or correct the name")]
    Undefined {
        /// "node", "set", "surface", "coordinate system" and the like.
        what: &'static str,
        /// Its name or number.
        name: String,
    },
    /// Something that is defined by itself.
    #[error("{what} {name} is defined by itself; break the circle")]
    Circular {
        /// "set", "coordinate system" and the like.
        what: &'static str,
        /// Its name or number.
        name: String,
    },
    /// A parameter that the card needs is missing.
    #[error("the parameter {name} is missing; add `{name}=...`")]
    NoParameter {
        /// The parameter.
        name: &'static str,
    },
    /// Geometry that defines nothing, such as a plane through three nodes on a line.
    #[error("{what}; correct the coordinates or the nodes")]
    Degenerate {
        /// What is degenerate.
        what: String,
    },
    /// An included file that cannot be read.
    #[error("the included file {file} cannot be read: {reason}; correct the name or put the file there")]
    Include {
        /// The name in the deck.
        file: String,
        /// The system's reason.
        reason: String,
    },
    /// An included file that is too large, or never ends.
    #[error("the included file {reason}")]
    IncludeTooLarge {
        /// The name in the deck, how much was read, and the limit.
        reason: String,
    },
    /// More than this reader takes.
    #[error("{what} exceeds the limit of {limit}; {advice}")]
    Limit {
        /// What is too large.
        what: &'static str,
        /// The most that is taken.
        limit: usize,
        /// What to do.
        advice: &'static str,
    },
    /// A fault that only some cards can have.
    #[error(transparent)]
    Card(#[from] super::card_fault::CardFault),
}
