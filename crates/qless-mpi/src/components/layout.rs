//! Ownership of DOFs: each rank owns a contiguous range.

use std::ops::Range;

use crate::ranks::Ranks;
use crate::share::ShareError;

/// The start of each rank's range; the last number is n, the number of DOFs.
#[derive(Clone, Debug)]
pub(crate) struct Layout {
    starts: Vec<u64>,
}

impl Layout {
    /// Gathers the range of each rank: 16 bytes from each rank to each.
    pub fn new(ranks: &dyn Ranks, owned: &Range<u64>) -> Result<Self, ShareError> {
        let all = ranks.gather(&[owned.start, owned.end]);
        let mut starts = vec![0];
        for (rank, range) in all.chunks_exact(2).enumerate() {
            let expected = starts[rank];
            if range[0] != expected || range[1] < range[0] {
                return Err(ShareError::Ranges { rank, start: range[0], expected });
            }
            if range[1] >= 1 << 62 {
                return Err(ShareError::NumberTooLarge { rank, number: range[1] });
            }
            starts.push(range[1]);
        }
        Ok(Self { starts })
    }

    /// Number of DOFs of the job, n.
    pub fn dofs(&self) -> u64 {
        self.starts[self.starts.len() - 1]
    }

    /// The rank that owns a DOF below n.
    pub fn owner(&self, dof: u64) -> usize {
        self.starts.partition_point(|&start| start <= dof) - 1
    }

    pub fn owned(&self, rank: usize) -> Range<u64> {
        self.starts[rank]..self.starts[rank + 1]
    }
}
