//! `max_ij |(C_S^-1)_ij|`: how near to dependence the equations are that presolve kept.
//!
//! The smallest change of one coefficient that makes `C_S = L U` singular (kept rows, slaves' columns, scaled) is
//! `1 / max |(C_S^-1)_ij|`, in units of the largest coefficient of its equation: a measure that is 1 for a chain of any length, where the
//! smallest singular value falls with the length. Triangular matrices with harmless diagonals can be nearly
//! singular (Kahan's, Wilkinson's), so presolve must be checked as any backend.
//!
//! A bound of every row sum of `|U^-1| |L^-1|` costs one pass; only where it is large are entries computed.

use crate::basis::Basis;
use crate::certificate::History;
use crate::scale::{Scaling, ldexp};

/// The largest entry found of `|C_S^-1|` and the slave in whose row it stands; none where all are below `harmless`.
pub(crate) fn largest(
    basis: &Basis,
    history: &History,
    scaling: &Scaling,
    dofs: usize,
    harmless: f64,
) -> Option<(u32, f64)> {
    let (slave, bound) = largest_row_sum(basis, history, scaling, dofs)?;
    if bound <= harmless {
        return None;
    }
    let entry = row_of_inverse(basis, history, scaling, slave, dofs);
    (entry > harmless).then_some((slave, entry))
}

/// Row sums of `|L^-1|`, by step: how much of the user's equations goes into each step.
fn row_sums_of_l(history: &History) -> Vec<f64> {
    let mut sums: Vec<f64> = Vec::with_capacity(history.steps.len());
    for &row in &history.steps {
        let parts = history.factors[row as usize].iter().map(|&(step, factor)| factor.abs() * sums[step as usize]);
        let sum = 1.0 + parts.sum::<f64>();
        sums.push(sum);
    }
    sums
}

/// The slave with the largest bound of `sum_i |(C_S^-1)_si|`.
fn largest_row_sum(basis: &Basis, history: &History, scaling: &Scaling, dofs: usize) -> Option<(u32, f64)> {
    let mut sum = vec![0.0; dofs];
    // Slaves of a block do not rest on one another, and how near to dependence a block is was estimated already.
    for (block, kept) in basis.blocks.iter().enumerate() {
        let own = 1.0 / kept.sigma.max(1e-300);
        basis.slaves()[basis.rows_of(block)].iter().for_each(|&slave| sum[slave as usize] = own);
    }
    let of_steps = row_sums_of_l(history);
    let (mut worst, first) = (None, basis.peeled.len());
    for t in (0..first + of_steps.len()).rev() {
        let own = if t < first { 1.0 } else { of_steps[t - first] } / basis.pivot(t).abs();
        let ((dofs, values), slave) = (basis.row(t), basis.slave(t));
        let scale = scaling.col(slave as usize);
        let part = |(&j, v): (&u32, &f64)| ldexp(v.abs(), scaling.col(j as usize) - scale) * sum[j as usize];
        let total = own + dofs.iter().zip(values).map(part).sum::<f64>();
        if worst.is_none_or(|(_, most)| total > most) {
            worst = Some((slave, total));
        }
        sum[slave as usize] = total;
    }
    worst
}

/// `max_i |(C_S^-1)_si|` by one transposed solve.
fn row_of_inverse(basis: &Basis, history: &History, scaling: &Scaling, slave: u32, dofs: usize) -> f64 {
    let mut rest = vec![0.0; dofs];
    rest[slave as usize] = 1.0;
    let (mut largest, first) = (0.0_f64, basis.peeled.len());
    let mut weights = vec![0.0; basis.steps];
    for t in 0..first + basis.steps {
        let own = basis.slave(t);
        let value = std::mem::take(&mut rest[own as usize]);
        if value == 0.0 {
            continue;
        }
        let (dofs, values) = basis.row(t);
        for (&j, &v) in dofs.iter().zip(values) {
            rest[j as usize] += value * ldexp(v, scaling.col(j as usize) - scaling.col(own as usize));
        }
        let weight = value / basis.pivot(t);
        if t < first {
            largest = largest.max(weight.abs());
        } else {
            weights[t - first] = weight;
        }
    }
    for t in (0..weights.len()).rev() {
        let weight = weights[t];
        largest = largest.max(weight.abs());
        let row = history.steps[t] as usize;
        history.factors[row].iter().for_each(|&(step, factor)| weights[step as usize] -= factor * weight);
    }
    largest
}
