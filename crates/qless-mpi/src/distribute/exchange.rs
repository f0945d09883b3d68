//! Sends each equation to the rank that analyses it, with the prescribed values of its DOFs.

use std::collections::BTreeMap;

use crate::components::{KnownDofs, TouchedDofs};
use crate::ranks::{Outbox, Ranks, real};
use crate::share::ShareRows;

/// Equations that a rank analyses, ascending by equation number.
pub(crate) struct AssignedEquations {
    pub rows: ShareRows,
    /// For each equation, the rank that holds it and its index on that rank.
    pub source: Vec<(usize, u64)>,
    /// Prescribed DOFs of the assigned equations, with their values.
    pub prescribed: BTreeMap<u64, f64>,
}

/// Sends each row to the rank that `to` names, if any. Collective.
pub(crate) fn exchange_equations(
    ranks: &dyn Ranks,
    (rows, touched, known): (&ShareRows, &TouchedDofs, &KnownDofs),
    to: impl Fn(usize) -> Option<usize>,
) -> AssignedEquations {
    let mut post = Outbox::default();
    let mut prescribed: BTreeMap<usize, BTreeMap<u32, f64>> = BTreeMap::new();
    for i in 0..rows.len() {
        let Some(rank) = to(i) else { continue };
        let words = post.to(rank);
        let range = rows.starts[i]..rows.starts[i + 1];
        words.extend([rows.numbers[i], i as u64, rows.rhs[i].to_bits(), range.len() as u64]);
        words.extend(rows.row(i).flat_map(|(dof, value)| [dof, value.to_bits()]));
        if !known.prescribed.is_empty() {
            let values = touched.row(rows, i).iter().filter_map(|j| known.prescribed.get(j).map(|&value| (*j, value)));
            prescribed.entry(rank).or_default().extend(values);
        }
    }
    // In a message, prescribed DOFs follow the equations, after a separator that cannot be an equation number.
    for (rank, values) in prescribed {
        let words = post.to(rank);
        words.push(u64::MAX);
        words.extend(values.into_iter().flat_map(|(j, value)| [touched.dofs[j as usize], value.to_bits()]));
    }
    AssignedEquations::read(&post.send(ranks))
}

impl AssignedEquations {
    fn read(received: &[crate::Message]) -> Self {
        let mut found: Vec<(u64, usize, usize)> = Vec::new();
        let mut prescribed = BTreeMap::new();
        for (k, message) in received.iter().enumerate() {
            let (words, mut at) = (&message.words, 0);
            while at < words.len() && words[at] != u64::MAX {
                found.push((words[at], k, at));
                at += 4 + 2 * words[at + 3] as usize;
            }
            let pairs = words.get(at + 1..).unwrap_or_default().chunks_exact(2);
            prescribed.extend(pairs.map(|pair| (pair[0], real(pair[1]))));
        }
        found.sort_unstable();
        let mut assigned = Self { rows: ShareRows::new(), source: Vec::with_capacity(found.len()), prescribed };
        for (number, k, at) in found {
            let words = &received[k].words;
            let terms = words[at + 4..at + 4 + 2 * words[at + 3] as usize].chunks_exact(2);
            assigned.rows.push(number, real(words[at + 2]), terms.map(|pair| (pair[0], real(pair[1]))));
            assigned.source.push((received[k].rank, words[at + 1]));
        }
        assigned
    }
}
