//! Distribution in equal blocks, of row or column numbers and of the bytes of a file.

use std::ops::Range;

use qless_io::chunk::{ChunkedFile, FileChunk, LineCount};

use super::CaseError;
use crate::error::agree;
use crate::ranks::Ranks;

/// The numbers from 0 to `count` - 1 in contiguous blocks of nearly equal size, one block for each of the `size` ranks.
#[derive(Clone, Copy, Debug)]
pub(super) struct NumberBlocks {
    count: u64,
    size: u64,
}

impl NumberBlocks {
    pub fn new(ranks: &dyn Ranks, count: u64) -> Self {
        Self { count, size: ranks.size() as u64 }
    }

    fn start(self, rank: u64) -> u64 {
        (u128::from(self.count) * u128::from(rank) / u128::from(self.size)) as u64
    }

    pub fn of(self, rank: usize) -> Range<u64> {
        self.start(rank as u64)..self.start(rank as u64 + 1)
    }

    /// The rank that holds a number.
    pub fn holder(self, number: u64) -> usize {
        let last_before = (u128::from(number) + 1) * u128::from(self.size) - 1;
        (last_before / u128::from(self.count)) as usize
    }
}

/// The lines of a file that this rank parses. `before` counts the lines that precede them, and `total` all lines of the file.
pub(super) struct FilePiece {
    pub lines: FileChunk,
    pub before: LineCount,
    pub total: LineCount,
}

impl FilePiece {
    /// Distributes the lines from byte `start` over the ranks; `head` counts the lines before it. Returns an error if the file or the
    /// `facts` about it differ between ranks. Collective.
    pub fn read(
        ranks: &dyn Ranks,
        file: &ChunkedFile,
        (start, head): (u64, LineCount),
        facts: &[u64],
    ) -> Result<Self, CaseError> {
        let facts = [&[file.len(), start], facts].concat();
        let of_all = ranks.gather(&facts);
        // All ranks compare the same facts, so all return the same error.
        if of_all.chunks_exact(facts.len()).any(|of_rank| of_rank != &of_all[..facts.len()]) || start > file.len() {
            return Err(CaseError::differs(file.path()));
        }
        let own = NumberBlocks::new(ranks, file.len() - start).of(ranks.rank());
        let lines = agree(ranks, file.lines(start + own.start..start + own.end).map_err(CaseError::from))?;
        let count = lines.count();
        let counts = ranks.gather(&[count.lines as u64, count.items as u64]);
        let mut before = head;
        let mut total = head;
        for (rank, count) in counts.chunks_exact(2).enumerate() {
            let count = LineCount { lines: count[0] as usize, items: count[1] as usize };
            total = total + count;
            if rank < ranks.rank() {
                before = before + count;
            }
        }
        Ok(Self { lines, before, total })
    }
}

#[cfg(test)]
mod tests {
    use super::NumberBlocks;

    #[test]
    fn each_number_has_the_holder_in_whose_block_it_is() {
        for (count, size) in (1..30).flat_map(|count| (1..12).map(move |size| (count, size))) {
            let blocks = NumberBlocks { count, size };
            let all: Vec<u64> = (0..size as usize).flat_map(|rank| blocks.of(rank)).collect();
            assert_eq!(all, (0..count).collect::<Vec<_>>());
            assert!(all.iter().all(|&number| blocks.of(blocks.holder(number)).contains(&number)), "{count} on {size}");
        }
    }
}
