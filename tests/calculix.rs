//! CalculiX decks: the diagnosis of each, and runs of the cleaned decks with the real `ccx`.
//!
//! Decks with known behaviour are in the folder that `QLESS_CORPUS` names. These tests need `ccx`.

#[path = "support/corpus.rs"]
mod known;

mod calculix {
    pub mod behaviour;
    pub mod bodies;
    pub mod claims;
    pub mod cleaning;
    pub mod cube;
    pub mod cyclic;
    pub mod expanded;
    pub mod expanded_rotations;
    pub mod free_rotations;
    pub mod geometric;
    pub mod loss;
    pub mod mean_rotations;
    pub mod mutations;
    pub mod periodic;
    pub mod plain;
    pub mod pre_tension;
    pub mod scene;
    pub mod solver;
}
