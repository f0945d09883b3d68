//! Messages in pieces, since MPI counts in 31 bits and some networks lose what is longer than 2 GiB.
//!
//! A piece that is full is followed by another, if need be by an empty one: so a receiver knows the end. Pieces of one sender arrive
//! in their order, as MPI promises for one communicator and tag.

use mpi::point_to_point::{Message as Arrived, Status};
use mpi::traits::Equivalence;

/// 1 GiB.
pub(super) const WORDS: usize = 1 << 27;

/// The pieces of a message.
pub(super) fn cut(words: &[u64], piece: usize) -> impl Iterator<Item = &[u64]> {
    (0..=words.len() / piece).map(move |at| &words[at * piece..words.len().min((at + 1) * piece)])
}

/// Appends a piece; whether it is the last one.
pub(super) fn append(words: &mut Vec<u64>, (arrived, status): (Arrived, Status), piece: usize) -> bool {
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
