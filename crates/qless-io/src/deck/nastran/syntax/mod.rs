//! From bytes to cards: lines and includes, fields, numbers, the parts of a deck.

pub mod card;
pub mod content;
pub mod continuations;
pub mod copies;
pub mod eight;
pub mod fields;
pub mod lines;
pub mod number;
pub mod place;
pub mod reader;
pub mod section;
pub mod word;
