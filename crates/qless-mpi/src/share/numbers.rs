//! Each equation has a number of its own: told to the rank that keeps that part of the numbers, 8 bytes each.

use super::{Rows, ShareError};
use crate::ranks::{Post, Ranks};

/// Collective; the fault that this rank sees, if any.
pub(crate) fn check_numbers(ranks: &dyn Ranks, rows: &Rows) -> Result<(), ShareError> {
    let mut end = [rows.numbers.iter().max().map_or(0, |most| most + 1)];
    ranks.max(&mut end);
    let each = end[0].div_ceil(ranks.size() as u64).max(1);
    let mut post = Post::default();
    rows.numbers.iter().for_each(|&number| post.to((number / each) as usize).push(number));
    let mut all: Vec<(u64, usize)> = Vec::new();
    for message in post.send(ranks) {
        all.extend(message.words.iter().map(|&number| (number, message.rank)));
    }
    all.sort_unstable();
    match all.windows(2).find(|pair| pair[0].0 == pair[1].0) {
        Some(pair) => Err(ShareError::NumberTwice { rank: pair[1].1, number: pair[1].0 }),
        None => Ok(()),
    }
}
