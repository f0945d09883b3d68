//! Checks the nodes that a deck defines and names, and gives those of instances their names.

use super::model::DeckDefinitions;
use super::syntax::FieldFault;
use crate::deck::{DeckError, Model, Problem, Sources};

/// Refuses equations that name undefined nodes. The error names the undefined node with the lowest number, and its first equation.
pub fn check(model: &Model, definitions: &DeckDefinitions) -> Result<(), DeckError> {
    let defined = definitions.node_numbers();
    if defined.is_empty() || definitions.has_unknown_nodes() {
        return Ok(());
    }
    let mut used: Vec<u32> = model.dofs.iter().map(|dof| dof.node).collect();
    used.sort_unstable();
    used.dedup();
    let mut rest = defined.as_slice();
    let undefined = |node: &&u32| {
        rest = &rest[rest.partition_point(|defined| defined < *node)..];
        rest.first() != Some(*node)
    };
    let Some(&node) = used.iter().find(undefined) else { return Ok(()) };
    let names = |i: &usize| model.nth(*i).columns.iter().any(|&j| model.dofs[j as usize].node == node);
    let origin = (0..model.equations()).find(names).map(|i| model.nth(i).origin);
    let problem = Problem::Undefined { what: "node", name: model.node_name(node) };
    origin.map_or(Ok(()), |origin| Err(model.error(origin, None, problem)))
}

/// Checks the fields of the cards that define nodes, and that generate nodes and elements.
pub fn check_fields(definitions: &DeckDefinitions, sources: &Sources) -> Result<(), DeckError> {
    let error = |card: &str, file: u32, line: u32, (field, problem): FieldFault| {
        let path = sources.path(file as usize).to_path_buf();
        Err(DeckError { path, line: line as usize, card: card.into(), field, problem })
    };
    if let Some((card, file, line, fault)) = &definitions.wrong {
        return error(card, *file, *line, fault.clone());
    }
    definitions.check_nodes().or_else(|(line, fault)| error("*NODE", line.file, line.number, fault))
}

/// Gives the nodes of each instance their names in the model, from the instance and their numbers in it.
pub fn name(model: &mut Model, definitions: &DeckDefinitions) -> Result<(), DeckError> {
    if definitions.instances.is_empty() {
        return Ok(());
    }
    let fail = |problem| {
        let path = model.files()[0].clone();
        DeckError { path, line: 0, card: "*INSTANCE".into(), field: None, problem }
    };
    let numbers = definitions.numbers().map_err(fail)?;
    for (instance, (first, own)) in definitions.instances.iter().zip(numbers.instances()) {
        model.name_nodes(*first, instance.name.clone(), own.clone());
    }
    Ok(())
}
