//! Each equation has a number of its own: told to the rank that keeps that part of the numbers, 8 bytes each. Numbers that ascend are
//! not told to the rank itself.

use super::{Rows, ShareError};
use crate::ranks::{Message, Post, Ranks};

/// Collective; the fault that this rank sees, if any.
pub(crate) fn check_numbers(ranks: &dyn Ranks, rows: &Rows) -> Result<(), ShareError> {
    let mut end = [rows.numbers.iter().max().map_or(0, |most| most + 1)];
    ranks.max(&mut end);
    let each = end[0].div_ceil(ranks.size() as u64).max(1);
    let rank = ranks.rank();
    let ascends = rows.numbers.is_sorted_by(|a, b| a < b);
    let mut post = Post::default();
    let keeper = |number: u64| (number / each) as usize;
    let told = rows.numbers.iter().filter(|&&number| !ascends || keeper(number) != rank);
    told.for_each(|&number| post.to(keeper(number)).push(number));
    let came = post.send(ranks);
    let kept: &[u64] = if ascends { &rows.numbers } else { &[] };
    twice(&came, rank, kept)
}

/// The smallest number that came twice, or that is among those that this rank holds as well.
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
