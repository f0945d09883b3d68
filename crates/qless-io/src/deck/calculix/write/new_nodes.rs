//! Makes new nodes for DOFs that equations cannot name otherwise.
//!
//! - [`RotationNodes`]: the solver makes a rotation `w` for the reference node of a body. For a `*KINEMATIC` coupling it
//!   is components 4 to 6 of that node; for a `*RIGID BODY`, no card can name it. A new node at the same position gets
//!   `w` as its components 1 to 3, like a `ROT NODE`.
//! - [`ProxyNodes`]: an equation that names two components of a node with local axes names the same global DOFs twice.
//!   ccx adds these up only when it substitutes another equation into this one. One of the components is therefore
//!   written as that of a new node d, with the equation `u_d - u = 0` for ccx to substitute.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use rustc_hash::FxHashSet;

use crate::deck::calculix::{definitions, positions};
use crate::deck::plan::{Cases, CleanError, Plan, Written};
use crate::deck::{Deck, Dof, Model, Origin};

/// All new nodes of a cleaned deck.
pub struct NewNodes {
    pub rotations: RotationNodes,
    pub proxies: ProxyNodes,
}

impl NewNodes {
    pub fn build(deck: &Deck, plan: &Plan) -> Result<Self, CleanError> {
        let rotations = RotationNodes::build(deck, plan)?;
        let proxies = ProxyNodes::build(deck, &plan.written, rotations.count())?;
        Ok(Self { rotations, proxies })
    }

    /// The `*NODE` card that defines the new nodes; empty if there are none.
    pub fn nodes(&self, deck: &Deck) -> String {
        if self.rotations.count() == 0 && self.proxies.is_empty() {
            return String::new();
        }
        let places = positions(deck);
        "*NODE\n".to_owned() + &self.rotations.nodes(&places) + &self.proxies.nodes(deck, &places)
    }
}

/// The new nodes that carry the rotations of bodies which equations replace. The key is the first of the rotation's three components.
pub struct RotationNodes {
    node_of: BTreeMap<Dof, u32>,
}

impl RotationNodes {
    /// Finds the rotations of the bodies that a plan replaces.
    pub fn build(deck: &Deck, plan: &Plan) -> Result<Self, CleanError> {
        let model = &deck.model;
        let gone: FxHashSet<usize> = plan.removed.iter().map(|removed| removed.equation).collect();
        let turns = |i: usize| {
            let nodes = model.nth(i).columns.iter().map(|&j| model.dofs[j as usize]);
            nodes.filter_map(|dof| own_rotation(model, dof)).collect::<BTreeSet<Dof>>()
        };
        let (mut taken, mut stays) = (BTreeSet::new(), BTreeSet::new());
        for i in (0..model.equations()).filter(|_| !model.own_rotations.is_empty()) {
            if gone.contains(&i) { taken.append(&mut turns(i)) } else { stays.append(&mut turns(i)) }
        }
        if let Some(Dof { node, .. }) = taken.intersection(&stays).next() {
            return Err(refused(
                deck,
                format!("node {node} is the reference of several bodies, not all of which become equations"),
            ));
        }
        if let Some(first) = taken.iter().next().filter(|_| model.has_instances()) {
            let place = model.node_name(first.node);
            return Err(refused(
                deck,
                format!("the body of {place} would need a new node in the assembly: give it one, or change the body"),
            ));
        }
        let next = if taken.is_empty() { 0 } else { unused_node(deck)? };
        Ok(Self { node_of: taken.into_iter().zip(next..).collect() })
    }

    /// The DOF that the text names in place of `dof`: one of a new node, or `dof` itself.
    pub fn name(&self, dof: Dof) -> Dof {
        let own =
            self.node_of.range(Dof { component: 0, ..dof }..=dof).next_back().filter(|(first, _)| is_of(dof, **first));
        own.map_or(dof, |(first, &node)| Dof { node, component: dof.component - first.component + 1 })
    }

    /// Number of new nodes for rotations.
    pub fn count(&self) -> u32 {
        self.node_of.len() as u32
    }

