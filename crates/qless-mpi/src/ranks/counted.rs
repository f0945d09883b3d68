//! Counts the messages and bytes that a rank sends.

use std::cell::Cell;

use super::{Message, Ranks};

/// Messages and bytes that one rank sent and received, and the number of its collective operations.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sent {
    /// Number of messages to other ranks.
    pub messages: u64,
    /// Number of bytes in these messages.
    pub bytes: u64,
    /// Number of bytes received from other ranks.
    pub received: u64,
    /// Number of collective operations.
    pub rounds: u64,
}

/// Wraps the ranks of a job and counts what this rank sends and receives.
#[derive(Debug)]
pub struct Counted<'a, R: Ranks + ?Sized> {
    ranks: &'a R,
    sent: Cell<Sent>,
}

impl<'a, R: Ranks + ?Sized> Counted<'a, R> {
    /// Counts from zero.
    pub fn new(ranks: &'a R) -> Self {
        Self { ranks, sent: Cell::default() }
    }

    /// The counts so far.
    pub fn sent(&self) -> Sent {
        self.sent.get()
    }

    fn count(&self, messages: u64, bytes: u64, received: u64) {
        let sent = self.sent.get();
        self.sent.set(Sent {
            messages: sent.messages + messages,
            bytes: sent.bytes + bytes,
            received: sent.received + received,
            rounds: sent.rounds + 1,
        });
    }

    fn sizes(&self, messages: &[Message]) -> (u64, u64) {
        let others = messages.iter().filter(|message| message.rank != self.rank());
        others.fold((0, 0), |(count, bytes), message| (count + 1, bytes + 8 * message.words.len() as u64))
    }

    fn count_exchange(&self, sent: (u64, u64), received: &[Message]) {
        self.count(sent.0, sent.1, self.sizes(received).1);
    }

    /// Reductions are assumed to run along a tree: one message for each level.
    fn count_tree(&self, words: usize) {
        let levels = u64::from(self.size().next_power_of_two().trailing_zeros());
        self.count(levels, levels * 8 * words as u64, levels * 8 * words as u64);
    }
}

impl<R: Ranks + ?Sized> Ranks for Counted<'_, R> {
    fn rank(&self) -> usize {
        self.ranks.rank()
    }

    fn size(&self) -> usize {
        self.ranks.size()
    }

    fn exchange(&self, messages: Vec<Message>) -> Vec<Message> {
        let sent = self.sizes(&messages);
        let received = self.ranks.exchange(messages);
        self.count_exchange(sent, &received);
        received
    }

    fn overlap(&self, messages: Vec<Message>, from: &[usize], work: &mut dyn FnMut()) -> Vec<Message> {
        let sent = self.sizes(&messages);
        let received = self.ranks.overlap(messages, from, work);
        self.count_exchange(sent, &received);
        received
    }

    fn sum(&self, numbers: &mut [u64]) {
        self.count_tree(numbers.len());
        self.ranks.sum(numbers);
    }

    fn max(&self, numbers: &mut [u64]) {
        self.count_tree(numbers.len());
        self.ranks.max(numbers);
    }

    fn gather(&self, numbers: &[u64]) -> Vec<u64> {
        let all = self.size() * numbers.len();
        self.count(self.size() as u64 - 1, 8 * (all - numbers.len()) as u64, 8 * (all - numbers.len()) as u64);
        self.ranks.gather(numbers)
    }
}
