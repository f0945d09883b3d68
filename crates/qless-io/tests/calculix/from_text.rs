//! Decks from text without files, and what was read as short text.

use std::path::Path;

use qless_io::deck::{Deck, DeckError, LoadCase, Model, Solver, parse};

/// Corners of a face at z = 1 above those of a face at z = 0, and two more nodes.
pub const BRICK: &str = "*NODE, NSET=NALL
1,0.,0.,0.\n2,1.,0.,0.\n3,1.,1.,0.\n4,0.,1.,0.\n5,0.,0.,1.\n6,1.,0.,1.\n7,1.,1.,1.\n8,0.,1.,1.\n9,.5,.5,2.\n10,.2,.3,3.
*ELEMENT, TYPE=C3D8, ELSET=E\n1,1,2,3,4,5,6,7,8
*NSET, NSET=TOP\n5,6,7,8\n*NSET, NSET=REF\n9\n*SURFACE, NAME=STOP\n1,S2
";

/// The deck `deck.inp` with this text, read for a solver.
pub fn parsed(solver: Solver, text: &str) -> Result<Deck, DeckError> {
    let mut none = |_: &Path| Err(std::io::ErrorKind::NotFound.into());
    parse(solver, Path::new("deck.inp"), text.as_bytes().to_vec(), &mut none)
}

/// The model of the brick and these cards.
pub fn brick(solver: Solver, cards: &str) -> Model {
    model(solver, &format!("{BRICK}{cards}"))
}

pub fn model(solver: Solver, text: &str) -> Model {
    parsed(solver, text).unwrap_or_else(|error| panic!("{error}")).model().clone()
}

/// The message for a deck that must be refused.
pub fn refused(solver: Solver, text: &str) -> String {
    parsed(solver, text).map_or_else(|error| error.to_string(), |_| "accepted".into())
}

/// Equations as `1 1:1 -1 2:1`.
pub fn equations(model: &Model) -> Vec<String> {
    let term = |(&j, a): (&u32, &f64)| format!("{a} {}", model.dof_name(model.dofs()[j as usize]));
    let equation = |i| model.equation(i).expect("an equation");
    let text = |i| {
        let equation = equation(i);
        equation.columns.iter().zip(equation.coefficients).map(term).collect::<Vec<_>>().join(" ")
    };
    (0..model.equations()).map(text).collect()
}

/// Prescribed values as `1:3=0`, with the time history if it has a name.
pub fn prescribed(model: &Model, case: &LoadCase) -> Vec<String> {
    let histories: Vec<_> = model.histories().collect();
    let history = |at: u32| histories[at as usize].map(|name| format!(" {name}")).unwrap_or_default();
    case.prescribed
        .iter()
        .map(|given| format!("{}={}{}", model.dof_name(given.dof), given.value, history(given.history)))
        .collect()
}

/// Warnings, one a line.
pub fn warnings(model: &Model) -> String {
    model.warnings().iter().map(|warning| warning.text.clone()).collect::<Vec<_>>().join("\n")
}
