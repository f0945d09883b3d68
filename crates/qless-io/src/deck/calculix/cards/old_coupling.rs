//! Reads `*KINEMATIC COUPLING` and `*DISTRIBUTING COUPLING`, the predecessors of `*COUPLING`.

use crate::deck::calculix::cards::coupling::{finish, mean, range, translations};
use crate::deck::calculix::cards::rigid::{BodyReference, kinematic};
use crate::deck::calculix::cards::{CardEquation, RegisteredCard};
use crate::deck::calculix::model::DeckDefinitions;
use crate::deck::calculix::syntax::{KeywordCard, float};
use crate::deck::kinematics::axes::BASIC_AXES;
use crate::deck::kinematics::mean::WeightedNodes;
use crate::deck::kinematics::vector::{Vector, scaled};
use crate::deck::{DeckError, Model, Problem, Solver};
use crate::fault::quote;

/// Reads `*KINEMATIC COUPLING, REF NODE=`, whose lines hold `node or set, first, last`.
pub fn kinematic_coupling(
    card: &KeywordCard,
    model: &mut Model,
    definitions: &DeckDefinitions,
    solver: Solver,
) -> Result<(), DeckError> {
    let place = RegisteredCard::register(card, model, "*KINEMATIC COUPLING");
    if solver == Solver::Ccx {
        let text = "*KINEMATIC COUPLING is no card of ccx; write *COUPLING with *KINEMATIC";
        model.warn(card.file, card.line, text);
    }
    let rows = || {
        let reference = card.parameter("REFNODE").ok_or(Problem::NoParameter { name: "REF NODE" })?;
        let reference = definitions.one_node(card.scope, reference.as_bytes())?;
        let reference = BodyReference::with_rotations(reference);
        let mut rows = Vec::new();
        for line in card.lines() {
            let mut fields = line.fields();
            let nodes = definitions.node_or_set(card.scope, fields.next().unwrap_or_default())?;
            let range = range(&mut fields, 6)?;
            let nodes = nodes.into_iter().filter(|&node| node != reference.node);
            rows.extend(kinematic(definitions, reference, nodes, &range, None)?);
        }
        Ok(rows)
    };
    let rows = rows();
    finish(card, &place, model, rows)
}

/// Reads `*DISTRIBUTING COUPLING, ELSET=`, whose lines hold `node or set, weight`. The only node of the element set is the reference r. In
/// ccx, the card gives `sum w_k u_k - sum w_k u_r = 0` in each direction, with the weights w_k and the displacements u of the nodes. The
/// first node is the slave. In Abaqus, r moves as the weighted mean of the nodes.
pub fn distributing_coupling(
    card: &KeywordCard,
    model: &mut Model,
    definitions: &DeckDefinitions,
    solver: Solver,
) -> Result<(), DeckError> {
    let place = RegisteredCard::register(card, model, "*DISTRIBUTING COUPLING");
    let rows = || {
        let (reference, mut weights) = weights(card, definitions)?;
        if solver == Solver::Ccx {
            weights.push((reference, -weights.iter().map(|(_, weight)| weight).sum::<f64>()));
            let gradients = |axis: Vector| weights.iter().map(|&(node, w)| (node, scaled(axis, w))).collect::<Vec<_>>();
            let row = |&axis: &Vector| CardEquation::along(definitions, &gradients(axis), 0.0);
            return BASIC_AXES.iter().map(row).collect();
        }
        let group = |(node, weight)| WeightedNodes { weight, components: translations(), nodes: vec![node] };
        mean(definitions, reference, &[1, 2, 3, 4, 5, 6], weights.into_iter().map(group).collect())
    };
    let rows = rows();
    if solver == Solver::Ccx {
        return place.push(model, rows);
    }
    finish(card, &place, model, rows)
}

/// The reference of a `*DISTRIBUTING COUPLING`, and the coupled nodes with their weights.
fn weights(card: &KeywordCard, definitions: &DeckDefinitions) -> Result<(u32, Vec<(u32, f64)>), Problem> {
    let set = card.parameter("ELSET").ok_or(Problem::NoParameter { name: "ELSET" })?;
    let [reference] = definitions.nodes_of(card.scope, set)?[..] else {
        let found = quote(set.as_bytes());
        return Err(Problem::Expected { expected: "an element set with one node, the reference", found });
    };
    let mut weights: Vec<(u32, f64)> = Vec::new();
    for line in card.lines() {
        let mut fields = line.fields();
        let nodes = definitions.node_or_set(card.scope, fields.next().unwrap_or_default())?;
        let weight = fields.next().filter(|field| !field.is_empty()).map_or(Ok(1.0), float)?;
        weights.extend(nodes.into_iter().map(|node| (node, weight)));
    }
    Ok((reference, weights))
}
