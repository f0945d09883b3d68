//! Files in, files out.

/// Folders of real and extreme systems, where they are at hand.
mod corpus;
/// Every kind of malformed input and its message.
mod malformed;
/// A failed write changes nothing.
mod nothing_left;
/// What is written reads back bit for bit.
mod round_trip;
/// Spellings that are accepted.
mod spellings;
