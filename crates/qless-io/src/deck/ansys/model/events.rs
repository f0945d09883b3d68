//! What is prescribed and loaded, in the order of the deck, and the load cases that come of it.

use std::collections::BTreeMap;
use std::ops::Range;

use super::nodes::AnsysNodes;
use crate::deck::{Dof, Load, LoadCase, Model, Origin, Prescribed, Problem};

/// Values that all commands stand for at most: bounds the time.
const VALUES: usize = 50_000_000;
/// Values and loads that all load cases hold at most: bounds the memory.
const HELD: usize = 20_000_000;

/// Which nodes a command means.
#[derive(Clone, Debug)]
pub enum NodeChoice {
    /// First, last and step.
    Range(u32, u32, u32),
    /// Every node.
    All,
    /// Those of a named group.
    Group(Box<str>),
    /// Those selected.
    Ranges(Box<[(u32, u32, u32)]>),
}

/// Which components of them, filled up with zeros; all if there are none.
pub type ComponentList = [u8; 6];

/// What a command does.
#[derive(Clone, Debug)]
pub enum EventAction {
    /// `D`: a value that replaces an earlier one, times a table where one is named.
    Prescribe(f64, Option<Box<str>>),
    /// `DDELE`.
    Release,
    /// `F`.
    Load,
    /// `FDELE`.
    Unload,
    /// `SOLVE` or `LSWRITE`: a load case.
    Solve,
}

/// One command.
#[derive(Clone, Debug)]
pub struct ValueEvent {
    pub action: EventAction,
    pub which: NodeChoice,
    pub components: ComponentList,
    pub origin: Origin,
}

impl ValueEvent {
    fn is_of_all(&self) -> bool {
        self.components[0] == 0
    }

    fn named(&self) -> &[u8] {
        let count = self.components.iter().take_while(|component| **component != 0).count();
        &self.components[..count]
    }
}

/// An equation of the model that is not in force in all load steps: from the first to the last of these.
#[derive(Clone, Copy, Debug)]
pub struct EquationLife {
    pub equation: u32,
    pub first: u32,
    pub last: u32,
}

/// The load cases: one for each `SOLVE`, and one of what follows the last.
pub fn cases(
    events: &[ValueEvent],
    nodes: &AnsysNodes,
    lives: &[EquationLife],
    model: &mut Model,
) -> Result<(), (Origin, Problem)> {
    let are_solutions = events.iter().all(|event| matches!(event.action, EventAction::Solve));
    let mut replay = if are_solutions { EventReplay::without_nodes(nodes) } else { EventReplay::new(nodes, model) };
    replay.lives = lives;
    for event in events {
        let course = match &event.action {
            EventAction::Prescribe(_, Some(table)) => model.history(table),
            _ => 0,
        };
        replay.event(event, course).map_err(|problem| (event.origin, problem))?;
    }
    let solved = replay.cases.len() as u32;
    let changes = |life: &EquationLife| life.first == solved || life.last.checked_add(1) == Some(solved);
    let open =
        !matches!(events.last(), Some(ValueEvent { action: EventAction::Solve, .. })) || lives.iter().any(changes);
    if open {
        replay.solve();
    }
    model.cases = replay.cases;
    Ok(())
}

struct EventReplay<'a> {
    groups: &'a AnsysNodes,
    lives: &'a [EquationLife],
    /// Numbers of all nodes, ascending.
    nodes: Vec<u32>,
    /// Components that occur in equations, ascending.
    components: Vec<u8>,
    prescribed: BTreeMap<Dof, Prescribed>,
    loads: BTreeMap<Dof, Load>,
    cases: Vec<LoadCase>,
    left: usize,
    /// Values and loads of the load cases so far.
    held: usize,
}

impl<'a> EventReplay<'a> {
    fn new(groups: &'a AnsysNodes, model: &Model) -> Self {
        let in_equations = model.dofs.iter().map(|dof| dof.node);
        let mut nodes: Vec<u32> = groups.numbers.iter().copied().chain(in_equations).collect();
        let mut occurs = [false; 256];
        model.dofs.iter().for_each(|dof| occurs[usize::from(dof.component)] = true);
        let components = (0..=u8::MAX).filter(|&component| occurs[usize::from(component)]).collect();
        nodes.sort_unstable();
        nodes.dedup();
        Self { nodes, components, ..Self::without_nodes(groups) }
    }

