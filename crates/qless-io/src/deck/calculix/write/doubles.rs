//! Nodes that stand for others with axes of their own.
//!
//! An equation that names two components of such a node names the same global DOFs twice, which ccx adds up only where it inserts another
//! equation (see `clean::repeated`). One of the components is written as that of a new node d, with `u_d - u = 0` for ccx to insert.

use std::collections::{BTreeMap, BTreeSet};

use super::rotations::{refused, unused_node};
use crate::deck::clean::{Cases, CleanError, Written};
use crate::deck::{Deck, Dof, Model};

/// New nodes, by the DOF that they stand for: one node for each that needs any.
#[derive(Default)]
pub struct Doubles {
    node_of: BTreeMap<u32, u32>,
    dofs: BTreeSet<Dof>,
}

impl Doubles {
    /// What the equations need; `taken` unused nodes are taken already.
    pub fn of(deck: &Deck, written: &[Written], taken: u32) -> Result<Self, CleanError> {
        let dofs: BTreeSet<Dof> = written.iter().flat_map(|equation| repeated(&deck.model, equation)).collect();
        let Some(first) = dofs.iter().next() else { return Ok(Self::default()) };
        if deck.model.has_instances() {
            let name = deck.model.node_name(first.node);
            let why = format!(
                "equations with several components of {name}, which has axes of its own, need a new node in the assembly"
            );
            return Err(refused(deck, why));
        }
        let next = unused_node(deck)?.saturating_add(taken);
        let nodes: BTreeSet<u32> = dofs.iter().map(|dof| dof.node).collect();
        Ok(Self { node_of: nodes.into_iter().zip(next..).collect(), dofs })
    }

    /// Whether there are any.
    pub fn is_empty(&self) -> bool {
        self.dofs.is_empty()
    }

    /// The DOFs of an equation for which others stand in it.
    pub fn in_place_of(&self, model: &Model, equation: &Written) -> BTreeMap<Dof, Dof> {
        let all = repeated(model, equation).filter(|_| !self.is_empty());
        all.map(|dof| (dof, self.double(dof))).collect()
    }

    fn double(&self, dof: Dof) -> Dof {
        self.node_of.get(&dof.node).map_or(dof, |&node| Dof { node, ..dof })
    }

    /// New DOFs, and the ones of the deck that they are.
    pub fn renamed(&self) -> impl Iterator<Item = (Dof, Dof)> {
        self.dofs.iter().map(|&dof| (self.double(dof), dof))
    }

    /// The new nodes, at the places of the old ones.
    pub fn nodes(&self, deck: &Deck, places: &std::collections::HashMap<u32, [f64; 3]>) -> String {
        let text = |(node, double): (&u32, &u32)| {
            let [x, y, z] = places.get(node).copied().unwrap_or_default();
            let name = deck.model.node_name(*node);
            format!(
                "** qless: node {double} stands for node {name}, which has axes of its own\n{double},{x:?},{y:?},{z:?}\n"
            )
        };
        self.node_of.iter().map(text).collect()
    }

    /// `u_d - u = 0` for each.
    pub fn equations(&self) -> impl Iterator<Item = Written> {
        self.renamed().map(|(slave, dof)| Written { slave, terms: vec![(dof, -1.0)], rhs: 0.0, cases: Cases::All })
    }
}

/// The first master of an equation at each node of which it names several components; none of an equation that names the node of its slave
/// again, where ccx adds all up, and none of a node with a value along its axes, which is an equation that ccx inserts.
fn repeated<'a>(model: &'a Model, equation: &'a Written) -> impl Iterator<Item = Dof> + 'a {
    let own = model.as_global(equation.slave);
    let turned =
        || equation.terms.iter().map(|(dof, _)| (model.as_global(*dof), *dof)).filter(|(node, _)| node.component == 0);
    let mut at: BTreeMap<Dof, Vec<Dof>> = BTreeMap::new();
    if !model.turned.is_empty() {
        turned().for_each(|(node, dof)| at.entry(node).or_default().push(dof));
    }
    if at.contains_key(&own) {
        at.clear();
    }
    let is_given = |node: u32| model.cases.iter().flat_map(|case| &case.prescribed).any(|given| given.dof.node == node);
    at.into_iter().filter(move |(node, dofs)| dofs.len() > 1 && !is_given(node.node)).map(|(_, dofs)| dofs[0])
}
