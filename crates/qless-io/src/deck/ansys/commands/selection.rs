//! Which nodes and DOFs are selected, as far as it is followed: by number and by component.
//!
//! ```text
//! NSEL,  Type, Item, Comp, VMIN, VMAX, VINC
//! CMSEL, Type, Name
//! ```

use std::collections::BTreeSet;

use crate::deck::ansys::model::nodes::{Nodes, name};
use crate::deck::ansys::syntax::command::Command;
use crate::deck::ansys::syntax::field::{is_nothing, whole};

/// Ranges of a selection at most; what takes more is not followed.
const RANGES: usize = 1000;
/// Nodes that all commands together name by their selection at most.
const MEMBERS: usize = 5_000_000;

/// First, last and step.
pub type Range = (u32, u32, u32);

/// Which nodes are selected.
#[derive(Clone, Debug, PartialEq)]
pub enum Selected {
    All,
    Ranges(Vec<Range>),
    Unknown,
}

/// Which nodes and DOFs are.
#[derive(Clone, Debug)]
pub struct Selection {
    pub nodes: Selected,
    /// Whether all DOFs are.
    pub dofs: bool,
}

impl Default for Selection {
    fn default() -> Self {
        Self { nodes: Selected::All, dofs: true }
    }
}

impl Selection {
    /// `NSEL`.
    pub fn nodes_by(&mut self, command: &Command) {
        let by_number = command.is(2, "NODE") && command.field(3).is_empty();
        let first = whole(command.field(4));
        let or = |at: usize, default| if is_nothing(command, at) { Some(default) } else { whole(command.field(at)) };
        let range = first.filter(|_| by_number).and_then(|first| Some((first, or(5, first)?.max(first), or(6, 1)?)));
        match command.field(1).to_ascii_uppercase().as_slice() {
            b"ALL" => self.nodes = Selected::All,
            b"NONE" => self.nodes = Selected::Ranges(Vec::new()),
            b"STAT" => {}
            kind => self.select(kind, range.map(|range| vec![range])),
        }
    }

    /// `CMSEL`.
    pub fn components_by(&mut self, command: &Command, nodes: &Nodes) {
        let group = nodes.groups.get(&name(command.field(2)));
        let ranges = group.filter(|group| group.len() <= RANGES);
        let ranges = ranges.map(|group| group.iter().map(|&(first, last)| (first, last, 1)).collect());
        self.select(&command.field(1).to_ascii_uppercase(), ranges);
    }

    /// Nodes that a word means, ascending: `ALL`, or the name of a group. None where they are not known.
    pub fn members(&self, word: &str, nodes: &Nodes) -> Option<BTreeSet<u32>> {
        let ranges = match (word.to_ascii_uppercase().as_str(), &self.nodes) {
            ("ALL", Selected::All) => vec![(1, u32::MAX, 1)],
            ("ALL", Selected::Ranges(ranges)) => ranges.clone(),
            ("ALL", Selected::Unknown) => return None,
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

    fn select(&mut self, kind: &[u8], ranges: Option<Vec<Range>>) {
        let before = std::mem::replace(&mut self.nodes, Selected::Unknown);
        self.nodes = match (kind, before, ranges) {
            (b"S" | b"", _, Some(new)) | (b"R", Selected::All, Some(new)) => Selected::Ranges(new),
            (b"A", Selected::All, _) => Selected::All,
            (b"A", Selected::Ranges(mut old), Some(new)) if old.len() + new.len() <= RANGES => {
                old.extend(new);
                Selected::Ranges(old)
            }
            _ => Selected::Unknown,
        };
    }
}