    /// The lines that define the new nodes, at the positions `places` of the nodes of the deck.
    pub fn nodes(&self, places: &HashMap<u32, [f64; 3]>) -> String {
        let node = |(Dof { node: reference, .. }, node): (&Dof, &u32)| {
            let [x, y, z] = places.get(reference).copied().unwrap_or_default();
            format!("** qless: node {node} has the rotation of node {reference}\n{node},{x:?},{y:?},{z:?}\n")
        };
        self.node_of.iter().map(node).collect()
    }

    /// Each new DOF, with the DOF of the deck that it replaces.
    pub fn renamed(&self) -> impl Iterator<Item = (Dof, Dof)> {
        let dofs = |(&first, &node): (&Dof, &u32)| {
            (0..3).map(move |k| (Dof { node, component: k + 1 }, Dof { component: first.component + k, ..first }))
        };
        self.node_of.iter().flat_map(dofs)
    }

    /// The lines that prescribe or load a rotation which now belongs to a new node. For each file and line: the text that replaces the
    /// line.
    pub fn lines(&self, deck: &Deck) -> Result<BTreeMap<(u32, u32), String>, CleanError> {
        let model = &deck.model;
        let prescribed = model.cases.iter().flat_map(|case| case.prescribed.iter().chain(&case.clashes));
        let loads = model.cases.iter().flat_map(|case| &case.loads).map(|load| (load.dof, load.origin));
        let mut lines = BTreeMap::new();
        for (dof, origin) in prescribed.map(|given| (given.dof, given.origin)).chain(loads) {
            if self.name(dof) != dof {
                let file = model.cards.nth(origin.card).file;
                lines.insert((file, origin.line), self.line(deck, origin)?);
            }
        }
        Ok(lines)
    }

    /// Rewrites a line `node, first, last, rest`, or `node, component, rest` of a load. Rotations move to their new node.
    fn line(&self, deck: &Deck, origin: Origin) -> Result<String, CleanError> {
        let card = deck.model.cards.nth(origin.card);
        let text = &deck.texts[card.file as usize];
        let line = text.split(|&byte| byte == b'\n').nth(origin.line as usize - 1).unwrap_or_default();
        let line = String::from_utf8_lossy(line).trim().to_owned();
        let fields: Vec<&str> = line.split(',').map(str::trim).collect();
        let whole = |k: usize| fields.get(k).and_then(|field| field.parse::<u32>().ok());
        let is_load = card.name == "*CLOAD";
        let (Some(node), Some(first)) = (whole(0), whole(1)) else {
            return Err(refused(
                deck,
                format!("line {} names rotations of a body by a set or a word: name nodes and components", origin.line),
            ));
        };
        let last = if is_load { first } else { whole(2).unwrap_or(first).max(first) };
        let rest =
            fields.iter().skip(if is_load { 2 } else { 3 }).fold(String::new(), |rest, field| rest + "," + field);
        let part = |node: u32, first: u32, last: u32| match (first <= last, is_load) {
            (false, _) => String::new(),
            (true, true) => format!("{node},{first}{rest}\n"),
            (true, false) => format!("{node},{first},{last}{rest}\n"),
        };
        let rotation = self.node_of.get(&Dof { node, component: 4 }).copied().unwrap_or(node);
        Ok(part(node, first, last.min(3)) + &part(rotation, first.max(4) - 3, last.max(3) - 3))
    }
}

/// New nodes that stand for nodes with local axes, and the DOFs for which they stand.
#[derive(Default)]
pub struct ProxyNodes {
    node_of: BTreeMap<u32, u32>,
    dofs: BTreeSet<Dof>,
}

impl ProxyNodes {
    /// Finds the DOFs that need a proxy node. The first `taken` new node numbers already belong to rotation nodes.
    pub fn build(deck: &Deck, written: &[Written], taken: u32) -> Result<Self, CleanError> {
        let dofs: BTreeSet<Dof> = written.iter().flat_map(|equation| repeated(&deck.model, equation)).collect();
        let Some(first) = dofs.iter().next() else { return Ok(Self::default()) };
        if deck.model.has_instances() {
            let name = deck.model.node_name(first.node);
            let why = format!(
                "equations with several components of {name}, which has local axes, need a new node in the assembly"
            );
            return Err(refused(deck, why));
        }
        let next = unused_node(deck)?.saturating_add(taken);
        let nodes: BTreeSet<u32> = dofs.iter().map(|dof| dof.node).collect();
        Ok(Self { node_of: nodes.into_iter().zip(next..).collect(), dofs })
    }

