//! What the input calls nodes, DOFs, equations and places.

use std::path::{Path, PathBuf};

use super::{Dof, Model, Origin, Warning};
use crate::deck::{DeckError, Problem};

impl Model {
    /// What the deck calls a node: `Part-1-1.12`, or its number where that is its name.
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

    /// What the deck calls a DOF: `Part-1-1.12:3`.
    pub fn dof_name(&self, dof: Dof) -> String {
        match self.names.get(dof.node) {
            Some(name) => format!("{name}:{}", dof.component),
            None => dof.to_string(),
        }
    }

    /// Whether nodes have names of instances, so that their numbers mean nothing in the deck's text.
    pub fn has_instances(&self) -> bool {
        self.names.has_instances()
    }

    /// Where, and which card: `line 41 *EQUATION` in the main file, `part.inc:41 *EQUATION` in others; the line alone for an origin
    /// that is none of this model.
    pub fn place(&self, origin: Origin) -> String {
        let Some(card) = self.cards.get(origin.card) else { return format!("line {}", origin.line) };
        let path = self.files.get(card.file as usize).map(PathBuf::as_path);
        let file = path.and_then(Path::file_name).unwrap_or_default().to_string_lossy();
        match card.file {
            0 => format!("line {} {}", origin.line, card.name),
            _ => format!("{file}:{} {}", origin.line, card.name),
        }
    }

    /// Where something is that the user should know: `line 41`, `part.inc:41` in files that are included.
    pub fn place_of(&self, warning: &Warning) -> String {
        let path = self.files.get(warning.file as usize).filter(|_| warning.file > 0);
        match path.and_then(|path| path.file_name()) {
            Some(file) => format!("{}:{}", file.to_string_lossy(), warning.line),
            None => format!("line {}", warning.line),
        }
    }

    /// `line 41 *EQUATION 6:3`: the place and the first DOF of equation `i`, if it is there.
    pub fn label(&self, i: usize) -> Option<String> {
        (i < self.equations()).then(|| self.label_of(i))
    }

    /// The label of equation `i`, which is there.
    pub(crate) fn label_of(&self, i: usize) -> String {
        let equation = self.nth(i);
        let place = self.place(equation.origin);
        match equation.columns.first() {
            Some(&j) => format!("{place} {}", self.dof_name(self.dofs[j as usize])),
            None => place,
        }
    }

    /// An error at a line of a card.
    pub(crate) fn error(&self, origin: Origin, field: Option<usize>, problem: Problem) -> DeckError {
        let card = self.cards.nth(origin.card);
        let path = self.files[card.file as usize].clone();
        DeckError { path, line: origin.line as usize, card: card.name.to_string(), field, problem }
    }
}

/// RunNames by number.
#[derive(Clone, Debug, Default)]
pub(super) struct NodeNames {
    /// Ascending by their first numbers.
    runs: Vec<NameRun>,
}

/// Nodes from `first` on, in turn.
#[derive(Clone, Debug)]
struct NameRun {
    first: u32,
    names: RunNames,
}

#[derive(Clone, Debug)]
enum RunNames {
    /// Nodes of an instance, by their numbers in it.
    Instance(String, Vec<u32>),
    /// A single one.
    One(String),
}

impl NodeNames {
    /// RunNames the nodes of an instance, from `first` on.
    pub fn instance(&mut self, first: u32, instance: String, own: Vec<u32>) {
        self.insert(NameRun { first, names: RunNames::Instance(instance, own) });
    }

    /// RunNames a node.
    pub fn one(&mut self, node: u32, name: String) {
        self.insert(NameRun { first: node, names: RunNames::One(name) });
    }

    fn insert(&mut self, run: NameRun) {
        let at = self.runs.partition_point(|known| known.first <= run.first);
        self.runs.insert(at, run);
    }

    /// The name of a node, if it has one.
    pub fn get(&self, node: u32) -> Option<String> {
        let run = &self.runs[self.runs.partition_point(|run| run.first <= node).checked_sub(1)?];
        let k = (node - run.first) as usize;
        match &run.names {
            RunNames::Instance(instance, own) => own.get(k).map(|own| format!("{instance}.{own}")),
            RunNames::One(name) => (k == 0).then(|| name.clone()),
        }
    }

    /// Whether nodes are those of instances.
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
        names.one(30, "reference".into());
        names.instance(10, "I-1".into(), vec![1, 5]);
        names.instance(12, "I-2".into(), vec![]);
        names.instance(12, "I-3".into(), vec![7]);
        let found = [9, 10, 11, 12, 13, 30, 31].map(|node| names.get(node));
        let expected = [None, Some("I-1.1"), Some("I-1.5"), Some("I-3.7"), None, Some("reference"), None];
        assert_eq!(found, expected.map(|name| name.map(str::to_owned)));
    }
}
