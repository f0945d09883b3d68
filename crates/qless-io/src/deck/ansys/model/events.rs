//! Commands that prescribe or load DOFs, in the order of the deck, and the load cases that they define.

use std::collections::BTreeMap;
use std::ops::Range;

use super::nodes::{AnsysNodes, NodeGroup};
use crate::deck::limits::{HELD, VALUES};
use crate::deck::{Dof, Load, LoadCase, Model, Origin, Prescribed, Problem};

/// The nodes to which a command applies.
#[derive(Clone, Debug, PartialEq)]
pub enum NodeChoice {
    /// First node, last node and step.
    Range(u32, u32, u32),
    /// Every node of the model.
    All,
    /// The nodes that a named group has at the command.
    Group(NodeGroup),
    /// The selected nodes, as ranges of first node, last node and step.
    Ranges(Box<[(u32, u32, u32)]>),
}

impl NodeChoice {
    fn ranges(&self) -> Vec<(u32, u32, u32)> {
        match self {
            Self::Range(first, last, step) => vec![(*first, *last, *step)],
            Self::All => vec![(1, u32::MAX, 1)],
            Self::Ranges(ranges) => ranges.to_vec(),
            Self::Group(group) => group.iter().map(|&(first, last)| (first, last, 1)).collect(),
        }
    }
}

/// The components to which a command applies, followed by zeros. If all six are zero, it applies to all components.
pub type ComponentList = [u8; 6];

/// The effect of a command on DOFs.
#[derive(Clone, Debug, PartialEq)]
pub enum EventAction {
    /// `D` prescribes a value, which replaces an earlier one. If a table is named, it multiplies the value.
    Prescribe(f64, Option<Box<str>>),
    /// `DDELE` releases prescribed DOFs.
    Release,
    /// `F` loads DOFs.
    Load,
    /// `FDELE` removes loads.
    Unload,
    /// `SOLVE` or `LSWRITE`: ends a load case.
    Solve,
}

/// One command that prescribes, loads or solves.
#[derive(Clone, Debug)]
pub struct ValueEvent {
    pub action: EventAction,
    pub nodes: NodeChoice,
    pub components: ComponentList,
    /// Number of definitions of nodes before the command, which does not reach nodes that are defined later.
    pub defined: usize,
    pub origin: Origin,
}

impl ValueEvent {
    /// Whether another command has the same effect. The places of the commands in the deck are not compared.
    pub fn acts_as(&self, other: &Self) -> bool {
        self.action == other.action && self.nodes == other.nodes && self.components == other.components
    }

    fn has_all_components(&self) -> bool {
        self.components[0] == 0
    }
}

/// An equation that holds only in load steps `first..=last`.
#[derive(Clone, Copy, Debug)]
pub struct EquationLife {
    pub equation: u32,
    pub first: u32,
    pub last: u32,
}

/// Adds the load cases to the model: one for each `SOLVE`, and one more if anything changes after the last `SOLVE`. `others` are
/// DOFs that the model has although no equation names them.
pub fn cases(
    events: &[ValueEvent],
    nodes: &AnsysNodes,
    others: &[Dof],
    lives: &[EquationLife],
    model: &mut Model,
) -> Result<(), (Origin, Problem)> {
    let are_solutions = events.iter().all(|event| matches!(event.action, EventAction::Solve));
    let mut replay =
        if are_solutions { EventReplay::without_nodes() } else { EventReplay::new(nodes, events, others, model) };
    replay.lives = lives;
    for event in events {
        let history = match &event.action {
            EventAction::Prescribe(_, Some(table)) => model.history(table),
            _ => 0,
        };
        replay.event(event, history).map_err(|problem| (event.origin, problem))?;
    }
    let solved = replay.cases.len() as u32;
    let changes = |life: &EquationLife| life.first == solved || life.last.checked_add(1) == Some(solved);
    let ends_solved = matches!(events.last(), Some(ValueEvent { action: EventAction::Solve, .. }));
    if !ends_solved || lives.iter().any(changes) {
        replay.solve();
    }
    model.cases = replay.cases;
    Ok(())
}

struct EventReplay<'a> {
    lives: &'a [EquationLife],
    /// Numbers of all nodes of the model, ascending.
    nodes: Vec<u32>,
    /// For each of `nodes`, the number of definitions up to its first; 0 if no command defines it. Empty if no node is defined after an event.
    born: Vec<usize>,
    /// Components that occur in the model, ascending.
    components: Vec<u8>,
    prescribed: BTreeMap<Dof, Prescribed>,
    loads: BTreeMap<Dof, Load>,
    cases: Vec<LoadCase>,
    /// How many more values the commands may set; this bounds the time.
    budget: usize,
    /// Number of values, loads and removed equations in all load cases so far, plus one for each case; this bounds the memory.
    held: usize,
}

