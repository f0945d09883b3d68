//! `L^-1 A P = U`: the paper's Gauss elimination of one block (Figure 7, section 3.1).
//!
//! The block is dense. Row by row, the largest entry of the row is the pivot and its column comes to the front; a row
//! whose largest entry is at most the tolerance is numerically dependent and moves to the bottom of the block. Kept as
//! the paper has it, as the baseline beside the orthogonal backends. O(r m n) time, 8 m (n + k) bytes.

use super::{Backend, BackendError, Factor, dense_len};
use crate::Csr;

/// The paper's elimination as a [`Backend`].
#[derive(Clone, Copy, Debug, Default)]
pub struct Gauss;

impl Backend for Gauss {
    fn name(&self) -> &'static str {
        "gauss"
    }

    fn version(&self) -> String {
        format!("gauss (qless {})", env!("CARGO_PKG_VERSION"))
    }

    fn is_orthogonal(&self) -> bool {
        false
    }

    fn factor(&self, columns: &Csr, rhs: &[f64], tolerance: f64) -> Result<Factor, BackendError> {
        let mut block = Block::new(columns, rhs)?;
        let rank = block.triangularize(tolerance);
        Ok(block.into_factor(rank))
    }
}

/// The augmented block `[A B]` by rows (the paper's Step 1), with columns in the order `order`.
struct Block {
    rows: Vec<Vec<f64>>,
    order: Vec<usize>,
    n: usize,
}

impl Block {
    fn new(columns: &Csr, rhs: &[f64]) -> Result<Self, BackendError> {
        let (m, n) = (columns.cols, columns.rows());
        let k = rhs.len().checked_div(m).unwrap_or(0);
        dense_len("gauss", m, n + k)?;
        let mut rows = vec![vec![0.0; n + k]; m];
        for j in 0..n {
            columns.row(j).for_each(|(i, v)| rows[i][j] = v);
        }
        for (i, row) in rows.iter_mut().enumerate() {
            (0..k).for_each(|c| row[n + c] = rhs[c * m + i]);
        }
        Ok(Self { rows, order: (0..n).collect(), n })
    }

    /// Steps 3 and 4: triangular form; dependent rows gather below row `rank`.
    fn triangularize(&mut self, tolerance: f64) -> usize {
        let mut active = self.rows.len();
        let mut k = 0;
        while k < active.min(self.n) {
            let pivot = (k..self.n)
                .max_by(|&a, &b| self.size(k, a).total_cmp(&self.size(k, b)).then(self.order[b].cmp(&self.order[a])));
            if let Some(j) = pivot.filter(|&j| self.size(k, j) > tolerance) {
                self.order.swap(k, j);
                self.eliminate_below(k, active);
                k += 1;
            } else {
                active -= 1;
                self.rows.swap(k, active);
            }
        }
        k
    }

    /// Size of the entry in row i and the column at position j.
    fn size(&self, i: usize, j: usize) -> f64 {
        self.rows[i][self.order[j]].abs()
    }

    fn eliminate_below(&mut self, k: usize, active: usize) {
        let column = self.order[k];
        let (above, below) = self.rows.split_at_mut(k + 1);
        let pivot_row = &above[k];
        for row in below[..active - k - 1].iter_mut().filter(|row| row[column] != 0.0) {
            let factor = row[column] / pivot_row[column];
            row.iter_mut().zip(pivot_row).for_each(|(x, p)| *x -= factor * p);
            row[column] = 0.0;
        }
    }

    fn into_factor(self, rank: usize) -> Factor {
        let k = self.rows.first().map_or(0, |row| row.len() - self.n);
        let mut r = Csr::empty(self.n);
        for (i, row) in self.rows[..rank].iter().enumerate() {
            let entries = self.order.iter().enumerate().skip(i).map(|(p, &j)| (p, row[j]));
            r.push_row(entries.filter(|&(_, v)| v != 0.0));
        }
        let rest_of = |column: usize| self.rows[rank..].iter().map(|row| row[column].powi(2)).sum::<f64>();
        Factor {
            rank,
            r,
            rhs: (0..k).flat_map(|c| self.rows[..rank].iter().map(move |row| row[self.n + c])).collect(),
            rest: (0..k).map(|c| rest_of(self.n + c).sqrt()).collect(),
            dropped: (0..self.n).map(rest_of).sum::<f64>().sqrt(),
            order: self.order,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::qr::check;

    #[test]
    fn identities_hold_on_the_test_families() {
        check::families(&Gauss);
    }

    #[test]
    fn the_largest_entry_of_each_row_is_the_pivot() {
        let columns = check::from_dense(&[vec![1.0, -1.0, 2.0], vec![1.0, 2.0, -1.0], vec![2.0, 1.0, 1.0]]);
        let factor = Gauss.factor(&columns, &[1.0, 0.0, 1.0], 1e-5).expect("small");
        // (12) gives up u3, its largest; (13) + (12) / 2 = 1.5 u1 + 1.5 u2 = 0.5 gives up u1; (14) vanishes.
        assert_eq!((factor.rank, factor.order.as_slice()), (2, [2, 0, 1].as_slice()));
        assert_eq!(factor.r.row(1).collect::<Vec<_>>(), [(1, 1.5), (2, 1.5)]);
        assert_eq!((factor.rhs.as_slice(), factor.rest[0]), ([1.0, 0.5].as_slice(), 0.0));
    }

    #[test]
    fn a_conflict_stays_on_the_right_hand_side() {
        let columns = check::from_dense(&[vec![1.0, -1.0, 2.0], vec![1.0, 2.0, -1.0], vec![2.0, 1.0, 1.0]]);
        assert_eq!(Gauss.factor(&columns, &[1.0, 0.0, 0.0], 1e-5).expect("small").rest, [1.0]);
    }
}
