//! Errors in decks: file, line, card, field, what was found and what to do.

use std::path::PathBuf;

use crate::NumberFault;

/// An error in a deck. Lines and fields count from 1.
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
    /// The field of the line, if a single one is wrong.
    pub field: Option<usize>,
    /// What is wrong, and what to do.
    pub problem: Problem,
}

/// A fault in a deck.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Problem {
    /// Another value was expected.
    #[error("expected {expected}, found {found}; correct it")]
    Expected {
        /// What the format requires.
        expected: &'static str,
        /// The text found, quoted.
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
    /// A card ends too early.
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
    /// A definition that refers to itself.
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
    /// Degenerate geometry, such as a plane through three nodes on a line.
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
    /// An included file that is too large or never ends.
    #[error("the included file {reason}")]
    IncludeTooLarge {
        /// The name in the deck, how much was read, and the limit.
        reason: String,
    },
    /// A limit of this reader.
    #[error("{what} exceeds the limit of {limit}; {advice}")]
    Limit {
        /// What is too large.
        what: &'static str,
        /// The limit.
        limit: usize,
        /// What to do.
        advice: &'static str,
    },
    /// A fault that only some cards can have.
    #[error(transparent)]
    Card(#[from] super::card_fault::CardFault),
}
