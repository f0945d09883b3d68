//! LS-DYNA keyword decks.

/// Helpers: models as text.
#[path = "../keyword/as_text.rs"]
mod as_text;
/// Each card that constrains, with known answers.
mod cards;
/// Helpers: decks from text.
mod from_text;
/// Decks that are wrong.
mod malformed;
/// Random decks: rigid motions, order of cards and formats.
mod properties;
