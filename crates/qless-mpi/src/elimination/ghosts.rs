//! Masters that one rank owns and other ranks use. Senders and receivers are determined once; the values are exchanged in each step.

use std::ops::Range;

use crate::components::Layout;
use crate::ranks::{Message, Outbox, Ranks, real};

/// The masters that this rank shares with other ranks.
#[derive(Debug)]
pub(super) struct Ghosts {
    /// The indices of the masters that this rank owns. They are contiguous among the local masters, which ascend.
    own: Range<usize>,
    /// For each rank that uses masters of this rank: their indices among the local masters of this rank.
    sent: Vec<(usize, Vec<u32>)>,
    /// For each other rank that owns local masters: the range of their indices among the local masters of this rank.
    received: Vec<(usize, Range<usize>)>,
}

impl Ghosts {
    /// Determines senders and receivers. `masters` are the local masters, ascending. Collective.
    pub fn new(ranks: &dyn Ranks, layout: &Layout, masters: &[u64]) -> Self {
        let place = |dof: u64| masters.partition_point(|&master| master < dof);
        let range = layout.owned(ranks.rank());
        let own = place(range.start)..place(range.end);
        let mut post = Outbox::default();
        let mut received: Vec<(usize, Range<usize>)> = Vec::new();
        let mut start = 0;
        for of_owner in masters.chunk_by(|&a, &b| layout.owner(a) == layout.owner(b)) {
            let owner = layout.owner(of_owner[0]);
            if owner != ranks.rank() {
                post.to(owner).extend_from_slice(of_owner);
                received.push((owner, start..start + of_owner.len()));
            }
            start += of_owner.len();
        }
        let places = |message: Message| {
            let places = message.words.iter().map(|&dof| place(dof) as u32).collect();
            (message.rank, places)
        };
        let sent = post.send(ranks).into_iter().map(places).collect();
        Self { own, sent, received }
    }

    /// The range of indices, among the local masters, of those that this rank owns.
    pub fn own(&self) -> Range<usize> {
        self.own.clone()
    }

    /// Receives the values of the masters of other ranks from their owners. Calls `work` during the transfer. Collective.
    pub fn gather(&self, ranks: &dyn Ranks, local: &mut [f64], work: &mut dyn FnMut()) {
        let message = |(rank, places): &(usize, Vec<u32>)| Message {
            rank: *rank,
            words: places.iter().map(|&q| local[q as usize].to_bits()).collect(),
        };
        let from: Vec<usize> = self.received.iter().map(|(rank, _)| *rank).collect();
        let messages = ranks.overlap(self.sent.iter().map(message).collect(), &from, work);
        for (message, (_, range)) in messages.iter().zip(&self.received) {
            local[range.clone()].iter_mut().zip(&message.words).for_each(|(value, &word)| *value = real(word));
        }
    }

    /// Sends the values for masters of other ranks to their owners, and adds the received values to the masters that this rank owns, in the
    /// order of ranks. Collective.
    pub fn sum(&self, ranks: &dyn Ranks, local: &[f64], masters: &mut [f64]) {
        let message = |(rank, range): &(usize, Range<usize>)| Message {
            rank: *rank,
            words: local[range.clone()].iter().map(|value| value.to_bits()).collect(),
        };
        let from: Vec<usize> = self.sent.iter().map(|(rank, _)| *rank).collect();
        let messages = ranks.overlap(self.received.iter().map(message).collect(), &from, &mut || ());
        for (message, (_, places)) in messages.iter().zip(&self.sent) {
            for (&q, &word) in places.iter().zip(&message.words) {
                masters[q as usize - self.own.start] += real(word);
            }
        }
    }
}
