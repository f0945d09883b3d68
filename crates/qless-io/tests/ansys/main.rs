//! ANSYS archives.

/// Decks written back.
mod clean;
/// Files that the deck writes and reads again.
mod files;
/// Generated coupled sets.
mod generated;
/// Every kind of malformed command and its message.
mod malformed;
/// What the commands mean.
mod meaning;
/// Several models in a deck.
mod models;
/// Shared by all.
mod parse;
/// Parameters, loops and conditions.
mod programs;
/// Random decks.
mod property;
/// `CERIG` and `RBE3`.
mod regions;
/// Load steps with equations and tables of their own.
mod steps;
