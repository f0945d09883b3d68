//! What the commands say as a model: equations by their number, then coupled sets, and the load cases.

pub mod events;
pub mod nodes;
pub mod positions;
pub mod sets;
pub mod terms;

use events::cases;
use terms::Term;

use super::commands::equations::Equations;
use super::reader::{Owner, Reader};
use crate::deck::{CardName, DeckError, Dof, Model, Origin, Problem, Sources};

/// Reads a deck.
///
/// # Errors
/// [`DeckError`].
pub fn read(sources: &mut Sources) -> Result<Model, DeckError> {
    let mut reader = Reader::read(sources.path(0), &sources.text(0))?;
    fill(&mut reader)?;
    Ok(reader.model)
}

/// Fills the model of a reader and says what each of its equations comes from, if the reader keeps places.
pub fn fill(reader: &mut Reader) -> Result<Vec<Owner>, DeckError> {
    check_complete(reader)?;
    let owners = push_equations(reader);
    let Reader { model, nodes, events, .. } = reader;
    cases(events, nodes, model).map_err(|(origin, problem)| model.error(origin, None, problem))?;
    check_nodes(reader)?;
    warn_of_rotated(reader);
    Ok(owners)
}

fn check_complete(reader: &Reader) -> Result<(), DeckError> {
    let equation = reader.equations.incomplete().map(|(number, line, problem)| (format!("CE {number}"), line, problem));
    let set = || reader.coupled.incomplete().map(|(number, line, problem)| (format!("CP {number}"), line, problem));
    let Some((card, line, problem)) = equation.or_else(set) else { return Ok(()) };
    Err(DeckError { path: reader.model.files[0].clone(), line: line as usize, card, field: None, problem })
}

fn push_equations(reader: &mut Reader) -> Vec<Owner> {
    let model = &mut reader.model;
    let Equations { sets, terms, .. } = &reader.equations;
    let mut owners = Vec::new();
    let mut own = |owner| {
        if reader.places.is_some() {
            owners.push(owner);
        }
    };
    model.reserve(sets.len(), terms.len());
    let origin = |model: &mut Model, name: CardName, line: u32, last: u32| {
        let card = model.card(name, 0, line);
        Origin { card, line, lines: last.saturating_sub(line) + 1 }
    };
    for (number, equation) in sets.iter() {
        if terms.count(&equation.terms) == 0 && equation.constant == 0.0 {
            model.warn(0, equation.line, format!("CE {number} has no terms: left out"));
            continue;
        }
        let terms = terms.of(&equation.terms);
        if names_twice(terms.clone()) {
            let text = format!("CE {number} names a DOF more than once: its coefficients are added");
            model.warn(0, equation.line, text);
        }
        let origin = origin(model, CardName::numbered("CE", number), equation.line, equation.last_line);
        model.push(terms, equation.constant, origin);
        own(Owner::Equation(number));
    }
    for (number, set) in reader.coupled.sets.iter() {
        let origin = origin(model, CardName::numbered("CP", number), set.line, set.last_line);
        for equation in set.equations() {
            model.push(equation, 0.0, origin);
            own(Owner::Coupled(number));
        }
    }
    model.shrink();
    owners
}

fn names_twice(terms: impl Iterator<Item = Term> + Clone) -> bool {
    let mut first = terms.clone().map(|(dof, _)| dof);
    if let (Some(first), Some(second), None) = (first.next(), first.next(), first.next()) {
        return first == second;
    }
    let mut dofs: Vec<Dof> = terms.map(|(dof, _)| dof).collect();
    dofs.sort_unstable();
    dofs.windows(2).any(|pair| pair[0] == pair[1])
}

/// A node that no command defines: the first equation that names it is at fault.
fn check_nodes(reader: &Reader) -> Result<(), DeckError> {
    let (model, nodes) = (&reader.model, &reader.nodes);
    if nodes.numbers.is_empty() || nodes.are_generated {
        return Ok(());
    }
    let mut defined = nodes.numbers.clone();
    defined.sort_unstable();
    let is_undefined = |node: u32| defined.binary_search(&node).is_err();
    if !model.dofs.iter().any(|dof| is_undefined(dof.node)) {
        return Ok(());
    }
    for i in 0..model.equations() {
        let equation = model.nth(i);
        let mut names = equation.columns.iter().map(|&j| model.dofs[j as usize].node);
        if let Some(node) = names.find(|&node| is_undefined(node)) {
            let problem = Problem::Undefined { what: "node", name: node.to_string() };
            return Err(model.error(equation.origin, None, problem));
        }
    }
    Ok(())
}

/// Components are along the axes of their node; said where these are not those of the model.
fn warn_of_rotated(reader: &mut Reader) {
    let mut rotated = std::mem::take(&mut reader.nodes.rotated);
    if rotated.is_empty() {
        return;
    }
    rotated.sort_unstable();
    rotated.dedup();
    let model = &mut reader.model;
    let constrained = model.dofs.iter().find(|dof| rotated.binary_search(&dof.node).is_ok());
    if let Some(dof) = constrained {
        let node = dof.node;
        model.warn(0, 0, format!("nodes with rotated axes, such as {node}, are constrained along these axes"));
    }
}
