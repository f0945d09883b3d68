//! Holds the text of the cards that define nodes, sets, elements, surfaces and axes. The modules below parse it when it is needed.

pub mod definitions;
pub mod elements;
pub mod frames;
pub mod instances;
pub mod mesh;
pub mod sets;

pub use definitions::DeckDefinitions;
pub use mesh::DeckSurface;

use std::cell::RefCell;
use std::rc::Rc;

use rustc_hash::FxHashMap;

use crate::deck::calculix::syntax::{DataPiece, KeywordCard, Scope, fold_name};
use crate::deck::kinematics::axes::FrameKind;

/// A name, and the scope in which it is defined.
pub type ScopedName = (Scope, String);

/// An `*ELEMENT` card.
pub struct ElementDefinition {
    pub scope: Scope,
    pub kind: String,
    pub set: Option<String>,
    pub data: Vec<DataPiece>,
}

/// A `*SURFACE` card.
pub struct SurfaceCard {
    pub scope: Scope,
    pub of_nodes: bool,
    pub data: Vec<DataPiece>,
}

/// A `*TRANSFORM` or `*ORIENTATION` card.
pub struct AxesCard {
    pub scope: Scope,
    /// `None` if the kind of axes is not known.
    pub kind: Option<FrameKind>,
    pub data: Vec<DataPiece>,
}

/// Copies the axes from a `*TRANSFORM` or `*ORIENTATION` card, whose parameter names their kind by its first letter.
pub fn axes(card: &KeywordCard, parameter: &str) -> AxesCard {
    let kind = match card.word(parameter).unwrap_or_default().as_bytes().first() {
        None | Some(b'R') => Some(FrameKind::Rectangular),
        Some(b'C') => Some(FrameKind::Cylindrical),
        Some(_) => None,
    };
    AxesCard { scope: card.scope, kind, data: card.data.clone() }
}

/// Members of a set, as one card gives them.
pub enum SetMembers {
    /// Lines whose first field is a node, as on `*NODE` cards.
    Lines(Vec<DataPiece>),
    /// Numbers of members, and names of other sets.
    List(Vec<DataPiece>),
    /// Lines `first, last, increment`.
    Generate(Vec<DataPiece>),
    /// The nodes of an element set.
    OfElements(String),
}

/// The members that one card adds to a set.
pub struct SetPart {
    pub scope: Scope,
    /// The instance that `INSTANCE=` on the card names. It replaces the card's own scope.
    pub instance: Option<String>,
    pub part: SetMembers,
}

impl SetPart {
    /// The members that this card adds to a set.
    pub fn from_card(card: &KeywordCard, part: SetMembers) -> Self {
        Self { scope: card.scope, instance: card.word("INSTANCE"), part }
    }
}

/// A set whose members are known, or which is being parsed.
pub enum ParsedSet {
    InProgress,
    Done(Rc<Vec<u32>>),
}

/// All node sets and element sets of a deck.
#[derive(Default)]
pub struct SetTable {
    pub of_nodes: FxHashMap<ScopedName, Vec<SetPart>>,
    pub of_elements: FxHashMap<ScopedName, Vec<SetPart>>,
    pub known: RefCell<FxHashMap<(bool, ScopedName), ParsedSet>>,
}

/// The name in a field, converted so that equal names compare as equal.
pub fn folded(field: &[u8]) -> String {
    fold_name(&String::from_utf8_lossy(field))
}
