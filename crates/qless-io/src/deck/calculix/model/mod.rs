//! Holds the text of the cards that define nodes, sets, elements, surfaces and axes. The modules below parse it when it is needed.

pub mod definitions;
pub mod elements;
pub mod frames;
pub mod generated;
pub mod instances;
pub mod mesh;
pub mod sets;
pub mod steps;

pub use definitions::DeckDefinitions;
pub use mesh::DeckSurface;

use std::cell::RefCell;
use std::rc::Rc;

use rustc_hash::FxHashMap;

use crate::deck::Problem;
use crate::deck::calculix::syntax::{DataPiece, KeywordCard, Scope, fold_name};
use crate::deck::kinematics::axes::Frame;
use crate::deck::kinematics::vector::Vector;

/// A name, and the scope in which it is defined.
pub type ScopedName = (Scope, String);

/// An `*ELEMENT` card.
pub struct ElementDefinition {
    pub scope: Scope,
    pub kind: String,
    pub set: Option<String>,
    pub data: Vec<DataPiece>,
}

/// The state of the cards that generate nodes and elements.
#[derive(Default)]
pub struct Generation {
    /// The frame of `*SYSTEM` in each scope; `None` if it is not known.
    pub systems: FxHashMap<Scope, Option<Frame>>,
    /// For each scope: how many pieces of its nodes have been read, and the positions in them.
    pub positions: FxHashMap<Scope, (usize, FxHashMap<u32, Vector>)>,
    /// How many blocks of elements have been read.
    pub blocks: usize,
    /// For each element in them, the index of its block and its nodes.
    pub elements: FxHashMap<(Scope, u32), (usize, Vec<u32>)>,
    /// Number of nodes and elements that are generated.
    pub count: usize,
    /// Whether cards define nodes whose numbers are not known.
    pub has_unknown_nodes: bool,
    /// Whether `*NMAP` moves nodes.
    pub has_moved_nodes: bool,
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
    pub kind: AxesKind,
    /// Whether the data are coordinates of points.
    pub has_points: bool,
    pub data: Vec<DataPiece>,
}

/// The kind of the axes of a `*TRANSFORM` or `*ORIENTATION` card.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AxesKind {
    /// Point a is on the first axis.
    Rectangular,
    /// Point a is on the third axis: `SYSTEM=Z RECTANGULAR`.
    ZRectangular,
    Cylindrical,
    /// Axes that this reader does not follow in Abaqus. In ccx, all axes but cylindrical ones are rectangular.
    Other,
}

/// Copies the axes from a `*TRANSFORM` or `*ORIENTATION` card, whose parameter names their kind by its first letter.
pub fn axes(card: &KeywordCard, parameter: &str) -> AxesCard {
    let has_points = card.word("DEFINITION").is_none_or(|definition| definition == "COORDINATES");
    let kind = match card.word(parameter).unwrap_or_default().as_bytes().first() {
        Some(b'C') => AxesKind::Cylindrical,
        None | Some(b'R') => AxesKind::Rectangular,
        Some(b'Z') => AxesKind::ZRectangular,
        _ => AxesKind::Other,
    };
    AxesCard { scope: card.scope, kind, has_points, data: card.data.clone() }
}

/// The local axes of nodes, or why they are not known.
pub type LocalAxes = FxHashMap<u32, Result<Frame, Problem>>;

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
    /// Members that this card gives and this reader does not follow.
    Unknown(&'static str),
}

/// The members that one card adds to a set.
pub struct SetPart {
    pub scope: Scope,
    /// The instance that `INSTANCE=` on the card names. It replaces the card's own scope.
    pub instance: Option<String>,
    /// Whether the members are in the order of the card. Abaqus sorts all others.
    pub is_unsorted: bool,
    pub part: SetMembers,
}

impl SetPart {
    /// The members that this card adds to a set.
    pub fn from_card(card: &KeywordCard, part: SetMembers) -> Self {
        let is_unsorted = card.parameter("UNSORTED").is_some();
        Self { scope: card.scope, instance: card.word("INSTANCE"), is_unsorted, part }
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
