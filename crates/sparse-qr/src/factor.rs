//! `Q^T A P = [R1 R2; 0 0]` and `Q^T B`: what a factorization returns.

/// Rows of a sparse matrix: row i has the entries `start[i]..start[i + 1]`, columns ascending.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rows {
    /// Where each row starts; one more than rows.
    pub start: Vec<usize>,
    /// Columns.
    pub col: Vec<u32>,
    /// Values, none of them zero.
    pub val: Vec<f64>,
}

impl Rows {
    /// Columns and values of row i; none for a row that is not there.
    pub fn row(&self, i: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let range = match self.start.get(i..).unwrap_or_default() {
            &[first, last, ..] => first..last,
            _ => 0..0,
        };
        let (col, val) = (self.col.get(range.clone()), self.val.get(range));
        col.into_iter().flatten().zip(val.into_iter().flatten()).map(|(&j, &v)| (j as usize, v))
    }
}

/// A rank-revealing factorization without its Q.
#[derive(Clone, Debug, PartialEq)]
pub struct Factor {
    /// r, the number of columns found independent.
    pub rank: usize,
    /// P: `order[k]` is the column of A at position k; the r independent ones stand first.
    pub order: Vec<usize>,
    /// `[R1 R2]`, r x n; the first entry of row i is in column i.
    pub r: Rows,
    /// First r rows of `Q^T B`, r x k by columns.
    pub rhs: Vec<f64>,
    /// 2-norms of the other rows of `Q^T B`, one for each right-hand side.
    pub rest: Vec<f64>,
    /// Frobenius norm of what was treated as zero.
    pub dropped: f64,
}
