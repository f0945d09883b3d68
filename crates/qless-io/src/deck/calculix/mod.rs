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
pub(super) use write::write;

use std::collections::HashMap;

use crate::deck::{Deck, DeckError};
use model::definitions::DeckDefinitions;
use syntax::card::{KeywordCard, Scope};
use syntax::walk::walk;

/// What a deck that was read before defines.
fn definitions(deck: &Deck) -> Result<DeckDefinitions, DeckError> {
    let mut definitions = DeckDefinitions::default();
    let mut note = |card: &KeywordCard| {
        definitions.note(card);
        Ok(())
    };
    deck.again(|sources| walk(sources, &mut note))?;
    Ok(definitions)
}

/// Where the nodes of a deck are; none where its nodes cannot be read.
pub(super) fn positions(deck: &Deck) -> HashMap<u32, [f64; 3]> {
    let found = definitions(deck).ok().and_then(|definitions| definitions.all_positions().ok());
    found.map(|all| all.into_iter().collect()).unwrap_or_default()
}

/// The nodes of a set, if there is such a set.
pub(super) fn node_set(deck: &Deck, name: &str) -> Option<Vec<u32>> {
    definitions(deck).ok()?.nodes(Scope::DECK, name).ok().map(|nodes| nodes.to_vec())
}

/// The names of all node sets.
pub(super) fn node_set_names(deck: &Deck) -> Vec<String> {
    definitions(deck).map(|found| found.node_set_names().map(str::to_owned).collect()).unwrap_or_default()
}
