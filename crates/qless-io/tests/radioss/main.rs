//! Radioss starter decks.

/// Helpers: models as text.
#[path = "../keyword/as_text.rs"]
mod as_text;
/// Each card that constrains, with known answers.
mod cards;
/// Helpers: decks from text.
mod from_text;
/// Groups, surfaces, included files and versions.
mod groups;
/// Decks that are wrong.
mod malformed;
/// Random decks: rigid motions, ranks, order of cards and line ends.
mod properties;
