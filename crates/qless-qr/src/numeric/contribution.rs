//! What a front leaves: `[echelon | Q^T b]` for its parent, `[R | Q^T b]` for the result.

use crate::q::Reflections;

/// The rows of a front behind its pivotal ones, for its parent.
#[derive(Default)]
pub(crate) struct ContributionBlock {
    /// Columns (positions), ascending.
    pub columns: Vec<u32>,
    /// For each row the index in `columns` at which it begins; ascending, 0 first.
    pub lead: Vec<u32>,
    /// Row of A that holds each row, if Q is kept.
    pub names: Vec<u32>,
    /// Column c holds the rows that begin at or before it; then the right-hand sides hold all rows.
    pub values: Vec<f64>,
}

/// What a front gives to the result. Arrays that the analysis knows already stay empty.
#[derive(Default)]
pub(crate) struct Out {
    /// Rows of R.
    pub rank: usize,
    /// Columns of the front that are not pivotal, if they are not all that the pattern allows.
    outer: Option<Vec<u32>>,
    /// Positions within the front of its independent pivotal columns, if they are not the first ones. Row i of R begins
    /// at the i-th.
    lead: Option<Vec<u32>>,
    /// Row by row from where it begins, the right-hand sides behind; then norms of what no column is left for, by
    /// right-hand side, if there is anything.
    pub values: Vec<f64>,
    pub has_rest: bool,
    pub dropped: f64,
    /// If Q is kept.
    pub reflections: Option<Box<Reflections>>,
    /// Rows of the front that are neither rows of R nor left to the parent come from here on.
    pub done: usize,
}

impl Out {
    pub fn new(lead: &[u32], outer: &[u32], all: &[u32], dropped: f64) -> Self {
        let is_plain = lead.iter().zip(0..).all(|(&k, i)| k == i);
        let outer = (!lead.is_empty() && outer.len() < all.len()).then(|| outer.to_vec());
        let lead_kept = (!is_plain).then(|| lead.to_vec());
        Self { rank: lead.len(), outer, lead: lead_kept, dropped, ..Self::default() }
    }

    pub fn outer<'a>(&'a self, all: &'a [u32]) -> &'a [u32] {
        self.outer.as_deref().unwrap_or(all)
    }

    /// Where row i of R begins.
    pub fn lead(&self, i: usize) -> u32 {
        self.lead.as_ref().map_or(i as u32, |lead| lead[i])
    }

    /// The norms behind the rows.
    pub fn rest(&self, count: usize) -> &[f64] {
        if self.has_rest { &self.values[self.values.len() - count..] } else { &[] }
    }
}

/// Packs the rows `from..from + lead.len()` of a front by columns, each as far as it is not zero, then those of the
/// right-hand sides. Row i begins at column `lead[i]`.
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

/// Packs the first rows of a front (right-hand sides included) by rows, row i from column `lead[i]` on. Eight rows at a
/// time, for so many numbers of a column come with one read of memory.
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

/// How many numbers [`pack`] and [`pack_rows`] write for `count` right-hand sides.
pub(super) fn packed_len(cols: usize, lead: &[u32], count: usize) -> usize {
    lead.iter().map(|&k| cols - k as usize + count).sum()
}
