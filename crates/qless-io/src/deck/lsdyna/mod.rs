//! LS-DYNA keyword decks, `.k`, `.key`, `.dyn`. They are read, but not written.
//!
//! Components 1 to 3 are translations and 4 to 6 rotations, both in global directions. All cards hold at all times, in one load case.
//!
//! ```
//! # let place = tempfile::tempdir()?;
//! let path = place.path().join("link.k");
//! let nodes = "*KEYWORD\n*NODE\n1,0.,0.,0.\n2,1.,0.,0.\n";
//! std::fs::write(&path, format!("{nodes}*CONSTRAINED_LINEAR_GLOBAL\n4\n1,1,1.\n2,1,-1.\n*BOUNDARY_SPC_NODE\n2,0,1\n"))?;
//! let deck = qless_io::deck::read(&path)?;
//! assert_eq!(deck.model().label(0).as_deref(), Some("line 6 *CONSTRAINED_LINEAR_GLOBAL 4 1:1"));
//! assert_eq!(deck.model().cases()[0].prescribed.len(), 1);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! | folder | holds, lowest layer first |
//! | --- | --- |
//! | `syntax` | cards and parameters |
//! | `model` | nodes, elements, parts and sets; rigid bodies |
//! | `cards` | equations and prescribed values of each card that constrains |
//! | `reader` | reads the cards in order |

mod syntax {
    pub mod card;
}

mod model {
    pub mod bodies;
    pub mod mesh;
}

mod cards;
mod reader;

use std::collections::HashMap;

pub(super) use reader::read;

use crate::deck::Deck;
use model::mesh::{DynaMesh, SetKind};

/// Reads the definitions of a deck again. There are none if this fails.
fn mesh(deck: &Deck) -> DynaMesh {
    deck.again(reader::mesh).unwrap_or_default()
}

/// Positions of the nodes of a deck.
pub(super) fn positions(deck: &Deck) -> HashMap<u32, [f64; 3]> {
    mesh(deck).nodes.into_iter().collect()
}

/// The nodes of the set with this number, if it exists.
pub(super) fn node_set(deck: &Deck, name: &str) -> Option<Vec<u32>> {
    mesh(deck).sets.remove(&(SetKind::Node, name.parse().ok()?))?.ok()
}

/// Numbers of the node sets.
pub(super) fn node_set_names(deck: &Deck) -> Vec<String> {
    let sets = mesh(deck).sets.into_iter().filter(|((kind, _), members)| *kind == SetKind::Node && members.is_ok());
    sets.map(|((_, id), _)| id.to_string()).collect()
}
