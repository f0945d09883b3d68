//! Reads the command `CP`: the nodes of a coupled set have the same value in one component, `u_j - u_1 = 0` for every node j but the first.
//!
//! ```text
//! CP, NSET, Lab, NODE1, NODE2, ... NODE17
//! CP, R5.0, nodes, NSET, Lab, NODE1, ... NODE7
//! ```

use std::collections::BTreeSet;
use std::ops::RangeInclusive;

use rustc_hash::FxHashSet;

use super::numbering::{PastVersion, SearchBudget, StartsAt, StepIndex, delete, numbered, uncertain_deletion};
use crate::deck::ansys::model::nodes::AnsysNodes;
use crate::deck::ansys::model::numbered::NumberedSets;
use crate::deck::ansys::model::selection::{NodeSelection, SelectedNodes};
use crate::deck::ansys::syntax::command::AnsysCommand;
use crate::deck::ansys::syntax::field::{FieldFault, component, expected, is_nothing, signed_node, whole};
use crate::deck::{Dof, Problem};

/// One coupled set.
#[derive(Clone, Debug, Default)]
pub struct CoupledSet {
    component: u8,
    nodes: Vec<u32>,
    known: FxHashSet<u32>,
    /// The line on which the set begins.
    pub line: u32,
    /// The line that names the last node of the set.
    pub last_line: u32,
    /// The number of nodes that an archive command announces for the set.
    promised: Option<usize>,
    /// Number of nodes read, repeated ones included.
    count: usize,
    /// The first load step in which this version of the set holds.
    from: StepIndex,
}

impl StartsAt for CoupledSet {
    fn from(&self) -> StepIndex {
        self.from
    }
}

/// Limit on the nodes of all earlier versions of sets. It bounds the memory.
const PAST_NODES: usize = 20_000_000;

/// The coupled sets of a deck, each with its number.
#[derive(Debug, Default)]
pub struct CoupledSets {
    pub sets: NumberedSets<CoupledSet>,
    /// Versions of sets that held in earlier load steps and were changed or deleted since.
    pub past: Vec<PastVersion<CoupledSet>>,
    past_nodes: usize,
    /// Number of load steps solved so far.
    pub now: StepIndex,
    /// Numbers of sets that are left out because one of their commands could not be read.
    unknown: BTreeSet<u32>,
    /// Numbers of sets that `CPSGEN` has generated in an order that the manual does not tell, so that another set may have the number.
    assumed: BTreeSet<u32>,
    /// Why the last command was left out; `None` if it was not.
    pub doubt: Option<String>,
    budget: SearchBudget,
}

impl CoupledSets {
    /// Reads `CP` in plain or archive form. Returns the number of the set, or `None` if the command is left out.
    pub fn read(
        &mut self,
        command: &AnsysCommand,
        nodes: &AnsysNodes,
        selection: &NodeSelection,
    ) -> Result<Option<u32>, FieldFault> {
        if command.archive_tag().is_some() {
            return self.archive(command).map(Some);
        }
        let number = if command.is(2, "ALL") { None } else { Some(numbered(command, 1, self.highest())?) };
        let Some(number) = number.filter(|number| !self.unknown.contains(number)) else {
            self.doubt = Some(match number {
                None => {
                    self.leave_out(command);
                    "CP couples all DOFs that the elements have, which this reader does not know: left out".to_owned()
                }
                Some(number) => format!("CP {number} has a command that could not be read: the whole set is left out"),
            });
            return Ok(None);
        };
        let word = group_word(command, 3);
        let members = word.as_deref().map(|word| selection.members(word, nodes));
        if let (Some(word), Some(None)) = (&word, &members) {
            self.doubt = Some(format!("CP couples the nodes {word}, which this reader does not know: left out"));
            self.leave_out(command);
            return Ok(None);
        }
        if self.assumed.contains(&number) {
            self.doubt = Some(of_assumed("CP"));
        }
        let mut budget = self.budget;
        let set = self.open(command, number, 2)?;
        match members.flatten() {
            Some(members) => members.into_iter().for_each(|node| set.include(node)),
            None => set.add(command, 3, &mut budget)?,
        }
        self.budget = budget;
        Ok(Some(number))
    }

