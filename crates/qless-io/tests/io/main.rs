//! Reading and writing files.

/// A failed write changes nothing.
mod atomic_writes;
/// Real and extreme systems, if they are installed.
mod corpus;
/// Decks that ask for more than they hold.
mod hostile;
/// Every kind of malformed input and its message.
mod malformed;
/// Named relations.
mod relations;
/// Files read back bit for bit.
mod round_trip;
/// Accepted spellings.
mod spellings;