    /// Whether no proxies are needed.
    pub fn is_empty(&self) -> bool {
        self.dofs.is_empty()
    }

    /// The DOFs of an equation that proxies replace, each with its proxy.
    pub fn in_place_of(&self, model: &Model, equation: &Written) -> BTreeMap<Dof, Dof> {
        let all = repeated(model, equation).filter(|_| !self.is_empty());
        all.map(|dof| (dof, self.proxy(dof))).collect()
    }

    fn proxy(&self, dof: Dof) -> Dof {
        self.node_of.get(&dof.node).map_or(dof, |&node| Dof { node, ..dof })
    }

    /// Each new DOF, with the DOF of the deck for which it stands.
    pub fn renamed(&self) -> impl Iterator<Item = (Dof, Dof)> {
        self.dofs.iter().map(|&dof| (self.proxy(dof), dof))
    }

    /// The lines that define the proxy nodes, at the positions `places` of the nodes for which they stand.
    pub fn nodes(&self, deck: &Deck, places: &HashMap<u32, [f64; 3]>) -> String {
        let text = |(node, proxy): (&u32, &u32)| {
            let [x, y, z] = places.get(node).copied().unwrap_or_default();
            let name = deck.model.node_name(*node);
            format!("** qless: node {proxy} stands for node {name}, which has local axes\n{proxy},{x:?},{y:?},{z:?}\n")
        };
        self.node_of.iter().map(text).collect()
    }

    /// The equations `u_d - u = 0`, where u_d is a DOF of a proxy node and u the DOF for which it stands.
    pub fn equations(&self) -> impl Iterator<Item = Written> {
        self.renamed().map(|(slave, dof)| Written { slave, terms: vec![(dof, -1.0)], rhs: 0.0, cases: Cases::All })
    }
}

/// The masters that need a proxy: the first one at each node with local axes at which the equation has several masters. Skips equations
/// with a master at the node of their slave, because ccx then adds up all terms. Skips nodes with a prescribed value along their axes,
/// because ccx substitutes that value as an equation.
fn repeated<'a>(model: &'a Model, equation: &'a Written) -> impl Iterator<Item = Dof> + 'a {
    let own = model.as_global(equation.slave);
    let at_local_axes =
        || equation.terms.iter().map(|(dof, _)| (model.as_global(*dof), *dof)).filter(|(node, _)| node.component == 0);
    let mut at: BTreeMap<Dof, Vec<Dof>> = BTreeMap::new();
    if !model.nodes_with_axes.is_empty() {
        at_local_axes().for_each(|(node, dof)| at.entry(node).or_default().push(dof));
    }
    if at.contains_key(&own) {
        at.clear();
    }
    let is_given = |node: u32| model.cases.iter().flat_map(|case| &case.prescribed).any(|given| given.dof.node == node);
    at.into_iter().filter(move |(node, dofs)| dofs.len() > 1 && !is_given(node.node)).map(|(_, dofs)| dofs[0])
}

/// The first component of the rotation that a DOF belongs to; `None` unless the solver makes that rotation.
fn own_rotation(model: &Model, dof: Dof) -> Option<Dof> {
    let node = Dof { component: 0, ..dof }..=dof;
    model.own_rotations.range(node).next_back().copied().filter(|first| is_of(dof, *first))
}

fn is_of(dof: Dof, first: Dof) -> bool {
    (first.component..first.component + 3).contains(&dof.component)
}

fn refused(deck: &Deck, why: String) -> CleanError {
    CleanError::Fixed { place: deck.model.files[0].display().to_string(), why }
}

/// The node number after the highest one that the deck uses.
fn unused_node(deck: &Deck) -> Result<u32, CleanError> {
    let listed = definitions(deck)?.node_numbers().last().copied().unwrap_or(0);
    let used = deck.model.dofs.iter().map(|dof| dof.node).max().unwrap_or(0);
    Ok(listed.max(used).saturating_add(1))
}
