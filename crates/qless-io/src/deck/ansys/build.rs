//! Builds the model: first the equations by their number, then the coupled sets by their number, then the load cases.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::hash::Hash;

use super::commands::coupled::CoupledSet;
use super::commands::equations::{CeEquation, CeEquations, NodeRegion};
use super::commands::numbering::StartsAt;
use super::joined::JoinedModels;
use super::model::events::{EquationLife, cases};
use super::model::nodes::NodeGroup;
use super::reader::{AnsysModels, AnsysReader, CommandOwner};
use super::syntax::archive::DofCoefficient;
use crate::deck::{CardName, Deck, DeckError, Dof, Model, Origin, Problem, Sources};

/// Reads a deck. The model has the DOFs of `others` even if no equation names them, so `D,ALL` prescribes them, too. If the deck has
/// several models, each has load cases of its own, in which no equation of the others holds.
///
/// # Errors
/// [`DeckError`].
pub fn read(sources: &mut Sources, others: &[Dof]) -> Result<Model, DeckError> {
    let text = sources.text(0);
    let mut joined = JoinedModels::default();
    for reader in AnsysModels::new(sources.path(0), &text, |reader| reader.others = others.to_vec()) {
        let mut reader = reader?;
        fill(&mut reader)?;
        joined.add(reader)?;
    }
    Ok(joined.finish())
}

/// The global position of each node; empty if the deck cannot be read again. A node that models place differently is left out.
pub fn positions(deck: &Deck) -> HashMap<u32, [f64; 3]> {
    agreed(deck, |reader| reader.nodes.positions.kept.unwrap_or_default())
}

/// The nodes of the components that `CMBLOCK` and `CM` define, by name. A name that models define differently is left out.
pub fn node_sets(deck: &Deck) -> HashMap<String, Vec<u32>> {
    let nodes = |ranges: NodeGroup| ranges.iter().flat_map(|&(first, last)| first..=last).collect();
    agreed(deck, |reader| {
        reader.nodes.groups.into_iter().map(|(name, ranges)| (name, nodes(ranges))).collect::<HashMap<_, _>>()
    })
}

/// The entries of all models, without those on which two models differ; empty if the deck cannot be read again.
fn agreed<K: Eq + Hash, V: PartialEq>(deck: &Deck, entries: impl Fn(AnsysReader) -> HashMap<K, V>) -> HashMap<K, V> {
    let read = |sources: &mut Sources| {
        let text = sources.text(0);
        let models = AnsysModels::new(sources.path(0), &text, |reader| reader.nodes.positions.keep());
        models.map(|reader| reader.map(&entries)).collect::<Result<Vec<_>, _>>()
    };
    let mut all: HashMap<K, Option<V>> = HashMap::new();
    for (key, value) in deck.again(read).unwrap_or_default().into_iter().flatten() {
        match all.entry(key) {
            Entry::Vacant(entry) => drop(entry.insert(Some(value))),
            Entry::Occupied(mut entry) if entry.get().as_ref() != Some(&value) => drop(entry.insert(None)),
            Entry::Occupied(_) => {}
        }
    }
    all.into_iter().filter_map(|(key, value)| Some((key, value?))).collect()
}

/// Adds equations and load cases to the model of a reader. If the reader keeps the places of commands, returns the owner of each equation:
/// the command or set that makes it. Otherwise returns an empty list.
pub fn fill(reader: &mut AnsysReader) -> Result<Vec<CommandOwner>, DeckError> {
    check_complete(reader)?;
    let (owners, lives) = push_equations(reader);
    let AnsysReader { model, nodes, events, others, .. } = reader;
    cases(events, nodes, others, &lives, model).map_err(|(origin, problem)| model.error(origin, None, problem))?;
    check_nodes(reader)?;
    warn_of_rotated(reader);
    Ok(owners)
}

fn check_complete(reader: &AnsysReader) -> Result<(), DeckError> {
    let equation = reader.equations.incomplete().map(|(number, line, problem)| (format!("CE {number}"), line, problem));
    let set = || reader.coupled.incomplete().map(|(number, line, problem)| (format!("CP {number}"), line, problem));
    let Some((card, line, problem)) = equation.or_else(set) else { return Ok(()) };
    Err(DeckError { path: reader.model.files[0].clone(), line: line as usize, card, field: None, problem })
}

