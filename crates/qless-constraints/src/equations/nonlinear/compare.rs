//! Compares the derivatives that a constraint type computes by formulas with those by dual numbers.

use crate::Nonlinear;
use crate::nonlinear::jacobian;
use crate::scalar::Dual;

pub fn compare<Q: Nonlinear>(item: &Q, u: &[f64]) {
    let (m, n) = (Q::EQUATION_NAMES.len(), u.len());
    let (mut c, mut g) = (vec![f64::NAN; m], vec![f64::NAN; m * n]);
    item.value_and_jacobian(u, &mut c, &mut g);
    let (mut value, mut slopes) = (vec![f64::NAN; m], vec![f64::NAN; m * n]);
    jacobian(item, u, &mut value, &mut slopes);
    assert_close(&c, &value);
    assert_close(&g, &slopes);
    item.value(u, &mut value);
    assert_close(&c, &value);

    let w: Vec<f64> = (0..m).map(|r| 1.0 / (r as f64 + 1.5)).collect();
    let mut listed = vec![0.0; n * n];
    let mut pairs = Vec::new();
    item.pairs(n, &mut |j, k| pairs.push((j, k)));
    let numbers = (0..pairs.len()).map(|pair| Q::number(pair) + 1).max().unwrap_or(0);
    let mut h = vec![f64::NAN; numbers];
    item.hessian(u, &w, &mut h);
    pairs.iter().enumerate().for_each(|(pair, &(j, k))| listed[j * n + k] = h[Q::number(pair)]);
    let mut truth = vec![0.0; n * n];
    (0..n).for_each(|j| (0..=j).for_each(|k| truth[j * n + k] = second(item, u, &w, j, k)));
    assert_close(&listed, &truth);
}

/// `sum_r w_r d^2 c_r / du_j du_k` by dual numbers.
fn second<Q: Nonlinear>(item: &Q, u: &[f64], w: &[f64], j: usize, k: usize) -> f64 {
    let mut x: Vec<Dual<1, Dual<1>>> = u.iter().map(|&u| Dual::from(u)).collect();
    (x[j].real.slope[0], x[k].slope[0].real) = (1.0, 1.0);
    let mut c = vec![Dual::from(0.0); w.len()];
    item.value(&x, &mut c);
    c.iter().zip(w).map(|(c, w)| c.slope[0].slope[0] * w).sum()
}

fn assert_close(found: &[f64], truth: &[f64]) {
    let size = truth.iter().fold(1.0, |most: f64, x| most.max(x.abs()));
    for (k, (a, b)) in found.iter().zip(truth).enumerate() {
        assert!((a - b).abs() <= 1e-13 * size, "entry {k}: {a}, by dual numbers {b}");
    }
}
