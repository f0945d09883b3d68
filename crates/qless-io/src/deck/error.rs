//! An error in a deck names the file, the line, the card and the field, what was found and what to do.

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

/// What is wrong in a deck.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Problem {
    /// The text is not what the format requires.
    #[error("expected {expected}, found {found}; correct it")]
    Expected {
        /// What the format requires.
        expected: &'static str,
        /// The text found, quoted.
        found: String,
    },
    /// The text is no usable number.
    #[error("{found} is no usable number: {fault}")]
    Number {
        /// The text found, quoted.
        found: String,
        /// What is wrong with the number.
        fault: NumberFault,
    },
    /// A card has fewer items than it announces or needs.
    #[error("{promised} {what} are promised, but the card ends after {found}; complete it or correct the number")]
    TooFew {
        /// The kind of the items, for example "nodes".
        what: &'static str,
        /// The number of items that the card announces or needs.
        promised: usize,
        /// The number of items that the card has.
        found: usize,
    },
    /// The deck names something that it does not define.
    #[error("{what} {name} is not defined; define it or correct the name")]
    Undefined {
        /// The kind of the undefined thing: "node", "set", "surface", "coordinate system" and the like.
        what: &'static str,
        /// The name or number of the undefined thing.
        name: String,
    },
    /// A definition refers to itself.
    #[error("{what} {name} is defined by itself; break the circle")]
    Circular {
        /// The kind of the definition: "set", "coordinate system" and the like.
        what: &'static str,
        /// The name or number of the definition.
        name: String,
    },
    /// A parameter that the card needs is missing.
    #[error("the parameter {name} is missing; add `{name}=...`")]
    NoParameter {
        /// The name of the parameter.
        name: &'static str,
    },
    /// The card needs something that this reader does not know how to follow; a reader leaves the card out.
    #[error("it needs {what}, which this reader does not follow")]
    NotFollowed {
        /// What the card needs, such as "spherical axes".
        what: String,
    },
    /// The geometry is degenerate, for example if a plane passes through three nodes on a line.
    #[error("{what}; correct the coordinates or the nodes")]
    Degenerate {
        /// A description of what is degenerate.
        what: String,
    },
    /// An included file cannot be read.
    #[error("the included file {file} cannot be read: {reason}; correct the name or put the file there")]
    Include {
        /// The name of the included file, as the deck gives it.
        file: String,
        /// The reason that the operating system gives.
        reason: String,
    },
    /// An included file is too large or never ends.
    #[error("the included file {reason}")]
    IncludeTooLarge {
        /// A text with the name of the included file (as the deck gives it), the number of bytes read, and the limit.
        reason: String,
    },
    /// The deck exceeds a limit of this reader.
    #[error("{what} exceeds the limit of {limit}; {advice}")]
    Limit {
        /// The quantity that is too large.
        what: &'static str,
        /// The value of the limit.
        limit: usize,
        /// What the user can do.
        advice: &'static str,
    },
    /// A fault that only some cards can have.
    #[error(transparent)]
    Card(#[from] super::card_fault::CardFault),
}
