//! ANSYS archives.

/// Decks written back.
mod clean;
/// Every kind of malformed command and its message.
mod malformed;
/// What the commands mean.
mod meaning;
/// Shared by all.
mod parse;
/// Random decks.
mod property;