    /// Executes `CPDELE, NSET1, NSET2, NINC, Nsel`, which deletes coupled sets with selected nodes.
    pub fn delete(&mut self, command: &AnsysCommand, selection: &NodeSelection) -> Result<(), FieldFault> {
        if command.is(1, "ALL") && selection.nodes == SelectedNodes::All {
            self.unknown.clear();
            self.assumed.clear();
        }
        if !self.assumed.is_empty() {
            self.doubt = Some(of_assumed("CPDELE"));
        }
        let items = (&mut self.sets, &mut self.past);
        let uncertain = delete(command, selection, items, self.now, &mut self.budget, |set| set.nodes.clone())?;
        if !uncertain.is_empty() {
            self.doubt = Some(uncertain_deletion(command));
            self.unknown.extend(uncertain);
        }
        Ok(())
    }

    /// Whether a set is left out because one of its commands could not be read.
    pub fn is_left_out(&self, number: u32) -> bool {
        self.unknown.contains(&number)
    }

    /// Whether any set of these numbers is left out.
    pub fn leaves_out_any(&self, numbers: RangeInclusive<u32>) -> bool {
        self.unknown.range(numbers).next().is_some()
    }

    /// Whether the order of any sets, and so their numbers, is not known.
    pub fn assumes_order(&self) -> bool {
        !self.assumed.is_empty()
    }

    /// Records that the order of the next `count` sets is not known.
    pub fn assume_order(&mut self, count: u32) {
        let first = self.highest().saturating_add(1);
        self.assumed.extend(first..first.saturating_add(count));
    }

    /// The highest number of a set so far, also of a set that is left out; 0 if there is none.
    pub fn highest(&self) -> u32 {
        self.sets.highest().max(self.unknown.last().copied()).unwrap_or(0)
    }

    /// Leaves out a whole set because one of its commands could not be read.
    pub fn leave_out(&mut self, command: &AnsysCommand) {
        let number = match command.archive_tag() {
            Some(_) => whole(command.field(3)),
            None => numbered(command, 1, self.highest()).ok(),
        };
        if let Some(number) = number {
            self.sets.remove(number);
            self.unknown.insert(number);
        }
    }

    /// Call this before a set changes: stores its present version for the earlier load steps, if it held in any.
    fn keep(&mut self, number: u32) -> Result<(), FieldFault> {
        let now = self.now;
        let Some(set) = self.sets.get_mut(number).filter(|set| set.from < now) else { return Ok(()) };
        self.past_nodes += set.nodes.len() + 1;
        if self.past_nodes > PAST_NODES {
            let advice = "make a deck for each load step";
            let what = "the number of nodes in coupled sets of earlier load steps";
            return Err((None, Problem::Limit { what, limit: PAST_NODES, advice }));
        }
        self.past.push(PastVersion { number, last: now - 1, value: set.clone() });
        set.from = now;
        Ok(())
    }

    /// The first set with fewer nodes than its archive announces.
    pub fn incomplete(&self) -> Option<(u32, u32, Problem)> {
        self.sets.iter().find_map(|(number, set)| {
            let promised = set.promised.filter(|&promised| promised > set.count)?;
            Some((number, set.line, Problem::TooFew { what: "nodes", promised, found: set.count }))
        })
    }

