//! For random u_q and u_p: `max_i |C_i u - b_i| / (|C_i D| 1 max_j(s_j / d_j) + |b_i|)`, where s_j is the sum of the sizes of
//! the parts that make u_j and D the scaling of columns. From T, G and g as delivered, so that it checks every step before.

use super::Reduction;
use crate::local::Local;
use crate::random::randoms;
use crate::scale::{Scaling, ldexp};

/// Over the `independent` equations.
pub(crate) fn residual(local: Local, reduction: &Reduction, independent: &[bool], scaling: &Scaling) -> f64 {
    let (all, sizes) = expand(reduction);
    let dofs = &local.numbering.dofs;
    let unit = |(l, &j): (usize, &u32)| ldexp(sizes[j as usize], -scaling.col(l));
    let largest = dofs.iter().enumerate().map(unit).fold(0.0, f64::max);
    let mut worst = 0.0_f64;
    for i in (0..local.equations()).filter(|&i| independent[i]) {
        let b = local.rhs()[i];
        let (mut sum, mut size) = (-b, 0.0);
        for (l, v) in local.row(i) {
            sum += v * all[dofs[l] as usize];
            size += ldexp(v.abs(), scaling.col(l));
        }
        // A sum that is no number must not pass for a small one.
        if sum != 0.0 {
            worst = worst
                .max(Some(sum.abs() / (size * largest + b.abs())).filter(|r| !r.is_nan()).unwrap_or(f64::INFINITY));
        }
    }
    worst
}

/// u, and the sums of the sizes of the parts that make each of its numbers.
fn expand(reduction: &Reduction) -> (Vec<f64>, Vec<f64>) {
    let mut random = randoms(1);
    let mut some = |count: usize| random.by_ref().take(count).collect::<Vec<f64>>();
    let (masters, prescribed) = (some(reduction.masters.len()), some(reduction.prescribed.len()));
    let u = reduction.expand(&masters, &prescribed);
    let mut sizes: Vec<f64> = u.iter().map(|v| v.abs()).collect();
    for (i, &slave) in reduction.slaves.iter().enumerate() {
        let by_masters: f64 = reduction.t.row(i).map(|(j, v)| (v * masters[j]).abs()).sum();
        let by_prescribed: f64 = reduction.g_matrix.row(i).map(|(j, v)| (v * prescribed[j]).abs()).sum();
        sizes[slave] = by_masters + by_prescribed + reduction.g[i].abs();
    }
    (u, sizes)
}
