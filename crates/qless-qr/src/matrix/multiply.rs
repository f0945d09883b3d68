//! `y + A x` and `y + A^T x`, plain and with twice the digits (Dekker 1971; Ogita, Rump, Oishi 2005).

use super::{Index, Matrix};

impl<P: Index, I: Index> Matrix<'_, P, I> {
    /// `y <- y + s A x`.
    pub(crate) fn add_product(&self, s: f64, x: &[f64], y: &mut [f64]) {
        for k in 0..self.lists() {
            let range = self.list(k);
            let entries = self.index[range.clone()].iter().map(|i| i.position()).zip(&self.values[range]);
            if self.is_by_rows {
                y[k] += s * entries.fold(0.0, |sum, (j, v)| sum + v * x[j]);
            } else {
                let factor = s * x[k];
                entries.for_each(|(i, v)| y[i] += v * factor);
            }
        }
    }

    /// `b - r - A x`, rounded once.
    pub(crate) fn exact_residual(&self, b: &[f64], r: Option<&[f64]>, x: &[f64]) -> Vec<f64> {
        let mut sums: Vec<Twice> = b.iter().map(|&b| Twice { high: b, low: 0.0 }).collect();
        r.into_iter().for_each(|r| sums.iter_mut().zip(r).for_each(|(sum, r)| sum.add(-r)));
        for k in 0..self.lists() {
            for at in self.list(k) {
                let other = self.index[at].position();
                let (i, j) = if self.is_by_rows { (k, other) } else { (other, k) };
                sums[i].add_product(-self.values[at], x[j]);
            }
        }
        sums.into_iter().map(|sum| sum.high + sum.low).collect()
    }
}

/// An unevaluated sum of two numbers.
struct Twice {
    high: f64,
    low: f64,
}

impl Twice {
    fn add(&mut self, v: f64) {
        let sum = self.high + v;
        let part = sum - self.high;
        self.low += (self.high - (sum - part)) + (v - part);
        self.high = sum;
    }

    fn add_product(&mut self, a: f64, b: f64) {
        let product = a * b;
        self.low += a.mul_add(b, -product);
        self.add(product);
    }
}
