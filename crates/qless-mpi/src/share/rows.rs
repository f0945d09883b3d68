//! Equations with terms ascending by DOF, each DOF once, no zeros; and the check that no two equations have the same number.

use super::ShareError;
use crate::ranks::{Message, Outbox, Ranks};

/// Equations over the global DOFs, in compressed rows.
#[derive(Clone, Debug)]
pub(crate) struct ShareRows {
    pub numbers: Vec<u64>,
    pub starts: Vec<usize>,
    pub dofs: Vec<u64>,
    pub values: Vec<f64>,
    pub rhs: Vec<f64>,
}

impl ShareRows {
    pub fn new() -> Self {
        Self { numbers: Vec::new(), starts: vec![0], dofs: Vec::new(), values: Vec::new(), rhs: Vec::new() }
    }

    pub fn len(&self) -> usize {
        self.numbers.len()
    }

    pub fn row(&self, i: usize) -> impl ExactSizeIterator<Item = (u64, f64)> + Clone + '_ {
        let range = self.starts[i]..self.starts[i + 1];
        self.dofs[range.clone()].iter().copied().zip(self.values[range].iter().copied())
    }

    pub fn values(&self, i: usize) -> &[f64] {
        &self.values[self.starts[i]..self.starts[i + 1]]
    }

    pub fn push(&mut self, number: u64, rhs: f64, terms: impl Iterator<Item = (u64, f64)>) {
        terms.for_each(|(dof, value)| {
            self.dofs.push(dof);
            self.values.push(value);
        });
        self.starts.push(self.dofs.len());
        self.numbers.push(number);
        self.rhs.push(rhs);
    }
}

/// Sorts the terms of a row, sums repeats, and drops terms that are zero or cancel to rounding, as [`qless::SystemBuilder`] does.
pub(crate) fn sum_repeats(terms: &mut Vec<(u64, f64)>) {
    let ascends = terms.windows(2).all(|pair| pair[0].0 < pair[1].0);
    if ascends && terms.iter().all(|&(_, value)| value != 0.0) {
        return;
    }
    terms.sort_by_key(|&(dof, _)| dof);
    let summed = |repeats: &[(u64, f64)]| {
        let sum: f64 = repeats.iter().map(|&(_, value)| value).sum();
        let largest = repeats.iter().map(|&(_, value)| value.abs()).fold(0.0, f64::max);
        let cancelled = repeats.len() > 1 && sum.abs() <= 4.0 * f64::EPSILON * largest;
        (sum != 0.0 && !cancelled).then_some((repeats[0].0, sum))
    };
    *terms = terms.chunk_by(|a, b| a.0 == b.0).filter_map(summed).collect();
}

/// Checks that no two equations have the same number; the ranks may return different results, each for the numbers that it checks.
/// Collective.
///
/// Each number, 8 bytes, is sent to the rank that checks this range of numbers. If a rank's own numbers ascend, it searches them in place
/// and sends none to itself.
pub(crate) fn check_numbers(ranks: &dyn Ranks, rows: &ShareRows) -> Result<(), ShareError> {
    let mut end = [rows.numbers.iter().max().map_or(0, |most| most + 1)];
    ranks.max(&mut end);
    let each = end[0].div_ceil(ranks.size() as u64).max(1);
    let rank = ranks.rank();
    let ascends = rows.numbers.is_sorted_by(|a, b| a < b);
    let mut post = Outbox::default();
    let keeper = |number: u64| (number / each) as usize;
    let sent = rows.numbers.iter().filter(|&&number| !ascends || keeper(number) != rank);
    sent.for_each(|&number| post.to(keeper(number)).push(number));
    let came = post.send(ranks);
    let kept: &[u64] = if ascends { &rows.numbers } else { &[] };
    twice(&came, rank, kept)
}

/// Returns an error with the smallest number that was received twice, or that is also among the numbers of this rank.
fn twice(came: &[Message], rank: usize, kept: &[u64]) -> Result<(), ShareError> {
    let mut all: Vec<(u64, usize)> = Vec::new();
    for message in came {
        all.extend(message.words.iter().map(|&number| (number, message.rank)));
    }
    let is_kept = |(number, _): &&(u64, usize)| kept.binary_search(number).is_ok();
    let again: Vec<(u64, usize)> = all.iter().filter(is_kept).map(|&(number, _)| (number, rank)).collect();
    all.extend(again);
    all.sort_unstable();
    match all.windows(2).find(|pair| pair[0].0 == pair[1].0) {
        Some(pair) => Err(ShareError::NumberTwice { rank: pair[1].1, number: pair[1].0 }),
        None => Ok(()),
    }
}
