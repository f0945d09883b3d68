//! A sparse matrix by rows: R.

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
