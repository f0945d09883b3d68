//! Names of nodes that have another one in the deck than their number in the model.

/// Names by number.
#[derive(Clone, Debug, Default)]
pub(super) struct NodeNames {
    /// Ascending by their first numbers.
    runs: Vec<Run>,
}

/// Nodes from `first` on, in turn.
#[derive(Clone, Debug)]
struct Run {
    first: u32,
    names: Names,
}

#[derive(Clone, Debug)]
enum Names {
    /// Nodes of an instance, by their numbers in it.
    Of(String, Vec<u32>),
    /// A single one.
    One(String),
}

impl NodeNames {
    /// Names the nodes of an instance, from `first` on.
    pub fn instance(&mut self, first: u32, instance: String, own: Vec<u32>) {
        self.insert(Run { first, names: Names::Of(instance, own) });
    }

    /// Names a node.
    pub fn one(&mut self, node: u32, name: String) {
        self.insert(Run { first: node, names: Names::One(name) });
    }

    fn insert(&mut self, run: Run) {
        let at = self.runs.partition_point(|known| known.first <= run.first);
        self.runs.insert(at, run);
    }

    /// The name of a node, if it has one.
    pub fn get(&self, node: u32) -> Option<String> {
        let run = &self.runs[self.runs.partition_point(|run| run.first <= node).checked_sub(1)?];
        let k = (node - run.first) as usize;
        match &run.names {
            Names::Of(instance, own) => own.get(k).map(|own| format!("{instance}.{own}")),
            Names::One(name) => (k == 0).then(|| name.clone()),
        }
    }

    /// Whether nodes are those of instances.
    pub fn has_instances(&self) -> bool {
        self.runs.iter().any(|run| matches!(run.names, Names::Of(..)))
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
