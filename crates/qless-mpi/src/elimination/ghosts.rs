//! Masters that one rank owns and others use. Who uses which is found once; their values are exchanged in each step.

use std::ops::Range;

use crate::parts::Layout;
use crate::ranks::{Message, Outbox, Ranks, real};

/// The masters that this rank shares with other ranks.
#[derive(Debug)]
pub(super) struct Ghosts {
    /// The range of the own masters among the local ones, which ascend.
    own: Range<usize>,
    /// For each rank with masters of this one: their places among the local ones.
    told: Vec<(usize, Vec<u32>)>,
    /// For each rank that owns local masters: their range among the local ones.
    heard: Vec<(usize, Range<usize>)>,
}

impl Ghosts {
    /// `masters` are the local ones, ascending. Collective.
    pub fn new(ranks: &dyn Ranks, layout: &Layout, masters: &[u64]) -> Self {
        let place = |dof: u64| masters.partition_point(|&master| master < dof);
        let range = layout.owned(ranks.rank());
        let own = place(range.start)..place(range.end);
        let mut post = Outbox::default();
        let mut heard: Vec<(usize, Range<usize>)> = Vec::new();
        let mut start = 0;
        for part in masters.chunk_by(|&a, &b| layout.owner(a) == layout.owner(b)) {
            let owner = layout.owner(part[0]);
            if owner != ranks.rank() {
                post.to(owner).extend_from_slice(part);
                heard.push((owner, start..start + part.len()));
            }
            start += part.len();
        }
        let places = |message: Message| {
            let places = message.words.iter().map(|&dof| place(dof) as u32).collect();
            (message.rank, places)
        };
        let told = post.send(ranks).into_iter().map(places).collect();
        Self { own, told, heard }
    }

    /// Places of the own masters among the local ones.
    pub fn own(&self) -> Range<usize> {
        self.own.clone()
    }

    /// Receives the values of the masters of other ranks from their owners. Collective.
    pub fn gather(&self, ranks: &dyn Ranks, local: &mut [f64], work: &mut dyn FnMut()) {
        let message = |(rank, places): &(usize, Vec<u32>)| Message {
            rank: *rank,
            words: places.iter().map(|&q| local[q as usize].to_bits()).collect(),
        };
        let from: Vec<usize> = self.heard.iter().map(|(rank, _)| *rank).collect();
        let came = ranks.overlap(self.told.iter().map(message).collect(), &from, work);
        for (message, (_, range)) in came.iter().zip(&self.heard) {
            local[range.clone()].iter_mut().zip(&message.words).for_each(|(value, &word)| *value = real(word));
        }
    }

    /// Sends the values for masters of other ranks to their owners, and adds the received values to the own masters in the order of
    /// ranks. Collective.
    pub fn sum(&self, ranks: &dyn Ranks, local: &[f64], masters: &mut [f64]) {
        let message = |(rank, range): &(usize, Range<usize>)| Message {
            rank: *rank,
            words: local[range.clone()].iter().map(|value| value.to_bits()).collect(),
        };
        let from: Vec<usize> = self.told.iter().map(|(rank, _)| *rank).collect();
        let came = ranks.overlap(self.heard.iter().map(message).collect(), &from, &mut || ());
        for (message, (_, places)) in came.iter().zip(&self.told) {
            for (&q, &word) in places.iter().zip(&message.words) {
                masters[q as usize - self.own.start] += real(word);
            }
        }
    }
}
