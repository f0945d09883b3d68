//! Decks of every format.

use std::io::{Error, ErrorKind};
use std::path::Path;

use qless_io::deck::{Deck, Format, parse};

use crate::files::split;

/// Reads a CalculiX deck.
pub fn calculix(data: &[u8]) {
    read(Format::Calculix, "deck.inp", data);
}

/// Reads a deck; one that is accepted gives a system, or a typed error, for each load case.
fn read(format: Format, name: &str, data: &[u8]) {
    let (main, others) = split(data);
    let mut open = |path: &Path| {
        let name = path.to_string_lossy();
        let file = others.iter().find(|(known, _)| *known == name);
        file.map(|(_, text)| text.clone()).ok_or_else(|| Error::from(ErrorKind::NotFound))
    };
    match parse(format, Path::new(name), main, &mut open) {
        Ok(deck) => check(&deck),
        Err(error) => assert!(error.to_string().contains(':'), "{error}"),
    }
}

fn check(deck: &Deck) {
    assert!(!deck.model.cases.is_empty(), "a deck has at least one load case");
    for case in &deck.model.cases {
        let system = deck.model.system(case);
        if let Ok(system) = &system {
            assert_eq!(system.equations(), deck.model.in_force(case).count() + case.clashes.len());
        }
    }
}
