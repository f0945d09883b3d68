//! Decks from text without files, and what was read as short text.

use std::io;
use std::path::Path;

use qless_io::deck::{Deck, DeckError, Format, LoadCase, Model, Solver, Warning, parse};

/// The deck `deck.bdf` with this text; `files` are those that it may include, beside it.
pub fn parsed(text: &str, files: &[(&str, &str)]) -> Result<Deck, DeckError> {
    let mut open = |path: &Path| -> io::Result<Vec<u8>> {
        let known = files.iter().find(|(name, _)| path == Path::new("place").join(name));
        known.map(|(_, text)| text.as_bytes().to_vec()).ok_or_else(|| io::ErrorKind::NotFound.into())
    };
    parse(Format::Nastran, Path::new("place/deck.bdf"), text.as_bytes().to_vec(), &mut open)
}

pub fn model(text: &str) -> Model {
    parsed(text, &[]).unwrap_or_else(|error| panic!("{error}")).model().clone()
}

/// The model of a deck as a solver reads it.
pub fn model_for(solver: Solver, text: &str) -> Model {
    let mut none = |_: &Path| Err(io::ErrorKind::NotFound.into());
    let deck = parse(solver, Path::new("place/deck.bdf"), text.as_bytes().to_vec(), &mut none);
    deck.unwrap_or_else(|error| panic!("{error}\n{text}")).model().clone()
}

/// The message of a deck that is refused.
pub fn refused(text: &str) -> String {
    parsed(text, &[]).map_or_else(|error| error.to_string(), |_| "accepted".into())
}

/// Equation `i` as `1 1:1 -1 2:1`.
pub fn equation(model: &Model, i: usize) -> String {
    let equation = model.equation(i).expect("an equation");
    let term = |(&j, a): (&u32, &f64)| format!("{a} {}", model.dofs()[j as usize]);
    equation.columns.iter().zip(equation.coefficients).map(term).collect::<Vec<_>>().join(" ")
}

/// All equations.
pub fn equations(model: &Model) -> Vec<String> {
    (0..model.equations()).map(|i| equation(model, i)).collect()
}

/// Prescribed values as `1:3=0`.
pub fn prescribed(case: &LoadCase) -> Vec<String> {
    case.prescribed.iter().map(|given| format!("{}={}", given.dof, given.value)).collect()
}

/// Warnings as `line 3: text`.
pub fn warnings(model: &Model) -> Vec<String> {
    at_lines(model.warnings())
}

/// What the solver refuses, in the same way.
pub fn refusals(model: &Model) -> Vec<String> {
    at_lines(model.refusals())
}

fn at_lines(all: &[Warning]) -> Vec<String> {
    all.iter().map(|warning| format!("line {}: {}", warning.line, warning.text)).collect()
}
