//! Nastran decks in, constraints out.

/// Cleaned decks: independent, equivalent, and left alone the second time.
mod clean;
/// Continuations by name, copies, longer lines.
mod continuations;
/// Real decks with known constraints, where they are at hand.
mod corpus;
/// Decks from text, and what was read as text.
mod given;
/// Every kind of fault and its message.
mod malformed;
/// What MYSTRAN reads otherwise.
mod mystran;
/// Sets, subcases, supports, loads.
mod selection;
/// Spellings that are accepted.
mod spellings;
/// Subcases and sets that exclude each other.
mod subcases;
/// Cards of unknown names.
mod unknown;
