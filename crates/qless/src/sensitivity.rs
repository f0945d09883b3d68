//! `max_ij |(C_S^-1)_ij|`: how near to dependence the equations are that presolve kept.
//!
//! The smallest change of one coefficient that makes `C_S = L U` singular (kept rows, slaves' columns, scaled) is
//! `1 / max |(C_S^-1)_ij|`, in units of the largest coefficient of its equation: a measure that is 1 for a chain of any length, where the
//! smallest singular value falls with the length. Triangular matrices with harmless diagonals can be nearly
//! singular (Kahan's, Wilkinson's), so presolve must be checked as any backend.
//!
//! A bound of every row sum of `|U^-1| |L^-1|` costs one pass; only where it is large are entries computed.

use crate::ConstraintSystem;
use crate::basis::Basis;
use crate::certificate::History;
use crate::presolve::eliminate::Step;
use crate::scale::{Scaling, ldexp};

/// The largest entry found of `|C_S^-1|` and the slave in whose row it stands; none where all are below `harmless`.
pub(crate) fn largest(
    system: &ConstraintSystem,
    basis: &Basis,
    history: &History,
    scaling: &Scaling,
    harmless: f64,
) -> Option<(u32, f64)> {
    let (slave, bound) = largest_row_sum(system, basis, history, scaling)?;
    if bound <= harmless {
        return None;
    }
    let entry = row_of_inverse(system, basis, history, scaling, slave);
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

/// `(row sum of |L^-1|) / |pivot|` of each slave's equation in scaled numbers, in the order of [`Basis::visit`].
fn inverse_pivots<'a>(
    system: &'a ConstraintSystem,
    basis: &'a Basis,
    history: &History,
    scaling: &'a Scaling,
) -> impl Iterator<Item = f64> + 'a {
    let mut sums = row_sums_of_l(history);
    let blocks = basis.blocks.iter().flat_map(|block| block.slaves.iter().map(|_| 1.0 / block.sigma.max(1e-300)));
    let scale = |step: &Step| ldexp(step.pivot.abs(), scaling.col(step.dof as usize));
    let steps = basis.steps.iter().rev().map(move |step| sums.pop().unwrap_or(1.0) / scale(step));
    let peeled = basis.peeled.iter().rev().map(|&(row, dof)| {
        let entries = &mut system.matrix().row(row as usize);
        let pivot = entries.find(|&(j, _)| j == dof as usize).map_or(1.0, |(_, v)| v);
        1.0 / scaling.entry(row as usize, dof as usize, pivot.abs())
    });
    blocks.chain(steps).chain(peeled)
}

/// The slave with the largest bound of `sum_i |(C_S^-1)_si|`.
fn largest_row_sum(
    system: &ConstraintSystem,
    basis: &Basis,
    history: &History,
    scaling: &Scaling,
) -> Option<(u32, f64)> {
    let mut sum = vec![0.0; system.dofs()];
    let mut own = inverse_pivots(system, basis, history, scaling);
    let mut in_blocks: usize = basis.blocks.iter().map(|block| block.slaves.len()).sum();
    let mut worst = None;
    basis.visit(system, |slave, terms, _| {
        let mut total = own.next().unwrap_or(1.0);
        // Slaves of a block do not rest on one another, and how near to dependence a block is was estimated already.
        if in_blocks > 0 {
            in_blocks -= 1;
        } else {
            let scale = scaling.col(slave as usize);
            for &(j, v) in terms {
                total += ldexp(v.abs(), scaling.col(j as usize) - scale) * sum[j as usize];
            }
            if worst.is_none_or(|(_, most)| total > most) {
                worst = Some((slave, total));
            }
        }
        sum[slave as usize] = total;
    });
    worst
}

/// `max_i |(C_S^-1)_si|` by one transposed solve.
fn row_of_inverse(system: &ConstraintSystem, basis: &Basis, history: &History, scaling: &Scaling, slave: u32) -> f64 {
    let mut rest = vec![0.0; system.dofs()];
    rest[slave as usize] = 1.0;
    let mut largest = 0.0_f64;
    for &(row, dof) in &basis.peeled {
        let value = std::mem::take(&mut rest[dof as usize]);
        if value != 0.0 {
            let i = row as usize;
            let entries = || system.matrix().row(i).map(|(j, v)| (j, scaling.entry(i, j, v)));
            let weight = value / entries().find(|&(j, _)| j == dof as usize).map_or(1.0, |(_, v)| v);
            largest = largest.max(weight.abs());
            entries().filter(|&(j, _)| j != dof as usize).for_each(|(j, v)| rest[j] -= weight * v);
        }
    }
    let mut weights = vec![0.0; basis.steps.len()];
    for (t, step) in basis.steps.iter().enumerate() {
        let value = std::mem::take(&mut rest[step.dof as usize]);
        if value != 0.0 {
            let scaled = |j: u32, v: f64| ldexp(v, scaling.col(j as usize));
            let weight = value / scaled(step.dof, step.pivot);
            weights[t] = weight;
            step.others.iter().for_each(|&(j, v)| rest[j as usize] -= weight * scaled(j, v));
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
