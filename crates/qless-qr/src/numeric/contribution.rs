//! Output of a front: the contribution `[echelon | Q^T b]` to its parent, in echelon form, and `[R | Q^T b]` for the result.

use crate::reflections::Reflections;

/// The rows that a front passes to its parent.
#[derive(Default)]
pub(crate) struct Contribution {
    /// Columns of the passed rows as positions in the column order, ascending.
    pub columns: Vec<u32>,
    /// For each row the index of its first column in `columns`; ascending from 0.
    pub lead: Vec<u32>,
    /// For each row, the row of A whose number it keeps; empty if Q is not kept.
    pub names: Vec<u32>,
    /// Values by columns: each column holds the rows that begin at or before it. The right-hand sides follow, with all rows.
    pub values: Vec<f64>,
}

/// The rows of R from one front. Index lists that equal those of the analysis are not stored.
#[derive(Default)]
pub(crate) struct FrontResult {
    /// Number of rows of R.
    pub rank: usize,
    /// The outer (not pivotal) columns of the front; `None` if they are all that the pattern allows.
    outer: Option<Vec<u32>>,
    /// Positions within the front of its independent pivotal columns; `None` if they are its first columns. Row i of R begins at the
    /// i-th of them.
    lead: Option<Vec<u32>>,
    /// Each row of R from its first column on, followed by its right-hand sides. Then, if `has_rest`, one norm for each
    /// right-hand side, over the rows for which no column is left.
    pub values: Vec<f64>,
    pub has_rest: bool,
    pub dropped: f64,
    /// The reflections, if Q is kept.
    pub reflections: Option<Box<Reflections>>,
    /// First row of the front that is neither a row of R nor passed to the parent.
    pub done: usize,
}

impl FrontResult {
    pub fn new(lead: &[u32], outer: &[u32], all: &[u32], dropped: f64) -> Self {
        let is_plain = lead.iter().zip(0..).all(|(&k, i)| k == i);
        let outer = (!lead.is_empty() && outer.len() < all.len()).then(|| outer.to_vec());
        let lead_kept = (!is_plain).then(|| lead.to_vec());
        Self { rank: lead.len(), outer, lead: lead_kept, dropped, ..Self::default() }
    }

    pub fn outer<'a>(&'a self, all: &'a [u32]) -> &'a [u32] {
        self.outer.as_deref().unwrap_or(all)
    }

    /// First column of row i of R, as a position within the front.
    pub fn lead(&self, i: usize) -> u32 {
        self.lead.as_ref().map_or(i as u32, |lead| lead[i])
    }

    /// The residual norms of `count` right-hand sides, which are stored behind the rows of R.
    pub fn rest(&self, count: usize) -> &[f64] {
        if self.has_rest { &self.values[self.values.len() - count..] } else { &[] }
    }
}

/// Packs the rows `from..from + lead.len()` of a front by columns without the zeros below the staircase, right-hand sides
/// last. Row i begins at column `lead[i]`.
pub(super) fn pack(values: &[f64], rows: usize, cols: usize, from: usize, lead: &[u32], packed: &mut Vec<f64>) {
    let first = lead.first().map_or(cols, |&k| k as usize);
    let mut height = 0;
    for (k, column) in values.chunks_exact(rows).enumerate().skip(first) {
        while height < lead.len() && (k >= cols || lead[height] as usize <= k) {
            height += 1;
        }
        packed.extend_from_slice(&column[from..from + height]);
    }
}

/// Packs the first rows of a front by rows, with their right-hand sides; row i from column `lead[i]` on. Eight rows are
/// packed together because a cache line holds eight numbers of a column.
pub(super) fn pack_rows(values: &[f64], rows: usize, lead: &[u32], packed: &mut Vec<f64>) {
    let columns = values.len() / rows;
    let mut from = 0;
    for (at, group) in lead.chunks(8).enumerate() {
        let start = |&k: &u32| {
            from += columns - k as usize;
            from + k as usize - columns
        };
        let starts: Vec<usize> = group.iter().map(start).collect();
        packed.resize(from, 0.0);
        let top = 8 * at;
        for k in group[0] as usize..columns {
            let column = &values[k * rows + top..k * rows + top + group.len()];
            for ((&value, &start), &lead) in column.iter().zip(&starts).zip(group) {
                if lead as usize <= k {
                    packed[start + k - lead as usize] = value;
                }
            }
        }
    }
}

/// Length of the output of [`pack`] and [`pack_rows`] with `count` right-hand sides.
pub(super) fn packed_len(cols: usize, lead: &[u32], count: usize) -> usize {
    lead.iter().map(|&k| cols - k as usize + count).sum()
}
