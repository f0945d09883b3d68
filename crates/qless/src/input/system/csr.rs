//! `A` as compressed rows: row `i` holds `(col[k], val[k])` for `k` in `start[i]..start[i + 1]`.

/// Sparse m x n matrix in compressed rows; columns ascend within a row and none repeats.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Csr {
    /// Number of columns n.
    pub cols: usize,
    /// Where each row starts in `col` and `val`; length m + 1.
    pub start: Vec<usize>,
    /// 0-based column of each entry.
    pub col: Vec<u32>,
    /// Value of each entry.
    pub val: Vec<f64>,
}

impl Csr {
    /// The 0 x n matrix, ready for [`Csr::push_row`].
    ///
    /// ```
    /// use qless::Csr;
    /// let mut a = Csr::empty(3);
    /// a.push_row([(0, 1.0), (2, -1.0)]);
    /// assert_eq!((a.rows(), a.cols, a.nnz()), (1, 3, 2));
    /// assert_eq!(a.row(0).collect::<Vec<_>>(), [(0, 1.0), (2, -1.0)]);
    /// ```
    pub fn empty(cols: usize) -> Self {
        Self { cols, start: vec![0], col: Vec::new(), val: Vec::new() }
    }

    /// Number of rows m.
    pub fn rows(&self) -> usize {
        self.start.len() - 1
    }

    /// Number of stored entries.
    pub fn nnz(&self) -> usize {
        self.col.len()
    }

    /// The entries `(column, value)` of row `i`.
    pub fn row(&self, i: usize) -> impl ExactSizeIterator<Item = (usize, f64)> + Clone + '_ {
        let range = self.start[i]..self.start[i + 1];
        self.col[range.clone()].iter().zip(&self.val[range]).map(|(&j, &v)| (j as usize, v))
    }

    /// Appends a row; its entries must ascend by column.
    pub fn push_row(&mut self, entries: impl IntoIterator<Item = (usize, f64)>) {
        for (j, v) in entries {
            debug_assert!(j < self.cols);
            self.col.push(j as u32);
            self.val.push(v);
        }
        self.start.push(self.col.len());
    }

    /// `A^T`, n x m, in O(m + n + nnz).
    ///
    /// ```
    /// use qless::Csr;
    /// let mut a = Csr::empty(2);
    /// a.push_row([(1, 5.0)]);
    /// assert_eq!(a.transpose().row(1).collect::<Vec<_>>(), [(0, 5.0)]);
    /// ```
    #[must_use]
    pub fn transpose(&self) -> Self {
        let mut start = vec![0; self.cols + 1];
        for &j in &self.col {
            start[j as usize + 1] += 1;
        }
        for j in 0..self.cols {
            start[j + 1] += start[j];
        }
        let mut next = start.clone();
        let mut col = vec![0; self.nnz()];
        let mut val = vec![0.0; self.nnz()];
        for i in 0..self.rows() {
            for k in self.start[i]..self.start[i + 1] {
                let slot = &mut next[self.col[k] as usize];
                col[*slot] = i as u32;
                val[*slot] = self.val[k];
                *slot += 1;
            }
        }
        Self { cols: self.rows(), start, col, val }
    }

    /// `A x` for x of length n.
    pub fn times(&self, x: &[f64]) -> Vec<f64> {
        (0..self.rows()).map(|i| self.row(i).map(|(j, v)| v * x[j]).sum()).collect()
    }
}
