//! Keeps the selected nodes and DOFs, as far as this reader follows selections: by number and by component name.
//!
//! ```text
//! NSEL,  Type, Item, Comp, VMIN, VMAX, VINC
//! CMSEL, Type, Name
//! ```

use std::collections::BTreeSet;
use std::sync::Arc;

use super::nodes::{AnsysNodes, group_name};
use crate::deck::ansys::syntax::command::AnsysCommand;
use crate::deck::ansys::syntax::field::{is_nothing, whole};

/// Limit on the ranges of a selection. A selection with more ranges counts as unknown.
const RANGES: usize = 1000;
/// Limit on the nodes of a deck: if there are more, the selected nodes are not listed and count as unknown.
const MEMBERS: usize = 5_000_000;

/// First node, last node and step.
pub type NodeRange = (u32, u32, u32);

/// The selected nodes.
#[derive(Clone, Debug, PartialEq)]
pub enum SelectedNodes {
    All,
    Ranges(Vec<NodeRange>),
    Unknown,
}

/// The selected nodes and DOFs.
#[derive(Clone, Debug)]
pub struct NodeSelection {
    pub nodes: SelectedNodes,
    /// Whether all DOFs are selected.
    pub dofs: bool,
}

impl Default for NodeSelection {
    fn default() -> Self {
        Self { nodes: SelectedNodes::All, dofs: true }
    }
}

impl NodeSelection {
    /// Executes `NSEL`, which selects nodes.
    pub fn nodes_by(&mut self, command: &AnsysCommand) {
        let by_number = (command.is(2, "NODE") || command.field(2).is_empty()) && command.field(3).is_empty();
        let first = whole(command.field(4));
        let or = |at: usize, default| if is_nothing(command, at) { Some(default) } else { whole(command.field(at)) };
        let range = first.filter(|_| by_number).and_then(|first| Some((first, or(5, first)?.max(first), or(6, 1)?)));
        match command.field(1).to_ascii_uppercase().as_slice() {
            b"ALL" => self.nodes = SelectedNodes::All,
            b"S" | b"A" | b"" if by_number && command.is(4, "ALL") => self.nodes = SelectedNodes::All,
            b"R" if by_number && command.is(4, "ALL") => {}
            b"NONE" => self.nodes = SelectedNodes::Ranges(Vec::new()),
            b"STAT" => {}
            kind => self.select(kind, range.map(|range| vec![range])),
        }
    }

    /// Executes `CMSEL`, which selects the nodes of a group. For a group of other entities the selected nodes do not change.
    pub fn components_by(&mut self, command: &AnsysCommand, nodes: &AnsysNodes) {
        if nodes.other_groups.contains(&group_name(command.field(2))) {
            return;
        }
        if command.is(1, "ALL") && nodes.unknown_groups.is_empty() {
            let all =
                nodes.groups.values().flat_map(|group| group.iter()).map(|&(first, last)| (first, last, 1)).collect();
            return self.select(b"A", Some(all));
        }
        let group = nodes.groups.get(&group_name(command.field(2)));
        let ranges = group.filter(|group| group.len() <= RANGES);
        let ranges = ranges.map(|group| group.iter().map(|&(first, last)| (first, last, 1)).collect());
        self.select(&command.field(1).to_ascii_uppercase(), ranges);
    }

    /// Executes `CM, Cname, Entity`, which gives the selected nodes, or other selected entities, a group name. The members of a group of
    /// nodes are known only if the selection is a list of ranges without gaps.
    pub fn name_group(&self, command: &AnsysCommand, nodes: &mut AnsysNodes) {
        let name = group_name(command.field(1));
        if !command.is(2, "NODE") {
            nodes.groups.remove(&name);
            nodes.unknown_groups.remove(&name);
            nodes.other_groups.insert(name);
            return;
        }
        nodes.other_groups.remove(&name);
        if let SelectedNodes::Ranges(ranges) = &self.nodes
            && ranges.iter().all(|&(first, last, step)| step == 1 || first == last)
        {
            nodes.unknown_groups.remove(&name);
            nodes.groups.insert(name, Arc::new(ranges.iter().map(|&(first, last, _)| (first, last)).collect()));
            return;
        }
        nodes.groups.remove(&name);
        nodes.unknown_groups.insert(name);
    }

    /// The selected nodes for the word `ALL`, else the nodes of the group with this name; ascending. `None` if they are unknown.
    pub fn members(&self, word: &str, nodes: &AnsysNodes) -> Option<BTreeSet<u32>> {
        let ranges = match (word.to_ascii_uppercase().as_str(), &self.nodes) {
            ("ALL", SelectedNodes::All) => vec![(1, u32::MAX, 1)],
            ("ALL", SelectedNodes::Ranges(ranges)) => ranges.clone(),
            ("ALL", SelectedNodes::Unknown) => return None,
            (group, _) => nodes.groups.get(group)?.iter().map(|&(first, last)| (first, last, 1)).collect(),
        };
        if nodes.are_generated || nodes.numbers.is_empty() || nodes.numbers.len() > MEMBERS {
            return None;
        }
        let is_in =
            |node: &u32| ranges.iter().any(|&(a, b, step)| (a..=b).contains(node) && (node - a).is_multiple_of(step));
        if ranges.len().saturating_mul(nodes.numbers.len()) > 10 * MEMBERS {
            return None;
        }
        Some(nodes.numbers.iter().copied().filter(is_in).collect())
    }

    /// Selects a node that a command defines, or nodes that are not known: ANSYS selects what it creates.
    pub fn define(&mut self, node: Option<u32>) {
        if let SelectedNodes::Ranges(_) = self.nodes {
            self.select(b"A", node.map(|node| vec![(node, node, 1)]));
        }
    }

    /// Whether any of these nodes is selected; `None` if this is not known. With `all`, the manual asks that all selected nodes be among these,
    /// which depends on nodes that are defined elsewhere: it is certain only if these nodes are the selected ones.
    pub fn holds(&self, nodes: &[u32], all: bool) -> Option<bool> {
        let SelectedNodes::Ranges(ranges) = &self.nodes else {
            return (self.nodes == SelectedNodes::All && !all).then_some(true);
        };
        let is_in =
            |node: &u32| ranges.iter().any(|&(a, b, step)| (a..=b).contains(node) && (node - a).is_multiple_of(step));
        if !all {
            return Some(nodes.iter().any(is_in));
        }
        let mut selected = ranges.iter().flat_map(|&(a, b, step)| (a..=b).step_by(step.max(1) as usize));
        (nodes.iter().all(is_in) && selected.all(|node| nodes.contains(&node))).then_some(true)
    }

    fn select(&mut self, kind: &[u8], ranges: Option<Vec<NodeRange>>) {
        let before = std::mem::replace(&mut self.nodes, SelectedNodes::Unknown);
        self.nodes = match (kind, before, ranges) {
            (b"S" | b"", _, Some(new)) | (b"R", SelectedNodes::All, Some(new)) => SelectedNodes::Ranges(new),
            (b"A", SelectedNodes::All, _) => SelectedNodes::All,
            (b"A", SelectedNodes::Ranges(mut old), Some(new)) if old.len() + new.len() <= RANGES => {
                old.extend(new);
                SelectedNodes::Ranges(old)
            }
            _ => SelectedNodes::Unknown,
        };
    }
}
