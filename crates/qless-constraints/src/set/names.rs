//! The labels of constraints by number; of those that were added at once, one for all.

use std::borrow::Cow;
use std::collections::BTreeSet;

/// Constraints that follow one another.
enum Run {
    /// Nothing for those that were removed.
    Each(Vec<Option<Box<str>>>),
    Numbered {
        label: Box<str>,
        removed: BTreeSet<u32>,
    },
}

/// Of all constraints that were ever added.
#[derive(Default)]
pub(super) struct Names {
    /// Each with the number of its first constraint.
    runs: Vec<(u32, Run)>,
    count: u32,
}

impl Names {
    /// Constraints that were ever added.
    pub fn count(&self) -> u32 {
        self.count
    }

    pub fn push(&mut self, label: String) {
        let label = Some(label.into_boxed_str());
        match self.runs.last_mut() {
            Some((_, Run::Each(names))) => names.push(label),
            _ => self.runs.push((self.count, Run::Each(vec![label]))),
        }
        self.count += 1;
    }

    /// So many, which are [`numbered`].
    pub fn push_numbered(&mut self, label: String, count: u32) {
        if count > 0 {
            self.runs.push((self.count, Run::Numbered { label: label.into(), removed: BTreeSet::new() }));
            self.count += count;
        }
    }

    /// The label of a constraint that was not removed.
    pub fn get(&self, number: u32) -> Option<Cow<'_, str>> {
        match &self.runs[self.run(number)] {
            (first, Run::Each(names)) => names[(number - first) as usize].as_deref().map(Cow::Borrowed),
            (_, Run::Numbered { removed, .. }) if removed.contains(&number) => None,
            (first, Run::Numbered { label, .. }) => Some(numbered(label, (number - first) as usize).into()),
        }
    }

    pub fn is_there(&self, number: u32) -> bool {
        match &self.runs[self.run(number)] {
            (first, Run::Each(names)) => names[(number - first) as usize].is_some(),
            (_, Run::Numbered { removed, .. }) => !removed.contains(&number),
        }
    }

    pub fn remove(&mut self, number: u32) {
        let run = self.run(number);
        match &mut self.runs[run] {
            (first, Run::Each(names)) => names[(number - *first) as usize] = None,
            (_, Run::Numbered { removed, .. }) => {
                removed.insert(number);
            }
        }
    }

    /// The run of a constraint.
    fn run(&self, number: u32) -> usize {
        self.runs.partition_point(|&(first, _)| first <= number) - 1
    }
}

/// The label of the i-th of several.
pub(super) fn numbered(label: &str, i: usize) -> String {
    if label.is_empty() { String::new() } else { format!("{label} {i}") }
}
