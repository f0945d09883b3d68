//! CalculiX and Abaqus decks, `.inp`.
//!
//! The deck is gone through twice: first for what it defines (nodes, sets, surfaces, elements), then, in order, for what
//! constrains. Equations are homogeneous and their first term is the slave; every step is a load case.
//!
//! | folder | holds |
//! | --- | --- |
//! | `syntax` | lines as cards, parameters and fields |
//! | `model` | what cards refer to: nodes, sets, surfaces, parts and instances |
//! | `cards` | what each card that constrains says |
//! | `write` | the deck with other equations |
//!
//! `reader` goes through the cards and keeps what each step inherits.

mod cards;
mod model;
mod reader;
mod syntax;
mod write;

pub(super) use reader::read;
pub(super) use write::{node_set, node_set_names, positions, write};
