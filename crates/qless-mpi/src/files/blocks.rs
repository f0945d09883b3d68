//! Numbers dealt to the ranks in blocks of equal size.

use std::ops::Range;

use crate::ranks::Ranks;

/// `count` numbers, the k-th part of them for rank k.
#[derive(Clone, Copy, Debug)]
pub(super) struct Blocks {
    count: u64,
    size: u64,
}

impl Blocks {
    pub fn new(ranks: &dyn Ranks, count: u64) -> Self {
        Self { count, size: ranks.size() as u64 }
    }

    fn start(self, rank: u64) -> u64 {
        (u128::from(self.count) * u128::from(rank) / u128::from(self.size)) as u64
    }

    pub fn of(self, rank: usize) -> Range<u64> {
        self.start(rank as u64)..self.start(rank as u64 + 1)
    }

    /// The rank that holds one of the numbers.
    pub fn holder(self, number: u64) -> usize {
        let last_before = (u128::from(number) + 1) * u128::from(self.size) - 1;
        (last_before / u128::from(self.count)) as usize
    }
}

#[cfg(test)]
mod tests {
    use super::Blocks;

    #[test]
    fn each_number_has_the_holder_in_whose_block_it_is() {
        for (count, size) in (1..30).flat_map(|count| (1..12).map(move |size| (count, size))) {
            let blocks = Blocks { count, size };
            let all: Vec<u64> = (0..size as usize).flat_map(|rank| blocks.of(rank)).collect();
            assert_eq!(all, (0..count).collect::<Vec<_>>());
            assert!(all.iter().all(|&number| blocks.of(blocks.holder(number)).contains(&number)), "{count} on {size}");
        }
    }
}
