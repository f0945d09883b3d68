//! Sends and receives messages on MPI.
//!
//! `exchange` is the nonblocking consensus of Hoefler, Siebert and Lumsdaine (Scalable communication protocols for dynamic sparse
//! data exchange, PPoPP 2010). A synchronous send completes when its receiver has begun to receive. A rank whose sends are all
//! complete enters a nonblocking barrier, and keeps receiving until all ranks have entered it: then no message is under way. The cost
//! is that of the messages and one barrier, independent of the number of ranks.
//!
//! Messages are sent in pieces, because MPI counts in 31 bits and some networks lose messages longer than 2 GiB. A full piece is
//! always followed by another, possibly empty one, which marks the end. MPI delivers the pieces of one sender in order for one
//! communicator and tag.

use std::collections::BTreeMap;

use mpi::Tag;
use mpi::point_to_point::{Destination, Message as Arrived, Source, Status};
use mpi::request::{LocalScope, Request};
use mpi::traits::{Communicator, CommunicatorCollectives, Equivalence};

use super::fault::EndOnPanic;
use super::patience::{self, Patience};
use super::{Message, World};

/// Tags of `exchange`, used alternately. A rank may begin the next call while a slower rank still receives messages of the current one. No
/// rank gets two calls ahead.
const ROUND_TAGS: [Tag; 2] = [0, 1];
/// One tag is enough for messages from known senders, because MPI delivers the messages of one sender in order.
const KNOWN_TAG: Tag = 2;

type Sends<'scope, 'a> = Vec<Request<'a, [u64], &'scope LocalScope<'a>>>;

pub(super) fn exchange(world: &World, messages: Vec<Message>) -> Vec<Message> {
    let (own, others) = split_own(world, messages);
    let mut came = BTreeMap::from_iter(own.map(|words| (world.rank, words)));
    let tag = ROUND_TAGS[(world.rounds.replace(world.rounds.get() + 1) % 2) as usize];
    mpi::request::scope(|scope| {
        let sends = send(world, &others, |rank, words| {
            world.communicator.process_at_rank(rank).immediate_synchronous_send_with_tag(scope, words, tag)
        });
        receive_until_all_have_sent(world, sends, tag, &mut came);
    });
    came.into_iter().map(|(rank, words)| Message { rank, words }).collect()
}

fn receive_until_all_have_sent(world: &World, mut sends: Sends, tag: Tag, came: &mut BTreeMap<usize, Vec<u64>>) {
    let mut patience = Patience::new();
    let mut barrier = None;
    let _guard = EndOnPanic;
    loop {
        if let Some(arrived) = world.communicator.any_process().immediate_matched_probe_with_tag(tag) {
            append(came.entry(arrived.1.source_rank() as usize).or_default(), arrived, world.piece);
            patience = Patience::new();
            continue;
        }
        if barrier.is_none() && patience::all_done(&mut sends) {
            barrier = Some(vec![world.communicator.immediate_barrier()]);
        }
        if barrier.as_mut().is_some_and(patience::all_done) {
            return;
        }
        patience.rest();
    }
}

pub(super) fn overlap(world: &World, messages: Vec<Message>, from: &[usize], work: &mut dyn FnMut()) -> Vec<Message> {
    let (mut own, others) = split_own(world, messages);
    mpi::request::scope(|scope| {
        let mut sends = send(world, &others, |rank, words| {
            world.communicator.process_at_rank(rank).immediate_send_with_tag(scope, words, KNOWN_TAG)
        });
        let _guard = EndOnPanic;
        work();
        let came = from.iter().map(|&rank| Message { rank, words: receive(world, rank, &mut own) }).collect();
        patience::until(|| patience::all_done(&mut sends).then_some(()));
        came
    })
}

/// Separates the message of this rank to itself from the other messages.
fn split_own(world: &World, messages: Vec<Message>) -> (Option<Vec<u64>>, Vec<Message>) {
    let (own, others): (Vec<_>, Vec<_>) = messages.into_iter().partition(|message| message.rank == world.rank);
    (own.into_iter().next().map(|message| message.words), others)
}

fn send<'a, R>(world: &World, messages: &'a [Message], send: impl Fn(i32, &'a [u64]) -> R) -> Vec<R> {
    let to_each =
        messages.iter().flat_map(|message| cut(&message.words, world.piece).map(|words| (message.rank as i32, words)));
    to_each.map(|(rank, words)| send(rank, words)).collect()
}

/// # Panics
/// If a rank waits for a message from itself and has sent none.
fn receive(world: &World, rank: usize, own: &mut Option<Vec<u64>>) -> Vec<u64> {
    if rank == world.rank {
        return own.take().unwrap_or_else(|| panic!("rank {rank} waits for a message to itself that it has not sent"));
    }
    let sender = world.communicator.process_at_rank(rank as i32);
    let mut words = Vec::new();
    while !append(&mut words, patience::until(|| sender.immediate_matched_probe_with_tag(KNOWN_TAG)), world.piece) {}
    words
}

/// Default length of a piece: 1 GiB.
pub(super) const WORDS: usize = 1 << 27;

/// The pieces of a message.
fn cut(words: &[u64], piece: usize) -> impl Iterator<Item = &[u64]> {
    (0..=words.len() / piece).map(move |at| &words[at * piece..words.len().min((at + 1) * piece)])
}

/// Appends a piece; returns whether it is the last one.
fn append(words: &mut Vec<u64>, (arrived, status): (Arrived, Status), piece: usize) -> bool {
    let count = status.count(u64::equivalent_datatype()) as usize;
    let before = words.len();
    words.resize(before + count, 0);
    arrived.matched_receive_into(&mut words[before..]);
    count < piece
}

#[cfg(test)]
mod tests {
    use super::cut;

    #[test]
    fn a_full_piece_is_followed_by_another() {
        for length in 0..10_u64 {
            let words: Vec<u64> = (0..length).collect();
            let pieces: Vec<&[u64]> = cut(&words, 3).collect();
            assert_eq!(pieces.concat(), words);
            let (last, full) = pieces.split_last().expect("at least one");
            assert!(last.len() < 3 && full.iter().all(|piece| piece.len() == 3), "{pieces:?}");
        }
    }
}
