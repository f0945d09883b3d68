//! `C <- (I - V T^T V^T) C`: all reflections of a panel at once (Schreiber, Van Loan 1989), by matrix products.

use faer::linalg::matmul::matmul;
use faer::{Accum, MatMut, MatRef, Par};

/// `V` (h x w by columns) with the factors of its reflections.
pub(super) struct Panel<'a> {
    pub v: &'a [f64],
    pub tau: &'a [f64],
    pub height: usize,
}

impl Panel<'_> {
    /// T, upper triangular: `T_jj = tau_j`, `T_:j = -tau_j T V^T v_j` above.
    fn triangle(&self, t: &mut Vec<f64>) {
        let w = self.tau.len();
        t.clear();
        t.resize(2 * w * w, 0.0);
        let (t, gram) = t.split_at_mut(w * w);
        let v = MatRef::from_column_major_slice(self.v, self.height, w);
        let product = MatMut::from_column_major_slice_mut(gram, w, w);
        matmul(product, Accum::Replace, v.transpose(), v, 1.0, Par::Seq);
        for j in 0..w {
            let (before, column) = t.split_at_mut(j * w);
            for p in 0..j {
                let factor = -self.tau[j] * gram[j * w + p];
                column[..=p].iter_mut().zip(&before[p * w..]).for_each(|(t, b)| *t += factor * b);
            }
            column[j] = self.tau[j];
        }
    }

    /// Applies the transposed reflections to columns of length `stride`, from row `row` on.
    pub fn apply(&self, columns: &mut [f64], stride: usize, row: usize, t: &mut Vec<f64>, w: &mut Vec<f64>) {
        let (width, count) = (self.tau.len(), columns.len() / stride);
        self.triangle(t);
        w.clear();
        w.resize(2 * width * count, 0.0);
        let (first, second) = w.split_at_mut(width * count);
        let v = MatRef::from_column_major_slice(self.v, self.height, width);
        let t = MatRef::from_column_major_slice(&t[..width * width], width, width);
        let all = MatMut::from_column_major_slice_mut(columns, stride, count);
        let mut c = all.subrows_mut(row, self.height);
        let mut first = MatMut::from_column_major_slice_mut(first, width, count);
        let mut second = MatMut::from_column_major_slice_mut(second, width, count);
        matmul(first.as_mut(), Accum::Replace, v.transpose(), c.as_ref(), 1.0, Par::Seq);
        matmul(second.as_mut(), Accum::Replace, t.transpose(), first.as_ref(), 1.0, Par::Seq);
        matmul(c.as_mut(), Accum::Add, v, second.as_ref(), -1.0, Par::Seq);
    }
}