/// The owner of each equation, and the equations that do not hold in all load steps.
type PushedEquations = (Vec<CommandOwner>, Vec<EquationLife>);

/// Adds equations by number, coupled sets by number, then versions of both that held in earlier load steps only.
fn push_equations(reader: &mut AnsysReader) -> PushedEquations {
    let AnsysReader { model, equations, coupled, places, .. } = reader;
    let mut push = EquationPusher {
        model,
        regions: vec![None; equations.regions.len()],
        keeps_owners: places.is_some(),
        pushed: PushedEquations::default(),
    };
    push.model.reserve(equations.sets.len(), equations.terms.len());
    for (number, equation) in equations.sets.iter() {
        push.equation(equations, number, equation, u32::MAX);
    }
    for (number, set) in coupled.sets.iter() {
        push.set(number, set, u32::MAX);
    }
    for past in &equations.past {
        push.equation(equations, past.number, &past.value, past.last);
    }
    for past in &coupled.past {
        push.set(past.number, &past.value, past.last);
    }
    push.model.shrink();
    push.pushed
}

struct EquationPusher<'a> {
    model: &'a mut Model,
    /// The card of each region, that is of each `CERIG` or `RBE3`; `None` until its first equation is added.
    regions: Vec<Option<u32>>,
    keeps_owners: bool,
    pushed: PushedEquations,
}

impl EquationPusher<'_> {
    fn equation(&mut self, all: &CeEquations, number: u32, equation: &CeEquation, last: u32) {
        let model = &mut *self.model;
        if all.terms.count(&equation.terms) == 0 && equation.constant == 0.0 {
            model.warn(0, equation.line, format!("CE {number} has no terms: left out"));
            return;
        }
        let terms = all.terms.iter(&equation.terms);
        if names_twice(terms.clone()) {
            let text = format!("CE {number} names a DOF more than once: its coefficients are added");
            model.warn(0, equation.line, text);
        }
        let (card, owner) = match equation.region() {
            Some(at) => {
                let NodeRegion { name, node, line, .. } = all.regions[at];
                let new = || model.card(CardName::numbered(name, node), 0, line);
                (*self.regions[at].get_or_insert_with(new), CommandOwner::Region(at))
            }
            None => (model.card(CardName::numbered("CE", number), 0, equation.line), CommandOwner::Equation(number)),
        };
        let origin = origin(card, equation.line, equation.last_line);
        model.push(terms, equation.constant, origin);
        self.note_origin(owner, equation.from(), last);
    }

    fn set(&mut self, number: u32, set: &CoupledSet, last: u32) {
        let card = self.model.card(CardName::numbered("CP", number), 0, set.line);
        for equation in set.equations() {
            self.model.push(equation, 0.0, origin(card, set.line, set.last_line));
            self.note_origin(CommandOwner::Coupled(number), set.from(), last);
        }
    }

    /// Records the owner of the equation that was added last, and the load steps in which it holds.
    fn note_origin(&mut self, owner: CommandOwner, first: u32, last: u32) {
        if self.keeps_owners {
            self.pushed.0.push(owner);
        }
        if first > 0 || last < u32::MAX {
            self.pushed.1.push(EquationLife { equation: self.model.equations() as u32 - 1, first, last });
        }
    }
}

fn origin(card: u32, line: u32, last: u32) -> Origin {
    Origin { card, line, lines: last.saturating_sub(line) + 1 }
}

fn names_twice(terms: impl Iterator<Item = DofCoefficient> + Clone) -> bool {
    let mut first = terms.clone().map(|(dof, _)| dof);
    if let (Some(first), Some(second), None) = (first.next(), first.next(), first.next()) {
        return first == second;
    }
    let mut dofs: Vec<Dof> = terms.map(|(dof, _)| dof).collect();
    dofs.sort_unstable();
    dofs.windows(2).any(|pair| pair[0] == pair[1])
}

/// Rejects the first equation that names a node which no command defines.
fn check_nodes(reader: &AnsysReader) -> Result<(), DeckError> {
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

/// Warns if the model constrains a node whose axes are rotated: its components are along these axes.
fn warn_of_rotated(reader: &mut AnsysReader) {
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
