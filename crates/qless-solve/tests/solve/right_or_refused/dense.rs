//! An independent solution: the dense saddle matrix with scaled rows, orthogonal factors, and residuals in twice the precision.

use faer::prelude::Solve;
use faer::{Mat, MatRef};

use super::models::Model;
use crate::linkages::Outcome;

/// u and the multipliers of the given equations.
pub fn solution(model: &Model, rows: &[usize]) -> Outcome<(Vec<f64>, Vec<f64>)> {
    let n = model.f.len();
    let mut known = vec![None; n];
    model.system.prescribed().iter().for_each(|&(j, value)| known[j] = Some(value));
    let free: Vec<usize> = (0..n).filter(|&j| known[j].is_none()).collect();
    let k = model.k.to_dense();
    let size = free.len() + rows.len();
    let (mut a, mut b) = (Mat::zeros(size, size), vec![Vec::new(); size]);
    for (i, &dof) in free.iter().enumerate() {
        b[i].push((model.f[dof], 1.0));
        free.iter().enumerate().for_each(|(j, &other)| a[(i, j)] = k[(dof, other)]);
        (0..n).filter_map(|j| known[j].map(|u| (k[(dof, j)], -u))).for_each(|term| b[i].push(term));
    }
    for (r, &row) in rows.iter().enumerate() {
        let i = free.len() + r;
        b[i].push((model.system.rhs()[row], 1.0));
        for (dof, v) in model.system.matrix().row(row) {
            if let Some(u) = known[dof] {
                b[i].push((v, -u));
            } else {
                let j = free.binary_search(&dof).map_err(|_| "a free DOF")?;
                (a[(i, j)], a[(j, i)]) = (v, v);
            }
        }
    }
    let x = refined(a.as_ref(), &b);
    let mut u: Vec<f64> = known.iter().map(|known| known.unwrap_or(0.0)).collect();
    free.iter().zip(&x).for_each(|(&dof, &x)| u[dof] = x);
    let mut lambda = vec![0.0; model.system.equations()];
    rows.iter().zip(&x[free.len()..]).for_each(|(&row, &x)| lambda[row] = x);
    Ok((u, lambda))
}

/// `A x = b`, where b is given as sums of products.
fn refined(a: MatRef<f64>, b: &[Vec<(f64, f64)>]) -> Vec<f64> {
    let n = a.nrows();
    let (mut rows, mut columns) = (vec![1.0; n], vec![1.0; n]);
    for _ in 0..4 {
        for i in 0..n {
            let most = (0..n).fold(0.0, |most: f64, j| most.max((rows[i] * a[(i, j)] * columns[j]).abs()));
            rows[i] /= if most > 0.0 { most.sqrt() } else { 1.0 };
        }
        for j in 0..n {
            let most = (0..n).fold(0.0, |most: f64, i| most.max((rows[i] * a[(i, j)] * columns[j]).abs()));
            columns[j] /= if most > 0.0 { most.sqrt() } else { 1.0 };
        }
    }
    let factors = Mat::from_fn(n, n, |i, j| rows[i] * a[(i, j)] * columns[j]).col_piv_qr();
    let mut x = vec![0.0; n];
    for _ in 0..6 {
        let left = Mat::from_fn(n, 1, |i, _| {
            let terms = b[i].iter().copied().chain((0..n).map(|j| (a[(i, j)], -x[j])));
            rows[i] * sum(terms)
        });
        let step = factors.solve(left);
        (0..n).for_each(|j| x[j] += columns[j] * step[(j, 0)]);
    }
    x
}

/// A sum of products in twice the precision.
fn sum(terms: impl Iterator<Item = (f64, f64)>) -> f64 {
    let (mut high, mut low) = (0.0_f64, 0.0_f64);
    for (a, b) in terms {
        let product = a * b;
        let lost = a.mul_add(b, -product);
        let total = high + product;
        let part = total - high;
        low += (high - (total - part)) + (product - part) + lost;
        high = total;
    }
    high + low
}
