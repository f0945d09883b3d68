//! Decks from text.

use std::io::ErrorKind;
use std::path::Path;

use qless_io::deck::clean::faults;
use qless_io::deck::{Deck, DeckError, Format, Outcome, parse};

pub fn try_deck(text: &str) -> Result<Deck, DeckError> {
    let none = &mut |_: &Path| Err(ErrorKind::NotFound.into());
    parse(Format::Ansys, Path::new("deck.cdb"), text.as_bytes().to_vec(), none)
}

pub fn deck(text: &str) -> Deck {
    try_deck(text).expect("a deck")
}

/// An equation as `node:component coefficient ... = rhs`.
pub fn equations(deck: &Deck) -> Vec<String> {
    let model = deck.model();
    let term = |j: u32, a: f64| format!("{} {a}", model.dofs()[j as usize]);
    let text = |i: usize| {
        let equation = model.equation(i).expect("an equation");
        let terms: Vec<String> =
            equation.columns.iter().zip(equation.coefficients).map(|(&j, &a)| term(j, a)).collect();
        format!("{} = {}", terms.join(", "), equation.rhs)
    };
    (0..model.equations()).map(text).collect()
}

/// The faults that ANSYS does not accept.
pub fn refused(deck: &Deck) -> Vec<String> {
    let (model, solver) = (deck.model(), deck.solver());
    let all = faults(model).into_iter().filter(|fault| solver.outcome(fault, model) != Outcome::Accepted);
    all.map(|fault| fault.describe(model)).collect()
}

/// Equations in force in a load case, as `node:component coefficient ... = rhs`.
pub fn in_force(deck: &Deck, case: usize) -> Vec<String> {
    let all = equations(deck);
    deck.model().in_force(&deck.model().cases()[case]).map(|i| all[i].clone()).collect()
}

/// Prescribed values of a load case as `node:component value`.
pub fn prescribed(deck: &Deck, case: usize) -> Vec<String> {
    deck.model().cases()[case].prescribed.iter().map(|given| format!("{} {}", given.dof, given.value)).collect()
}

pub fn warnings(deck: &Deck) -> Vec<String> {
    deck.model().warnings().iter().map(|warning| format!("{}: {}", warning.line, warning.text)).collect()
}
