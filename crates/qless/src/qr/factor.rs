//! Triangular solves with `[R1 R2]`.

use super::Factor;

impl Factor {
    /// `R1^-1 z` for z of length r.
    pub fn solve(&self, z: &[f64]) -> Vec<f64> {
        let mut x = z.to_vec();
        for i in (0..self.rank).rev() {
            let mut diagonal = 1.0;
            let mut sum = x[i];
            for (j, v) in self.r.row(i).take_while(|&(j, _)| j < self.rank) {
                if j == i {
                    diagonal = v;
                } else {
                    sum -= v * x[j];
                }
            }
            x[i] = sum / diagonal;
        }
        x
    }

    /// `R1^-T z` for z of length r.
    pub fn solve_transposed(&self, z: &[f64]) -> Vec<f64> {
        let mut x = z.to_vec();
        for i in 0..self.rank {
            let mut row = self.r.row(i).take_while(|&(j, _)| j < self.rank);
            x[i] /= row.next().map_or(1.0, |(_, diagonal)| diagonal);
            let value = x[i];
            row.for_each(|(j, v)| x[j] -= v * value);
        }
        x
    }

    /// `R1^-1 R2`, a vector of length r for each of the n - r dependent columns: how they are made of the others.
    pub fn coefficients(&self) -> Vec<Vec<f64>> {
        let columns = self.r.transpose();
        let solve = |k: usize| {
            let mut z = vec![0.0; self.rank];
            columns.row(k).for_each(|(i, v)| z[i] = v);
            self.solve(&z)
        };
        (self.rank..columns.rows()).map(solve).collect()
    }

    /// Estimate of the smallest singular value of R1, from above, and the place of the largest entry of its right
    /// singular vector: five steps of inverse iteration with `R1^T R1`, each two triangular solves. 1 for no rank at all.
    pub fn smallest_singular_value(&self) -> (f64, usize) {
        if self.rank == 0 {
            return (1.0, 0);
        }
        let mut x: Vec<f64> = (0..self.rank).map(|i| 1.0 + 0.1 * (i % 7) as f64).collect();
        let mut sigma = 0.0;
        for _ in 0..5 {
            let norm = norm(&x);
            x.iter_mut().for_each(|v| *v /= norm);
            let half = self.solve_transposed(&x);
            sigma = 1.0 / self::norm(&half);
            x = self.solve(&half);
        }
        let largest = (0..self.rank).max_by(|&a, &b| x[a].abs().total_cmp(&x[b].abs()).then(b.cmp(&a)));
        (if sigma.is_finite() { sigma } else { 0.0 }, largest.unwrap_or(0))
    }
}

fn norm(x: &[f64]) -> f64 {
    x.iter().map(|v| v * v).sum::<f64>().sqrt()
}
