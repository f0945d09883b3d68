//! `groups`: dependent equations of one kind and origin, so that hundreds can be read at once.
//!
//! Equations are grouped by their labels without numbers: `tie side face #, node (#,#), x`. Labels of decks keep the line of their card if
//! several equations come from it: `line 41 *TIE`.

use std::collections::{BTreeMap, BTreeSet};

use super::{DependentEquation, Term};
use crate::Kind;

/// Dependent equations of one kind and origin.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Group {
    /// Redundant or conflicting.
    pub kind: Kind,
    /// The common label of the equations.
    pub label: String,
    /// The common labels of the equations and prescribed values that explain the group, as far as explanations are known, without the
    /// group's own label.
    pub by: Vec<String>,
    /// The rows of the equations, from 1; the first is the example.
    pub rows: Vec<usize>,
}

impl Group {
    /// Groups of equations, in the order of their first rows: conflicts before redundant ones. `found` has the row (from 1), the kind,
    /// the label, and the labels of the members of its explanation.
    ///
    /// ```
    /// use qless::Kind;
    /// use qless::report::Group;
    /// let tie = |row: usize| (row, Kind::Redundant, format!("tie {row}, x"), vec!["body 2, x".to_owned()]);
    /// let groups = Group::of(&[tie(3), tie(5)]);
    /// assert_eq!((groups[0].label.as_str(), groups[0].rows.as_slice()), ("tie #, x", [3, 5].as_slice()));
    /// assert_eq!(groups[0].by, ["body #, x"]);
    /// ```
    pub fn of(found: &[(usize, Kind, String, Vec<String>)]) -> Vec<Self> {
        let mut of_place: BTreeMap<String, usize> = BTreeMap::new();
        let labels = found.iter().flat_map(|(_, _, label, by)| std::iter::once(label).chain(by));
        labels.collect::<BTreeSet<_>>().into_iter().for_each(|label| *of_place.entry(place(label)).or_default() += 1);
        let common = |label: &str| {
            let place = place(label);
            if of_place.get(&place).is_some_and(|&count| count > 1) && place != label {
                place
            } else {
                without_numbers(&place)
            }
        };
        let mut groups: Vec<Self> = Vec::new();
        let mut known: BTreeMap<(bool, String), usize> = BTreeMap::new();
        for (row, kind, label, by) in found {
            let label = common(label);
            let k = *known.entry((*kind == Kind::Conflicting, label.clone())).or_insert_with(|| {
                groups.push(Self { kind: *kind, label, by: Vec::new(), rows: Vec::new() });
                groups.len() - 1
            });
            groups[k].rows.push(*row);
            groups[k].by.extend(by.iter().map(|label| common(label)));
        }
        for group in &mut groups {
            group.by.sort_unstable();
            group.by.dedup();
            group.by.retain(|label| *label != group.label);
        }
        groups.sort_by_key(|group| (group.kind != Kind::Conflicting, group.rows.first().copied()));
        groups
    }

    /// Groups of the equations of a report.
    pub(super) fn of_report(dependent: &[DependentEquation]) -> Vec<Self> {
        let label = |term: &Term| match term {
            Term::Equation { label, .. } => label.clone(),
            Term::Prescribed { .. } => PRESCRIBED.to_owned(),
        };
        let found = dependent.iter().map(|equation| {
            let by = equation.certificate.because.iter().map(label).collect();
            (equation.row, equation.kind, equation.label.clone(), by)
        });
        Self::of(&found.collect::<Vec<_>>())
    }
}

/// The label of prescribed values in an explanation.
pub const PRESCRIBED: &str = "prescribed values";

/// The label without the DOF at its end: `line 41 *TIE 3:1` becomes `line 41 *TIE`.
fn place(label: &str) -> String {
    let is_dof = |word: &str| {
        let parts = word.rsplit_once(':');
        parts.is_some_and(|(node, component)| !node.is_empty() && component.parse::<u8>().is_ok())
    };
    match label.rsplit_once(' ') {
        Some((place, word)) if is_dof(word) => place.to_owned(),
        _ => label.to_owned(),
    }
}

/// Replaces each number by `#`.
fn without_numbers(label: &str) -> String {
    let mut text = String::new();
    for c in label.chars() {
        match c {
            '0'..='9' if text.ends_with('#') => {}
            '0'..='9' => text.push('#'),
            other => text.push(other),
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cards_with_several_equations_keep_their_line() {
        let found =
            |row: usize, label: &str| (row, Kind::Redundant, label.to_owned(), vec!["line 9 *TIE 5:1".to_owned()]);
        let labels = ["line 41 *TIE 3:1", "line 41 *TIE 3:2", "line 50 *EQUATION 7:1", "line 52 *EQUATION 8:1"];
        let groups = Group::of(&labels.iter().enumerate().map(|(k, label)| found(k + 1, label)).collect::<Vec<_>>());
        let labels: Vec<(&str, usize)> = groups.iter().map(|group| (group.label.as_str(), group.rows.len())).collect();
        assert_eq!(labels, [("line 41 *TIE", 2), ("line # *EQUATION", 2)]);
        assert_eq!(groups[0].by, ["line # *TIE"]);
    }
}
