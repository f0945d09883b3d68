//! `R1 x = z` and `R1^T y = c` by substitution: two operations for each entry of R1 and each right-hand side.

use super::Factor;

impl Factor {
    /// Diagonal and the entries behind it of row i of R1.
    fn upper(&self, i: usize) -> (f64, &[u32], &[f64]) {
        let (from, to) = (self.r.start[i], self.r.start[i + 1]);
        let to = if self.rank() == self.cols() {
            to
        } else {
            from + self.r.col[from..to].partition_point(|&j| (j as usize) < self.rank())
        };
        (self.r.val[from], &self.r.col[from + 1..to], &self.r.val[from + 1..to])
    }

    /// `z <- R1^{-1} z`, z of length r.
    pub(crate) fn back(&self, z: &mut [f64]) {
        for i in (0..self.rank()).rev() {
            let (diagonal, columns, values) = self.upper(i);
            let known = columns.iter().zip(values).fold(0.0, |sum, (&j, &v)| sum + v * z[j as usize]);
            z[i] = (z[i] - known) / diagonal;
        }
    }

    /// `c <- R1^{-T} c`, c of length r.
    pub(crate) fn forward(&self, c: &mut [f64]) {
        for i in 0..self.rank() {
            let (diagonal, columns, values) = self.upper(i);
            c[i] /= diagonal;
            let known = c[i];
            columns.iter().zip(values).for_each(|(&j, &v)| c[j as usize] -= v * known);
        }
    }

    /// `|R1|_1`, the largest sum of a column.
    pub(crate) fn norm_one(&self) -> f64 {
        let mut sums = vec![0.0; self.rank()];
        for i in 0..self.rank() {
            let (diagonal, columns, values) = self.upper(i);
            sums[i] += diagonal.abs();
            columns.iter().zip(values).for_each(|(&j, v)| sums[j as usize] += v.abs());
        }
        sums.into_iter().fold(0.0, f64::max)
    }
}
