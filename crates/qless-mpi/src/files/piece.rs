//! The part of a file that each rank reads.

use qless_io::chunk::{ChunkedFile, FileChunk, LineCount};

use super::CaseError;
use super::blocks::Blocks;
use crate::error::agree;
use crate::ranks::Ranks;

/// Lines of this rank, and how many stand before them and in the whole file.
pub(super) struct Piece {
    pub lines: FileChunk,
    pub before: LineCount,
    pub total: LineCount,
}

impl Piece {
    /// What lies behind `start`, dealt out; `head` is what stands before. Whoever sees other `facts` of the file sees another file.
    /// Collective.
    pub fn read(ranks: &dyn Ranks, file: &ChunkedFile, (start, head): (u64, LineCount), facts: &[u64]) -> Result<Self, CaseError> {
        let facts = [&[file.len(), start], facts].concat();
        let of_all = ranks.gather(&facts);
        // Seen by all in the same way.
        if of_all.chunks_exact(facts.len()).any(|of_rank| of_rank != &of_all[..facts.len()]) || start > file.len() {
            return Err(CaseError::differs(file.path()));
        }
        let own = Blocks::new(ranks, file.len() - start).of(ranks.rank());
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
