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
use crate::local::Local;
use crate::scale::{Scaling, ldexp};

/// Entries up to this give no reason for doubt.
const HARMLESS: f64 = 3e5;

/// The largest entry of `|C_S^-1|` in the row of the `worst` slave of a [`crate::sweep`], with that slave; none where all are harmless.
pub(crate) fn largest(
    worst: Option<(u32, f64)>,
    system: Local,
    basis: &Basis,
    history: &History,
    scaling: &Scaling,
) -> Option<(u32, f64)> {
    let (slave, _) = worst.filter(|&(_, bound)| bound > HARMLESS)?;
    let entry = row_of_inverse(system, basis, history, scaling, slave);
    (entry > HARMLESS).then_some((slave, entry))
}

/// `max_i |(C_S^-1)_si|` by one transposed solve.
fn row_of_inverse(system: Local, basis: &Basis, history: &History, scaling: &Scaling, slave: u32) -> f64 {
    let mut rest = vec![0.0; system.dofs()];
    rest[slave as usize] = 1.0;
    let (mut largest, first) = (0.0_f64, basis.peeled.len());
    let mut weights = vec![0.0; basis.steps()];
    for t in 0..first + basis.steps() {
        let own = basis.slave(t);
        let value = std::mem::take(&mut rest[own as usize]);
        if value == 0.0 {
            continue;
        }
        let row = basis.row(system, t);
        for (j, v) in row.entries() {
            rest[j as usize] += value * ldexp(v, scaling.col(j as usize) - scaling.col(own as usize));
        }
        let weight = value / basis.pivot(t, &row, scaling);
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
