//! Decks from text without files.
//!
//! A word of a data line is a field of 10 columns, and one after `=` a field of 20. `111/011` marks components, and `_` is blank. Keyword
//! lines, comments, and titles after a quote are as they are.

use std::io::{Error, ErrorKind};
use std::path::{Path, PathBuf};

use qless_io::deck::{Deck, DeckError, Model, Solver, parse};

pub use super::as_text::{analysis, equations, left_out, prescribed};

/// A unit cube of one solid (part 1), a plate of one shell (part 2) on it, and nodes 20 to 22 without elements.
pub const CUBE: &str = "#RADIOSS STARTER
/BEGIN
'cube
2019 0
/NODE
1 =0. =0. =0.\n2 =1. =0. =0.\n3 =1. =1. =0.\n4 =0. =1. =0.\n5 =0. =0. =1.\n6 =1. =0. =1.\n7 =1. =1. =1.\n8 =0. =1. =1.
11 =.25 =.25 =1.\n12 =.75 =.25 =1.\n13 =.75 =.75 =1.\n14 =.25 =.75 =1.\n20 =2. =0. =0.\n21 =2. =1. =0.\n22 =0. =0. =3.
/PART/1\n'block\n7 8 9
/PART/2\n'plate\n17 18 19
/BRICK/1
1 1 2 3 4 5 6 7 8
/SHELL/2
2 11 12 13 14
/GRNOD/NODE/3\n'top\n5 6 7 8
/GRNOD/NODE/4\n'plate\n11 12 13 14
/SURF/SEG/5\n'top\n1 5 6 7 8
";

fn field(word: &str) -> String {
    match (word, word.strip_prefix('='), word.split_once('/')) {
        ("_", ..) => " ".repeat(10),
        (_, Some(wide), _) => format!("{wide:>20}"),
        (_, _, Some((first, last))) => format!("   {first} {last}"),
        _ => format!("{word:>10}"),
    }
}

/// The text of a deck in columns.
pub fn columns(text: &str) -> String {
    let line = |line: &str| match line.chars().next() {
        Some('/' | '#' | '$') => line.to_owned(),
        Some('\'') => line[1..].to_owned(),
        _ => line.split_whitespace().map(field).collect(),
    };
    text.lines().map(|text| line(text) + "\n").collect()
}

/// The deck `deck_0000.rad` with these bytes and these other files.
pub fn parsed_bytes(bytes: Vec<u8>, others: &[(&str, &str)]) -> Result<Deck, DeckError> {
    let others: Vec<(PathBuf, &str)> = others.iter().map(|(name, text)| (PathBuf::from(name), *text)).collect();
    let mut open = |path: &Path| {
        let file = others.iter().find(|(name, _)| name == path);
        file.map(|(_, text)| columns(text).into_bytes()).ok_or_else(|| Error::from(ErrorKind::NotFound))
    };
    parse(Solver::Radioss, Path::new("deck_0000.rad"), bytes, &mut open)
}

pub fn parsed(text: &str) -> Result<Deck, DeckError> {
    parsed_bytes(columns(text).into_bytes(), &[])
}

pub fn model(text: &str) -> Model {
    parsed(text).unwrap_or_else(|error| panic!("{error}\n{}", columns(text))).model().clone()
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

/// The messages about cards at which the solver stops.
pub fn stops(model: &Model) -> Vec<String> {
    model.refusals().iter().map(|refusal| format!("{}: {}", model.place_of(refusal), refusal.text)).collect()
}
