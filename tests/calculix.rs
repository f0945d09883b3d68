//! CalculiX decks: the diagnosis of each, and what the real `ccx` makes of the cleaned ones.
//!
//! Decks with known behaviour are those of the folder that `QLESS_CORPUS` names; then `ccx` must be installed.

#[path = "support/corpus.rs"]
mod known;

mod calculix {
    pub mod behaviour;
    pub mod bodies;
    pub mod claims;
    pub mod cleaning;
    pub mod cube;
    pub mod geometric;
    pub mod mutations;
    pub mod periodic;
    pub mod plain;
    pub mod scene;
    pub mod solver;
}
