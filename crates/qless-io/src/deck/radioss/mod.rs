//! Radioss starter decks, `*_0000.rad`, of format version 5.1 and later. They are read, but not written.
//!
//! Components 1 to 3 are translations and 4 to 6 rotations, both in global directions. All cards hold at all times, in one load case.
//!
//! ```
//! # let place = tempfile::tempdir()?;
//! let path = place.path().join("link_0000.rad");
//! let column = |word: &str| format!("{word:>10}");
//! let node = |id: &str, x: &str| format!("{id:>10}{x:>20}{:>20}{:>20}\n", "0.", "0.");
//! let nodes = format!("#RADIOSS STARTER\n/NODE\n{}{}", node("1", "0."), node("2", "1."));
//! let term = |id: &str, alpha: &str| format!("{}{}{}{alpha:>20}\n", column(id), column("1"), column("0"));
//! let mpc = format!("/MPC/4\nequal\n{}{}", term("1", "1."), term("2", "-1."));
//! std::fs::write(&path, format!("{nodes}{mpc}/END\n"))?;
//! let deck = qless_io::deck::read(&path)?;
//! assert_eq!(deck.model().label(0).as_deref(), Some("line 7 /MPC/4 1:1"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! | folder | holds, lowest layer first |
//! | --- | --- |
//! | `syntax` | cards of the deck and of its included files |
//! | `model` | nodes, groups, surfaces and skew frames |
//! | `cards` | equations and prescribed values of each card that constrains |
//! | `checks` | looks at all cards together |
//! | `reader` | reads the cards in order |

mod syntax {
    pub mod card;
}

mod model {
    pub mod groups;
    pub mod mesh;
    pub mod resolve;
}

mod cards;
mod checks;
mod reader;

use std::collections::HashMap;

pub(super) use reader::read;

use crate::deck::Deck;
use model::groups::GroupKind;
use model::mesh::RadiossMesh;

/// Reads the definitions of a deck again. There are none if this fails.
fn mesh(deck: &Deck) -> RadiossMesh {
    deck.again(reader::mesh).unwrap_or_default()
}

/// Positions of the nodes of a deck.
pub(super) fn positions(deck: &Deck) -> HashMap<u32, [f64; 3]> {
    mesh(deck).nodes.into_iter().collect()
}

/// The nodes of the group with this number, if it exists.
pub(super) fn node_set(deck: &Deck, name: &str) -> Option<Vec<u32>> {
    mesh(deck).nodes_of_group(name.parse().ok()?)
}

/// Numbers of the node groups.
pub(super) fn node_set_names(deck: &Deck) -> Vec<String> {
    let groups = mesh(deck).groups;
    groups.into_keys().filter(|(kind, _)| *kind == GroupKind::Nodes).map(|(_, id)| id.to_string()).collect()
}
