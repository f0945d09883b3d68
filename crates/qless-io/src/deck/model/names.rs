//! Names nodes, DOFs, equations and places as the deck does.

use std::path::{Path, PathBuf};

use super::{Dof, Model, Origin, Warning};
use crate::deck::{DeckError, Problem};

impl Model {
    /// The name of a node in the deck: its number, or for a node of an instance a name such as `Part-1-1.12`.
    ///
    /// ```
    /// # let place = tempfile::tempdir()?;
    /// let path = place.path().join("one.inp");
    /// std::fs::write(&path, "*NODE\n7,1.,2.,3.\n")?;
    /// assert_eq!(qless_io::deck::read(&path)?.model().node_name(7), "7");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn node_name(&self, node: u32) -> String {
        self.names.get(node).unwrap_or_else(|| node.to_string())
    }

    /// The name of a DOF in the deck, such as `Part-1-1.12:3`.
    pub fn dof_name(&self, dof: Dof) -> String {
        match self.names.get(dof.node) {
            Some(name) => format!("{name}:{}", dof.component),
            None => dof.to_string(),
        }
    }

    /// Whether some nodes belong to instances. The numbers of such nodes do not occur in the text of the deck.
    pub fn has_instances(&self) -> bool {
        self.names.has_instances()
    }

    /// The line and the card of an origin: `line 41 *EQUATION` in the main file, `part.inc:41 *EQUATION` in an included file. If the card
    /// is not in this model, gives the line alone.
    pub fn place(&self, origin: Origin) -> String {
        let Some(card) = self.cards.get(origin.card) else { return format!("line {}", origin.line) };
        let path = self.files.get(card.file as usize).map(PathBuf::as_path);
        let file = path.and_then(Path::file_name).unwrap_or_default().to_string_lossy();
        match card.file {
            0 => format!("line {} {}", origin.line, card.name),
            _ => format!("{file}:{} {}", origin.line, card.name),
        }
    }

    /// The place of a warning: `line 41` in the main file, or `part.inc:41` in an included file.
    pub fn place_of(&self, warning: &Warning) -> String {
        let path = self.files.get(warning.file as usize).filter(|_| warning.file > 0);
        match path.and_then(|path| path.file_name()) {
            Some(file) => format!("{}:{}", file.to_string_lossy(), warning.line),
            None => format!("line {}", warning.line),
        }
    }

    /// The label of equation `i`: its place and its first DOF, as in `line 41 *EQUATION 6:3`. `None` if the equation does not exist.
    pub fn label(&self, i: usize) -> Option<String> {
        (i < self.equations()).then(|| self.label_of(i))
    }

    /// The label of equation `i`, which must exist.
    pub(crate) fn label_of(&self, i: usize) -> String {
        let equation = self.nth(i);
        let place = self.place(equation.origin);
        match equation.columns.first() {
            Some(&j) => format!("{place} {}", self.dof_name(self.dofs[j as usize])),
            None => place,
        }
    }

    /// Makes an error at a line of a card.
    pub(crate) fn error(&self, origin: Origin, field: Option<usize>, problem: Problem) -> DeckError {
        let card = self.cards.nth(origin.card);
        let path = self.files[card.file as usize].clone();
        DeckError { path, line: origin.line as usize, card: card.name.to_string(), field, problem }
    }
}

/// The names of nodes, which are looked up by node number.
#[derive(Clone, Debug, Default)]
pub(super) struct NodeNames {
    /// Runs of consecutive nodes with names, ascending by the number of their first node.
    runs: Vec<NameRun>,
}

/// The names of consecutive nodes, the first of which has the number `first`.
#[derive(Clone, Debug)]
struct NameRun {
    first: u32,
    names: RunNames,
}

#[derive(Clone, Debug)]
pub(super) enum RunNames {
    /// The nodes belong to an instance with this name; the list holds their numbers within it.
    Instance(String, Vec<u32>),
    /// The run is a single node with this name.
    One(String),
}

impl NodeNames {
    /// Names a node, or the nodes of an instance, from `first` on.
    pub fn insert(&mut self, first: u32, names: RunNames) {
        let at = self.runs.partition_point(|known| known.first <= first);
        self.runs.insert(at, NameRun { first, names });
    }

    /// The name of a node; `None` if it has none.
    pub fn get(&self, node: u32) -> Option<String> {
        let run = &self.runs[self.runs.partition_point(|run| run.first <= node).checked_sub(1)?];
        let k = (node - run.first) as usize;
        match &run.names {
            RunNames::Instance(instance, own) => own.get(k).map(|own| format!("{instance}.{own}")),
            RunNames::One(name) => (k == 0).then(|| name.clone()),
        }
    }

    /// Whether some nodes belong to instances.
    pub fn has_instances(&self) -> bool {
        self.runs.iter().any(|run| matches!(run.names, RunNames::Instance(..)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_found_by_number() {
        let mut names = NodeNames::default();
        names.insert(30, RunNames::One("reference".into()));
        names.insert(10, RunNames::Instance("I-1".into(), vec![1, 5]));
        names.insert(12, RunNames::Instance("I-2".into(), vec![]));
        names.insert(12, RunNames::Instance("I-3".into(), vec![7]));
        let found = [9, 10, 11, 12, 13, 30, 31].map(|node| names.get(node));
        let expected = [None, Some("I-1.1"), Some("I-1.5"), Some("I-3.7"), None, Some("reference"), None];
        assert_eq!(found, expected.map(|name| name.map(str::to_owned)));
    }
}
