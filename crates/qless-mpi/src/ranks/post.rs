//! Words for several ranks, collected before they are sent.

use std::collections::BTreeMap;

use super::{Message, Ranks};

/// Words by receiver.
#[derive(Default)]
pub(crate) struct Post(BTreeMap<usize, Vec<u64>>);

impl Post {
    pub fn to(&mut self, rank: usize) -> &mut Vec<u64> {
        self.0.entry(rank).or_default()
    }

    pub fn messages(self) -> Vec<Message> {
        self.0.into_iter().map(|(rank, words)| Message { rank, words }).collect()
    }

    /// Sends what was collected; what came, ascending by sender.
    pub fn send(self, ranks: &dyn Ranks) -> Vec<Message> {
        ranks.exchange(self.messages())
    }
}

/// A number of a word.
pub(crate) fn real(word: u64) -> f64 {
    f64::from_bits(word)
}
