//! CalculiX and Abaqus decks, `.inp`.
//!
//! The deck is read twice: first for definitions (nodes, sets, surfaces, elements), then, in order, for constraints. Equations are
//! homogeneous, except those of some `*MPC` cards. The first term of an equation is its slave. Every step is a load case.
//!
//! | folder | content, lowest layer first |
//! | --- | --- |
//! | `syntax` | cards, parameters and fields; expands Abaqus parts into instances |
//! | `model` | definitions that cards refer to: nodes, sets, elements, surfaces, axes, instances |
//! | `cards` | equations and prescribed values of each card that constrains |
//! | `write` | the cleaned deck |
//!
//! `reader` reads the cards in order; `values` passes values and loads from step to step; `nodes` checks and names the nodes.

mod cards;
mod model;
mod nodes;
mod reader;
mod syntax;
mod values;
mod write;

pub(super) use reader::read;
pub(super) use write::write;

use std::collections::HashMap;

use crate::deck::{Deck, DeckError};
use model::definitions::DeckDefinitions;
use syntax::card::Scope;

/// Reads the definitions of a deck again from its text.
fn definitions(deck: &Deck) -> Result<DeckDefinitions, DeckError> {
    deck.again(|sources| DeckDefinitions::read(sources, |_| {}))
}

/// Positions of the nodes of a deck; empty if they cannot be read.
pub(super) fn positions(deck: &Deck) -> HashMap<u32, [f64; 3]> {
    let found = definitions(deck).ok().and_then(|definitions| definitions.all_positions().ok());
    found.map(|all| all.into_iter().collect()).unwrap_or_default()
}

/// Nodes of a set, if it exists.
pub(super) fn node_set(deck: &Deck, name: &str) -> Option<Vec<u32>> {
    definitions(deck).ok()?.nodes(Scope::DECK, name).ok().map(|nodes| nodes.to_vec())
}

/// Names of all node sets.
pub(super) fn node_set_names(deck: &Deck) -> Vec<String> {
    definitions(deck).map(|found| found.node_set_names().map(str::to_owned).collect()).unwrap_or_default()
}