    /// Reads `CP` in archive form. Every line of a set repeats the first fields and adds nodes.
    fn archive(&mut self, command: &AnsysCommand) -> Result<u32, FieldFault> {
        let promised = whole(command.field(2)).ok_or_else(|| expected(command, 2, "the number of nodes"))? as usize;
        let number = whole(command.field(3)).ok_or_else(|| expected(command, 3, "the number of the coupled set"))?;
        let mut budget = self.budget;
        let set = self.open(command, number, 4)?;
        set.promised = Some(promised);
        set.add(command, 5, &mut budget)?;
        if set.count > promised {
            return Err(expected(command, 2, "as many nodes as promised"));
        }
        self.budget = budget;
        Ok(number)
    }

    /// Returns the set of this number, and creates it if necessary. Field `at` holds the label of its component, such as `UX`. The field
    /// may be blank for an existing set.
    pub fn open(&mut self, command: &AnsysCommand, number: u32, at: usize) -> Result<&mut CoupledSet, FieldFault> {
        let known = self.sets.get_mut(number).is_some();
        let component = if known && command.field(at).is_empty() { None } else { Some(component(command, at)?) };
        self.keep(number)?;
        let new = || CoupledSet { line: command.line, from: self.now, ..CoupledSet::default() };
        let set = self.sets.get_or_insert_with(number, new);
        set.last_line = command.line;
        set.component = component.unwrap_or(set.component);
        Ok(set)
    }
}

impl CoupledSet {
    /// The equations of the set, one for each node but the first. The DOF of the first node is the second term of each equation.
    pub fn equations(&self) -> impl Iterator<Item = [(Dof, f64); 2]> + '_ {
        let dof = |node: u32| Dof { node, component: self.component };
        let first = self.nodes.first().copied().unwrap_or_default();
        self.nodes.iter().skip(1).map(move |&node| [(dof(node), 1.0), (dof(first), -1.0)])
    }

    fn add(&mut self, command: &AnsysCommand, from: usize, budget: &mut SearchBudget) -> Result<(), FieldFault> {
        for at in (from..=command.fields.len()).filter(|&at| !is_nothing(command, at)) {
            let (node, is_removed) = signed_node(command, at)?;
            if !is_removed {
                self.include(node);
                continue;
            }
            budget.spend(self.nodes.len()).map_err(|problem| (Some(at), problem))?;
            if self.known.remove(&node) {
                self.nodes.retain(|&known| known != node);
            }
        }
        Ok(())
    }

    /// Number of nodes.
    pub fn size(&self) -> usize {
        self.nodes.len()
    }

    /// The set with the numbers of all nodes higher by `increment`; `None` if one is no number of a node.
    pub fn copied(&self, increment: i64, line: u32, from: StepIndex) -> Option<Self> {
        let mut copy = Self { component: self.component, line, last_line: line, from, ..Self::default() };
        for &node in &self.nodes {
            let moved = i64::from(node).saturating_add(increment);
            copy.include(u32::try_from(moved).ok().filter(|&node| node > 0)?);
        }
        Some(copy)
    }

    #[must_use]
    pub fn with_component(self, component: u8) -> Self {
        Self { component, ..self }
    }

    /// Takes a node out of the set. Call `drop_excluded` after the last one.
    pub fn exclude(&mut self, node: u32) {
        self.known.remove(&node);
    }

    pub fn drop_excluded(&mut self) {
        self.nodes.retain(|node| self.known.contains(node));
    }

    pub fn include(&mut self, node: u32) {
        self.count += 1;
        if self.known.insert(node) {
            self.nodes.push(node);
        }
    }
}

fn of_assumed(command: &str) -> String {
    format!(
        "{command} names coupled sets by numbers that CPSGEN gives, and this reader does not know in which order: left out"
    )
}

/// The word that field `at` holds in place of a node: `ALL`, `P` or the name of a component.
fn group_word(command: &AnsysCommand, at: usize) -> Option<String> {
    let text = command.field(at);
    let starts = text.first().is_some_and(u8::is_ascii_alphabetic);
    starts.then(|| String::from_utf8_lossy(&text[..text.len().min(32)]).into_owned())
}
