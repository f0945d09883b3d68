//! The SVD `A = U S V^T` of small matrices by one-sided Jacobi rotations, as a reference.

use super::{Matrix, dot, norm};

/// Singular values above zero, descending, with their vectors.
pub struct Svd {
    pub values: Vec<f64>,
    left: Vec<Vec<f64>>,
    right: Vec<Vec<f64>>,
}

impl Svd {
    pub fn new(a: &Matrix) -> Self {
        if a.rows < a.cols {
            let Self { values, left, right } = Self::new(&a.transposed());
            return Self { values, left: right, right: left };
        }
        let mut u: Vec<Vec<f64>> = (0..a.cols).map(|j| a.dense(j)).collect();
        let unit = |j: usize| (0..a.cols).map(|i| f64::from(u8::from(i == j))).collect();
        let mut v: Vec<Vec<f64>> = (0..a.cols).map(unit).collect();
        while sweep(&mut u, &mut v) {}
        let mut order: Vec<usize> = (0..a.cols).filter(|&j| norm(&u[j]) > 0.0).collect();
        order.sort_by(|&p, &q| norm(&u[q]).total_cmp(&norm(&u[p])));
        let scaled = |j: &usize| u[*j].iter().map(|x| x / norm(&u[*j])).collect();
        Self {
            values: order.iter().map(|&j| norm(&u[j])).collect(),
            left: order.iter().map(scaled).collect(),
            right: order.iter().map(|&j| v[j].clone()).collect(),
        }
    }

    pub fn rank(&self, tolerance: f64) -> usize {
        self.values.iter().filter(|&&s| s > tolerance).count()
    }

    /// `x = V_r S_r^{-1} U_r^T b`.
    pub fn shortest(&self, rank: usize, cols: usize, b: &[f64]) -> Vec<f64> {
        let mut x = vec![0.0; cols];
        for k in 0..rank {
            let factor = dot(&self.left[k], b) / self.values[k];
            x.iter_mut().zip(&self.right[k]).for_each(|(x, v)| *x += factor * v);
        }
        x
    }
}

/// Makes each pair of columns orthogonal; returns whether any column changed.
fn sweep(u: &mut [Vec<f64>], v: &mut [Vec<f64>]) -> bool {
    let floor = 1e-17 * u.iter().map(|c| norm(c)).fold(0.0, f64::max);
    let mut turned = false;
    for p in 0..u.len() {
        for q in p + 1..u.len() {
            let (a, b, c) = (dot(&u[p], &u[p]), dot(&u[q], &u[q]), dot(&u[p], &u[q]));
            if c.abs() <= 1e-15 * (a * b).sqrt() || a.sqrt().min(b.sqrt()) <= floor {
                continue;
            }
            turned = true;
            let zeta = (b - a) / (2.0 * c);
            let t = zeta.signum() / (zeta.abs() + zeta.hypot(1.0));
            let cos = 1.0 / t.hypot(1.0);
            for pair in [&mut *u, &mut *v] {
                let (head, tail) = pair.split_at_mut(q);
                for (x, y) in head[p].iter_mut().zip(&mut tail[0]) {
                    (*x, *y) = (cos * (*x - t * *y), cos * (t * *x + *y));
                }
            }
        }
    }
    turned
}
