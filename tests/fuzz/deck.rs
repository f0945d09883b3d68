//! Decks of every format.

use std::io::{Error, ErrorKind};
use std::path::Path;

use qless::Options;
use qless_io::deck::clean::{CleanError, faults, plan, write};
use qless_io::deck::{Deck, DeckError, Format, Outcome, parse};

use super::files::split;

/// Largest number of terms of a deck that is cleaned; the target mainly tests the reader.
const TERMS: usize = 2_000;

/// Reads and cleans a CalculiX deck.
pub fn calculix(data: &[u8]) {
    deck(Format::Calculix, "deck.inp", data);
}

/// Reads and cleans a Nastran deck.
pub fn nastran(data: &[u8]) {
    deck(Format::Nastran, "deck.bdf", data);
}

/// Reads and cleans an ANSYS deck.
pub fn ansys(data: &[u8]) {
    deck(Format::Ansys, "deck.cdb", data);
}

/// Reads an LS-DYNA deck.
pub fn lsdyna(data: &[u8]) {
    deck(Format::LsDyna, "deck.k", data);
}

/// Reads a Radioss deck.
pub fn radioss(data: &[u8]) {
    deck(Format::Radioss, "deck_0000.rad", data);
}

fn deck(format: Format, name: &str, data: &[u8]) {
    let (main, others) = split(data);
    match read(format, name, main, &others) {
        Ok(deck) => check(&deck, name, &others),
        Err(error) => assert!(error.to_string().contains(':'), "{error}"),
    }
}

fn read(format: Format, name: &str, main: Vec<u8>, others: &[(String, Vec<u8>)]) -> Result<Deck, DeckError> {
    let mut open = |path: &Path| {
        let name = path.to_string_lossy();
        let file = others.iter().find(|(known, _)| *known == name);
        file.map(|(_, text)| text.clone()).ok_or_else(|| Error::from(ErrorKind::NotFound))
    };
    parse(format, Path::new(name), main, &mut open)
}

/// A deck gives a system, or a typed error, for each load case.
fn check(deck: &Deck, name: &str, others: &[(String, Vec<u8>)]) {
    let model = deck.model();
    assert!(!model.cases().is_empty(), "a deck has at least one load case");
    for case in model.cases().iter().take(4) {
        if let Ok(system) = model.system(case) {
            assert_eq!(system.equations(), model.in_force(case).count() + case.clashes.len());
        }
    }
    if model.terms() <= TERMS && model.cases().len() <= 4 {
        clean(deck, name, others);
    }
}

/// A cleaned deck is read again without faults, and a second cleaning does not change it.
fn clean(deck: &Deck, name: &str, others: &[(String, Vec<u8>)]) {
    let Ok(first) = plan(deck, &Options::default()) else { return };
    let text = match write(deck, &first) {
        Ok(text) => text,
        Err(error @ CleanError::Unproven { .. }) => panic!("{error}"),
        Err(_) => return,
    };
    if first.is_empty() {
        assert_eq!(text, *deck.texts()[0]);
        return;
    }
    let again = match read(deck.format(), name, text, others) {
        Ok(again) => again,
        Err(error) => panic!("what was written is not read: {error}"),
    };
    let (model, solver) = (again.model(), again.solver());
    let found = faults(model).into_iter().filter(|fault| solver.outcome(fault, model) != Outcome::Accepted);
    let left: Vec<String> = found.map(|fault| fault.describe(model)).collect();
    assert!(left.is_empty(), "{left:?}");
    if let Ok(second) = plan(&again, &Options::default()) {
        assert!(second.is_empty(), "{second:?}");
    }
}
