//! Random rounds of all operations of ranks, from a seed: each rank knows the expected results.

use qless_mpi::{Counted, Message, Ranks};

/// Runs rounds and compares the results with the expected ones; returns one line about all ranks.
///
/// # Panics
/// If a result or a count differs.
pub fn play(ranks: &dyn Ranks, seed: u64, rounds: u64) -> String {
    let counted = Counted::new(ranks);
    let mut script = Script { seed, size: ranks.size(), rank: ranks.rank(), sent: [0; 4] };
    for round in 0..rounds {
        script.pause(round);
        script.round(&counted, round);
        let sent = counted.sent();
        assert_eq!([sent.messages, sent.bytes, sent.received, sent.rounds], script.sent, "after round {round}");
    }
    ranks.sum(&mut script.sent);
    let [messages, bytes, received, _] = script.sent;
    format!("{} ranks, {rounds} rounds: {messages} messages of {bytes} bytes, {received} bytes received", ranks.size())
}

/// The expected results of one rank.
struct Script {
    seed: u64,
    size: usize,
    rank: usize,
    /// Messages, their bytes, received bytes, rounds.
    sent: [u64; 4],
}

impl Script {
    /// Any number of places: the same number for the same places.
    fn draw(&self, places: &[u64]) -> u64 {
        places.iter().fold(self.seed, |state, &place| mix(state ^ mix(place)))
    }

    /// Some ranks are late, each time others.
    fn pause(&self, round: u64) {
        let draw = self.draw(&[1, round, self.rank as u64]);
        if draw.is_multiple_of(64) {
            std::thread::sleep(std::time::Duration::from_micros(draw >> 32 & 0x1ff));
        }
    }

    fn round(&mut self, ranks: &dyn Ranks, round: u64) {
        match self.draw(&[2, round]) % 8 {
            0..3 => self.exchange(ranks, round),
            3..5 => self.overlap(ranks, round),
            5 => self.fold(round, |numbers| ranks.sum(numbers), |a, b| a + b),
            6 => self.fold(round, |numbers| ranks.max(numbers), u64::max),
            _ => self.gather(ranks, round),
        }
    }

    fn exchange(&mut self, ranks: &dyn Ranks, round: u64) {
        let must = self.incoming(round);
        assert_eq!(ranks.exchange(self.outgoing(round)), must, "rank {} in round {round}", self.rank);
        self.count(round);
    }

    fn overlap(&mut self, ranks: &dyn Ranks, round: u64) {
        let must = self.incoming(round);
        let from: Vec<usize> = must.iter().map(|message| message.rank).collect();
        let mut worked = 0;
        let came = ranks.overlap(self.outgoing(round), &from, &mut || worked += 1);
        assert_eq!((came, worked), (must, 1), "rank {} in round {round}", self.rank);
        self.count(round);
    }

    /// Sums and maxima are counted as a tree.
    fn fold(&mut self, round: u64, run: impl Fn(&mut [u64]), with: impl Fn(u64, u64) -> u64) {
        let mut numbers = self.numbers(round, self.rank);
        let all: Vec<_> = (0..self.size).map(|rank| self.numbers(round, rank)).collect();
        let must: Vec<u64> = (0..numbers.len()).filter_map(|at| all.iter().map(|own| own[at]).reduce(&with)).collect();
        run(&mut numbers);
        assert_eq!(numbers, must, "rank {} in round {round}", self.rank);
        let levels = (0..64).find(|&levels| 1 << levels >= self.size).expect("few ranks") as u64;
        self.add(levels, levels * 8 * must.len() as u64, levels * 8 * must.len() as u64);
    }

    fn gather(&mut self, ranks: &dyn Ranks, round: u64) {
        let own = self.numbers(round, self.rank);
        let must: Vec<u64> = (0..self.size).flat_map(|rank| self.numbers(round, rank)).collect();
        assert_eq!(ranks.gather(&own), must, "rank {} in round {round}", self.rank);
        let others = self.size as u64 - 1;
        self.add(others, others * 8 * own.len() as u64, others * 8 * own.len() as u64);
    }

    fn numbers(&self, round: u64, rank: usize) -> Vec<u64> {
        (0..self.draw(&[3, round]) % 9).map(|at| self.draw(&[4, round, rank as u64, at]) >> 8).collect()
    }

    fn outgoing(&self, round: u64) -> Vec<Message> {
        self.messages(|other| self.words(round, self.rank, other))
    }

    fn incoming(&self, round: u64) -> Vec<Message> {
        self.messages(|other| self.words(round, other, self.rank))
    }

    fn messages(&self, words: impl Fn(usize) -> Option<Vec<u64>>) -> Vec<Message> {
        (0..self.size).filter_map(|rank| words(rank).map(|words| Message { rank, words })).collect()
    }

    /// What one rank says to another, if anything: often nothing, now and then empty, sometimes too long to travel unasked.
    fn words(&self, round: u64, from: usize, to: usize) -> Option<Vec<u64>> {
        let draw = self.draw(&[5, round, from as u64, to as u64]);
        let silent = draw >> 40 & 7 < self.draw(&[6, round]) % 9;
        let length = if (draw >> 48).is_multiple_of(64) { draw % 20_000 } else { draw % 12 };
        (!silent).then(|| (0..length).map(|at| mix(draw ^ at)).collect())
    }

    fn count(&mut self, round: u64) {
        let (out, came) = (self.outgoing(round), self.incoming(round));
        let others = |messages: &[Message]| -> Vec<u64> {
            let others = messages.iter().filter(|message| message.rank != self.rank);
            others.map(|message| 8 * message.words.len() as u64).collect()
        };
        let (out, came) = (others(&out), others(&came));
        self.add(out.len() as u64, out.iter().sum(), came.iter().sum());
    }

    fn add(&mut self, messages: u64, bytes: u64, received: u64) {
        for (sum, number) in self.sent.iter_mut().zip([messages, bytes, received, 1]) {
            *sum += number;
        }
    }
}

/// SplitMix64.
fn mix(number: u64) -> u64 {
    let number = number.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let number = (number ^ (number >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let number = (number ^ (number >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    number ^ (number >> 31)
}
