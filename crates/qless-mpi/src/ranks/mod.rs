//! Communication between the ranks of a job: messages of 64-bit words, sums and maxima.
//!
//! All other modules use [`Ranks`] only, so that the same code runs on MPI (`World`, with the feature `mpi`), on one rank ([`Alone`])
//! and on many ranks within one process ([`together`]), where the traffic can be counted ([`Counted`]).

mod counted;
mod thread_comm;
#[cfg(feature = "mpi")]
mod world;

use std::collections::BTreeMap;

pub use counted::{Counted, Sent};
pub use thread_comm::together;
#[cfg(feature = "mpi")]
pub use world::{World, WorldError};

/// Words to a rank, or from one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Message {
    /// The rank that gets it, or that sent it.
    pub rank: usize,
    /// The content.
    pub words: Vec<u64>,
}

/// The ranks of a job, as one of them sees them. All methods but [`Ranks::rank`] and [`Ranks::size`] are collective: every rank
/// calls the same ones in the same order.
pub trait Ranks {
    /// The number of this rank, from 0.
    fn rank(&self) -> usize;

    /// How many there are.
    fn size(&self) -> usize;

    /// Sends messages, at most one to each rank, and returns those that came, ascending by sender. Nobody needs to know before who will
    /// send. A message to the own rank comes back.
    fn exchange(&self, messages: Vec<Message>) -> Vec<Message>;

    /// The same where the senders are known: one message comes from each rank of `from`, ascending. `work` is done while they travel.
    fn overlap(&self, messages: Vec<Message>, from: &[usize], work: &mut dyn FnMut()) -> Vec<Message>;

    /// Adds up each number over all ranks.
    fn sum(&self, numbers: &mut [u64]);

    /// The largest of each number over all ranks.
    fn max(&self, numbers: &mut [u64]);

    /// The numbers of all ranks, rank by rank; the same count on each.
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
}

/// The double with these bits.
pub(crate) fn real(word: u64) -> f64 {
    f64::from_bits(word)
}
