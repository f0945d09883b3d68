//! LS-DYNA keyword decks.

/// Each card that constrains, with known answers.
mod cards;
/// Helpers: decks from text, and models as text.
mod from_text;
/// Decks that are wrong.
mod malformed;
/// Random decks: rigid motions, order of cards and formats.
mod properties;
