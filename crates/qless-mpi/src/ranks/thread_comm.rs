//! Ranks as threads of one process, for tests and for counting messages.

use std::sync::mpsc::{Receiver, Sender, channel};

use super::{Message, Ranks};

/// One rank. It has a channel to and from each rank, so that messages of different senders do not mix.
struct ThreadRank {
    rank: usize,
    to: Vec<Sender<Vec<u64>>>,
    from: Vec<Receiver<Vec<u64>>>,
}

/// Runs a function on `size` ranks within this process, each on a thread of its own. Returns the results by rank.
///
/// ```
/// use qless_mpi::{Message, Ranks, on_threads};
/// // Each rank sends its number to the next.
/// let received = on_threads(3, |ranks| {
///     let next = (ranks.rank() + 1) % ranks.size();
///     ranks.exchange(vec![Message { rank: next, words: vec![ranks.rank() as u64] }])[0].words[0]
/// });
/// assert_eq!(received, [2, 0, 1]);
/// ```
///
/// # Panics
/// If the function panics on a rank; the other ranks then end too.
pub fn on_threads<T: Send>(size: usize, run: impl Fn(&dyn Ranks) -> T + Sync) -> Vec<T> {
    let mut ranks: Vec<ThreadRank> =
        (0..size).map(|rank| ThreadRank { rank, to: Vec::new(), from: Vec::new() }).collect();
    for receiver in 0..size {
        for sender in 0..size {
            let (to, from) = channel();
            ranks[sender].to.push(to);
            ranks[receiver].from.push(from);
        }
    }
    std::thread::scope(|scope| {
        let run = &run;
        let start = |own: ThreadRank| {
            let named = std::thread::Builder::new().name(format!("rank {}", own.rank));
            named.spawn_scoped(scope, move || run(&own)).expect("a thread for each rank")
        };
        let threads: Vec<_> = ranks.into_iter().map(start).collect();
        threads
            .into_iter()
            .map(|thread| thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
            .collect()
    })
}

impl ThreadRank {
    fn send(&self, rank: usize, words: Vec<u64>) {
        // Sending to a rank that has ended fails. The error is ignored here, because `receive` panics when the answer of that rank is
        // missing.
        let _ = self.to[rank].send(words);
    }

    /// # Panics
    /// If the sending rank has ended.
    fn receive(&self, rank: usize) -> Vec<u64> {
        self.from[rank].recv().unwrap_or_else(|_| panic!("rank {rank} has ended before the others"))
    }

    fn all(&self, numbers: &[u64]) -> Vec<Vec<u64>> {
        (0..self.size()).for_each(|rank| self.send(rank, numbers.to_vec()));
        (0..self.size()).map(|rank| self.receive(rank)).collect()
    }

    fn fold(&self, numbers: &mut [u64], with: impl Fn(u64, u64) -> u64) {
        let all = self.all(numbers);
        for (place, number) in numbers.iter_mut().enumerate() {
            *number = all.iter().map(|of_rank| of_rank[place]).reduce(&with).unwrap_or(*number);
        }
    }
}

impl Ranks for ThreadRank {
    fn rank(&self) -> usize {
        self.rank
    }

    fn size(&self) -> usize {
        self.to.len()
    }

    fn exchange(&self, messages: Vec<Message>) -> Vec<Message> {
        // Every rank gets some words. The last of them says whether a message precedes it.
        let mut out = vec![vec![0]; self.size()];
        for Message { rank, mut words } in messages {
            words.push(1);
            out[rank] = words;
        }
        out.into_iter().enumerate().for_each(|(rank, words)| self.send(rank, words));
        let received = (0..self.size()).map(|rank| (rank, self.receive(rank)));
        received.filter_map(|(rank, mut words)| (words.pop() == Some(1)).then_some(Message { rank, words })).collect()
    }

    fn overlap(&self, messages: Vec<Message>, from: &[usize], work: &mut dyn FnMut()) -> Vec<Message> {
        messages.into_iter().for_each(|Message { rank, words }| self.send(rank, words));
        work();
        from.iter().map(|&rank| Message { rank, words: self.receive(rank) }).collect()
    }

    fn sum(&self, numbers: &mut [u64]) {
        self.fold(numbers, |a, b| a + b);
    }

    fn max(&self, numbers: &mut [u64]) {
        self.fold(numbers, u64::max);
    }

    fn gather(&self, numbers: &[u64]) -> Vec<u64> {
        self.all(numbers).concat()
    }
}
