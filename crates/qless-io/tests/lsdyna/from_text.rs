//! Decks from text without files.

use std::io::{Error, ErrorKind};
use std::path::{Path, PathBuf};

use qless_io::deck::{Deck, DeckError, Model, Solver, parse};

pub use super::as_text::{analysis, equations, left_out, prescribed, system};

/// A unit cube of one solid (part 1), a plate of one shell (part 2) above it, and nodes 20 to 22 without elements.
pub const CUBE: &str = "*KEYWORD
*NODE
1,0.,0.,0.\n2,1.,0.,0.\n3,1.,1.,0.\n4,0.,1.,0.\n5,0.,0.,1.\n6,1.,0.,1.\n7,1.,1.,1.\n8,0.,1.,1.
11,.25,.25,1.\n12,.75,.25,1.\n13,.75,.75,1.\n14,.25,.75,1.\n20,2.,0.,0.\n21,2.,1.,0.\n22,0.,0.,3.
*ELEMENT_SOLID
1,1,1,2,3,4,5,6,7,8
*ELEMENT_SHELL
2,2,11,12,13,14
*SET_NODE_LIST\n3\n5,6,7,8
*SET_NODE_LIST\n4\n11,12,13,14
*SET_SEGMENT\n5\n5,6,7,8
";

/// The deck `deck.k` with this text and these other files.
pub fn parsed_with(text: &str, others: &[(&str, &str)]) -> Result<Deck, DeckError> {
    let others: Vec<(PathBuf, &str)> = others.iter().map(|(name, text)| (PathBuf::from(name), *text)).collect();
    let mut open = |path: &Path| {
        let file = others.iter().find(|(name, _)| name == path);
        file.map(|(_, text)| text.as_bytes().to_vec()).ok_or_else(|| Error::from(ErrorKind::NotFound))
    };
    parse(Solver::LsDyna, Path::new("deck.k"), text.as_bytes().to_vec(), &mut open)
}

pub fn parsed(text: &str) -> Result<Deck, DeckError> {
    parsed_with(text, &[])
}

pub fn model(text: &str) -> Model {
    parsed(text).unwrap_or_else(|error| panic!("{error}\n{text}")).model().clone()
}

/// The model of the cube and these cards.
pub fn cube(cards: &str) -> Model {
    model(&format!("{CUBE}{cards}"))
}

/// Number of the first line after the cube.
pub fn first_line() -> usize {
    CUBE.lines().count() + 1
}

/// The message for a deck that must be refused.
pub fn refused(text: &str) -> String {
    parsed(text).map_or_else(|error| error.to_string(), |_| "accepted".into())
}
