//! CalculiX decks: the diagnosis of each, and what the real `ccx` makes of the cleaned ones.
//!
//! Decks with known behaviour are run where `QLESS_CORPUS` names the folder that holds `decks/`; then `ccx` must be installed.

mod calculix {
    pub mod behaviour;
    pub mod cleaning;
    pub mod cube;
    pub mod geometric;
    pub mod periodic;
    pub mod plain;
    pub mod solver;
}
