//! What a front leaves: `[echelon | Q^T b]` for its parent, `[R | Q^T b]` for the result.

/// The rows of a front behind its pivotal ones, for its parent.
#[derive(Default)]
pub(crate) struct Left {
    /// Columns (positions), ascending.
    pub columns: Vec<u32>,
    /// For each row the index in `columns` at which it begins; ascending, 0 first.
    pub lead: Vec<u32>,
    /// Column c holds the rows that begin at or before it; then the right-hand sides hold all rows.
    pub values: Vec<f64>,
}

/// What a front gives to the result.
#[derive(Default)]
pub(crate) struct Out {
    /// Columns of the front that are not pivotal.
    pub outer: Vec<u32>,
    /// Positions within the front of its independent pivotal columns; row i of R begins at the i-th.
    pub lead: Vec<u32>,
    /// Column by column the rows that begin at or before it; then the right-hand sides, all rows.
    pub values: Vec<f64>,
    /// Norms of what no column is left for, by right-hand side; empty if there is nothing.
    pub rest: Vec<f64>,
    pub dropped: f64,
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

/// How many numbers [`pack`] writes for `count` right-hand sides.
pub(super) fn packed_len(cols: usize, lead: &[u32], count: usize) -> usize {
    lead.iter().map(|&k| cols - k as usize + count).sum()
}
