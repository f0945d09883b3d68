//! Communication between the ranks of a job: messages of 64-bit words, sums and maxima.
//!
//! All other modules use only the trait [`Ranks`]. So the same code runs on MPI (`World`, with the feature `mpi`), on one rank
//! ([`Alone`]) and on ranks that are threads of one process ([`on_threads`]). [`Counted`] counts the traffic.

mod counted;
mod thread_comm;
#[cfg(feature = "mpi")]
mod world;

use std::collections::BTreeMap;

pub use counted::{Counted, Sent};
pub use thread_comm::on_threads;
#[cfg(feature = "mpi")]
pub use world::{World, WorldError};

/// A message to a rank or from a rank.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Message {
    /// The receiver of an outgoing message, the sender of a received one.
    pub rank: usize,
    /// The content.
    pub words: Vec<u64>,
}

/// The ranks of a job, from the view of one rank. All methods except [`Ranks::rank`] and [`Ranks::size`] are collective: every rank
/// calls the same methods in the same order.
pub trait Ranks {
    /// The number of this rank, from 0.
    fn rank(&self) -> usize;

    /// The number of ranks.
    fn size(&self) -> usize;

    /// Sends messages, at most one to each rank, and returns the received ones, ascending by sender. Receivers need not know the senders in
    /// advance. A message of a rank to itself is received too.
    fn exchange(&self, messages: Vec<Message>) -> Vec<Message>;

    /// Like [`Ranks::exchange`] for known senders: returns one message from each rank in `from`, ascending. Calls `work` during the
    /// transfer.
    fn overlap(&self, messages: Vec<Message>, from: &[usize], work: &mut dyn FnMut()) -> Vec<Message>;

    /// Replaces each number by its sum over all ranks.
    fn sum(&self, numbers: &mut [u64]);

    /// Replaces each number by its maximum over all ranks.
    fn max(&self, numbers: &mut [u64]);

    /// Collects the numbers of all ranks, in the order of the ranks. Each rank must give the same count of numbers.
    fn gather(&self, numbers: &[u64]) -> Vec<u64>;
}

/// The only rank of a job.
#[derive(Clone, Copy, Debug, Default)]
pub struct Alone;

impl Ranks for Alone {
    fn rank(&self) -> usize {
        0
    }

    fn size(&self) -> usize {
        1
    }

    fn exchange(&self, messages: Vec<Message>) -> Vec<Message> {
        messages
    }

    fn overlap(&self, messages: Vec<Message>, _from: &[usize], work: &mut dyn FnMut()) -> Vec<Message> {
        work();
        messages
    }

    fn sum(&self, _numbers: &mut [u64]) {}

    fn max(&self, _numbers: &mut [u64]) {}

    fn gather(&self, numbers: &[u64]) -> Vec<u64> {
        numbers.to_vec()
    }
}

/// Outgoing words, by receiver.
#[derive(Default)]
pub(crate) struct Outbox(BTreeMap<usize, Vec<u64>>);

impl Outbox {
    pub fn to(&mut self, rank: usize) -> &mut Vec<u64> {
        self.0.entry(rank).or_default()
    }

    pub fn messages(self) -> Vec<Message> {
        self.0.into_iter().map(|(rank, words)| Message { rank, words }).collect()
    }

    /// Sends the collected words and returns the received messages, ascending by sender.
    pub fn send(self, ranks: &dyn Ranks) -> Vec<Message> {
        ranks.exchange(self.messages())
    }

    /// Sends the collected words. Splits the received messages into records of N words and returns each with its sender.
    pub fn send_records<const N: usize>(self, ranks: &dyn Ranks) -> impl Iterator<Item = (usize, [u64; N])> {
        records(self.send(ranks))
    }
}

/// Splits messages into records of N words, each with its sender.
pub(crate) fn records<const N: usize>(messages: Vec<Message>) -> impl Iterator<Item = (usize, [u64; N])> {
    messages.into_iter().flat_map(|Message { rank, words }| {
        (0..words.len() / N).map(move |k| (rank, std::array::from_fn(|word| words[k * N + word])))
    })
}

/// The double with these bits.
pub(crate) fn real(word: u64) -> f64 {
    f64::from_bits(word)
}