    /// Enough where no command names a node.
    fn without_nodes(groups: &'a AnsysNodes) -> Self {
        let (prescribed, loads) = (BTreeMap::new(), BTreeMap::new());
        let (nodes, components, cases) = (Vec::new(), Vec::new(), Vec::new());
        Self { groups, lives: &[], nodes, components, prescribed, loads, cases, left: VALUES, held: 0 }
    }

    fn event(&mut self, event: &ValueEvent, course: u32) -> Result<(), Problem> {
        if matches!(event.action, EventAction::Solve) {
            self.solve();
            return self.check_held();
        }
        let all = event.is_of_all().then(|| self.components.clone());
        let components = all.as_deref().unwrap_or_else(|| event.named());
        for (first, last, step) in self.ranges(&event.which) {
            let nodes = self.members(first, last);
            self.spend(nodes.len().saturating_mul(components.len()).saturating_add(1))?;
            for at in nodes {
                let node = self.nodes[at];
                if (node - first).is_multiple_of(step) {
                    self.node(event, course, node, components);
                }
            }
            // A node that neither the deck nor an equation knows matters to nobody but the one who named it.
            if first == last && self.nodes.binary_search(&first).is_err() {
                self.node(event, course, first, components);
            }
            self.check_held()?;
        }
        Ok(())
    }

    fn check_held(&self) -> Result<(), Problem> {
        if self.held + self.prescribed.len() + self.loads.len() <= HELD {
            return Ok(());
        }
        let advice = "make a deck of each load step, or prescribe fewer nodes";
        Err(Problem::Limit { what: "the number of values in all load steps", limit: HELD, advice })
    }

    fn ranges(&self, which: &NodeChoice) -> Vec<(u32, u32, u32)> {
        match which {
            NodeChoice::Range(first, last, step) => vec![(*first, *last, *step)],
            NodeChoice::All => vec![(1, u32::MAX, 1)],
            NodeChoice::Ranges(ranges) => ranges.to_vec(),
            NodeChoice::Group(name) => {
                let ranges = self.groups.groups.get(&**name).map_or(&[][..], Vec::as_slice);
                ranges.iter().map(|&(first, last)| (first, last, 1)).collect()
            }
        }
    }

    /// Places of the nodes between two numbers.
    fn members(&self, first: u32, last: u32) -> Range<usize> {
        self.nodes.partition_point(|&node| node < first)..self.nodes.partition_point(|&node| node <= last)
    }

    fn spend(&mut self, values: usize) -> Result<(), Problem> {
        let limit =
            Problem::Limit { what: "the number of values", limit: VALUES, advice: "name fewer nodes at a time" };
        self.left = self.left.checked_sub(values).ok_or(limit)?;
        Ok(())
    }

    fn node(&mut self, event: &ValueEvent, course: u32, node: u32, components: &[u8]) {
        let origin = event.origin;
        let dofs = components.iter().map(|&component| Dof { node, component });
        match event.action {
            EventAction::Prescribe(value, _) => {
                self.prescribed.extend(dofs.map(|dof| (dof, Prescribed { dof, value, history: course, origin })));
            }
            EventAction::Load => self.loads.extend(dofs.map(|dof| (dof, Load { dof, origin }))),
            EventAction::Release => take(&mut self.prescribed, event, node, components),
            EventAction::Unload => take(&mut self.loads, event, node, components),
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

/// Takes away what is said of components of a node, or all of it.
fn take<T>(said: &mut BTreeMap<Dof, T>, event: &ValueEvent, node: u32, components: &[u8]) {
    let dofs: Vec<Dof> = if event.is_of_all() {
        said.range(Dof { node, component: 0 }..=Dof { node, component: u8::MAX }).map(|(dof, _)| *dof).collect()
    } else {
        components.iter().map(|&component| Dof { node, component }).collect()
    };
    for dof in dofs {
        said.remove(&dof);
    }
}
