//! Nastran decks in, constraints out.

/// Real decks with known constraints, where they are at hand.
mod corpus;