impl EventReplay<'_> {
    fn new(defined: &AnsysNodes, events: &[ValueEvent], others: &[Dof], model: &Model) -> Self {
        let dofs = || model.dofs.iter().chain(others);
        let mut nodes: Vec<u32> = defined.numbers.iter().copied().chain(dofs().map(|dof| dof.node)).collect();
        let mut occurs = [false; 256];
        dofs().for_each(|dof| occurs[usize::from(dof.component)] = true);
        let components = (0..=u8::MAX).filter(|&component| occurs[usize::from(component)]).collect();
        nodes.sort_unstable();
        nodes.dedup();
        let mut born = Vec::new();
        if events.iter().any(|event| event.defined < defined.numbers.len()) {
            born.resize(nodes.len(), 0);
            for (at, number) in defined.numbers.iter().enumerate().rev() {
                born[nodes.partition_point(|node| node < number)] = at + 1;
            }
        }
        Self { nodes, born, components, ..Self::without_nodes() }
    }

    /// Makes a replay for a deck in which no command acts on DOFs. Such a replay needs no list of nodes.
    fn without_nodes() -> Self {
        let (prescribed, loads) = (BTreeMap::new(), BTreeMap::new());
        let (nodes, born, components, cases) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        Self { lives: &[], nodes, born, components, prescribed, loads, cases, budget: VALUES, held: 0 }
    }

    fn event(&mut self, event: &ValueEvent, history: u32) -> Result<(), Problem> {
        if matches!(event.action, EventAction::Solve) {
            self.solve();
            return self.check_held();
        }
        let all = event.has_all_components().then(|| self.components.clone());
        let listed = event.components.iter().take_while(|component| **component != 0).count();
        let components = all.as_deref().unwrap_or(&event.components[..listed]);
        for (first, last, step) in event.nodes.ranges() {
            let nodes = self.members(first, last);
            self.spend(nodes.len().saturating_mul(components.len()).saturating_add(1))?;
            for at in nodes {
                let node = self.nodes[at];
                let is_later = self.born.get(at).is_some_and(|born| *born > event.defined);
                if (node - first).is_multiple_of(step) && !(is_later && first != last) {
                    self.node(event, history, node, components);
                }
            }
            // A command for a single node applies even if neither the deck nor an equation defines this node.
            if first == last && self.nodes.binary_search(&first).is_err() {
                self.node(event, history, first, components);
            }
            self.check_held()?;
        }
        Ok(())
    }

    fn check_held(&self) -> Result<(), Problem> {
        if self.held + self.prescribed.len() + self.loads.len() <= HELD {
            return Ok(());
        }
        let advice = "make a deck for each load step, or prescribe fewer nodes";
        Err(Problem::Limit { what: "the number of values in all load steps", limit: HELD, advice })
    }

    /// Indices of the nodes whose numbers lie between `first` and `last`.
    fn members(&self, first: u32, last: u32) -> Range<usize> {
        self.nodes.partition_point(|&node| node < first)..self.nodes.partition_point(|&node| node <= last)
    }

    fn spend(&mut self, values: usize) -> Result<(), Problem> {
        let limit =
            Problem::Limit { what: "the number of values", limit: VALUES, advice: "name fewer nodes at a time" };
        self.budget = self.budget.checked_sub(values).ok_or(limit)?;
        Ok(())
    }

    fn node(&mut self, event: &ValueEvent, history: u32, node: u32, components: &[u8]) {
        let origin = event.origin;
        let dofs = components.iter().map(|&component| Dof { node, component });
        match event.action {
            EventAction::Prescribe(value, _) => {
                self.prescribed.extend(dofs.map(|dof| (dof, Prescribed { dof, value, history, origin })));
            }
            EventAction::Load => self.loads.extend(dofs.map(|dof| (dof, Load { dof, origin }))),
            EventAction::Release => remove(&mut self.prescribed, event, node, components),
            EventAction::Unload => remove(&mut self.loads, event, node, components),
            EventAction::Solve => {}
        }
    }

    fn solve(&mut self) {
        let now = self.cases.len() as u32;
        let is_out = |life: &&EquationLife| !(life.first..=life.last).contains(&now);
        let removed: Vec<u32> = self.lives.iter().filter(is_out).map(|life| life.equation).collect();
        self.held += self.prescribed.len() + self.loads.len() + removed.len() + 1;
        self.cases.push(LoadCase {
            name: format!("load step {}", self.cases.len() + 1),
            prescribed: self.prescribed.values().copied().collect(),
            loads: self.loads.values().copied().collect(),
            removed,
            ..LoadCase::default()
        });
    }
}

/// Removes the entries of a node: those of `components`, or of all components if the command applies to all.
fn remove<T>(entries: &mut BTreeMap<Dof, T>, event: &ValueEvent, node: u32, components: &[u8]) {
    let dofs: Vec<Dof> = if event.has_all_components() {
        entries.range(Dof { node, component: 0 }..=Dof { node, component: u8::MAX }).map(|(dof, _)| *dof).collect()
    } else {
        components.iter().map(|&component| Dof { node, component }).collect()
    };
    for dof in dofs {
        entries.remove(&dof);
    }
}
