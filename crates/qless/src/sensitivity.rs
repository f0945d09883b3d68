//! `sigma_min(C_S)`, from above: how near to dependence the equations are that presolve kept.
//!
//! `C_S = L U` are the kept rows in the slaves' columns, scaled. A sweep completes a random right-hand side, which shows the slave
//! for which `C_S^-1` is large. Its row of `C_S^-1` by one transposed solve, and that row solved for once more, are a step of
//! inverse iteration from a start that lies in the right direction.

use crate::Csr;
use crate::basis::Basis;
use crate::certificate::History;
use crate::local::Local;
use crate::qr::sparse::Sparse;
use crate::qr::{Backend, BackendError, norm};
use crate::scale::{Scaling, ldexp};

/// Below this the sample is as good as what a closer look would cost.
const ENOUGH: f64 = 64.0;

/// Below this the sample says all that is worth knowing.
const HARMLESS: f64 = 8.0;

/// Estimate of the smallest singular value of what presolve kept, at most 1; `worst` is the row of the basis with the largest number
/// of a sample, and that number.
pub(crate) fn sigma(
    worst: Option<(usize, f64)>,
    system: Local,
    basis: &Basis,
    history: &History,
    scaling: &Scaling,
) -> f64 {
    let Some((t, size)) = worst else { return 1.0 };
    if size <= ENOUGH {
        return 1.0 / size.max(1.0);
    }
    let mut row = row_of_inverse(system, basis, history, scaling, t);
    let length = norm(&row);
    if !(size.is_finite() && length.is_finite() && length > 0.0) {
        return 0.0;
    }
    row.iter_mut().for_each(|v| *v /= length);
    let solution = norm(&solve(row, system, basis, history, scaling));
    // Blocks have a part in the sample only.
    if solution.is_finite() { (1.0 / solution.max(length).max(size / 2.0)).min(1.0) } else { 0.0 }
}

/// Whether the slaves of presolve may say too little of the rows, and are few enough for a closer look.
pub(crate) fn is_worth_a_look(worst: Option<(usize, f64)>, rank: usize) -> bool {
    worst.is_some_and(|(_, size)| size > HARMLESS) && rank <= FEW
}

/// Rows that are factored for the sake of their singular value alone.
const FEW: usize = 1000;

/// The same of all independent equations by their factors.
pub(crate) fn by_factors(
    system: Local,
    independent: impl Fn(usize) -> bool,
    scaling: &Scaling,
    memory: usize,
) -> Result<f64, BackendError> {
    let mut rows = Csr::empty(system.dofs());
    for i in (0..system.equations()).filter(|&i| independent(i)) {
        let free = system.row(i).filter(|&(j, _)| system.free()[j]);
        rows.push_row(free.map(|(j, v)| (j, scaling.entry(i, j, v))));
    }
    // Local numbers do not ascend within rows: transposing twice sorts them.
    let factor = Sparse { memory }.factor(&rows.transpose().transpose(), &[], 0.0)?;
    Ok(factor.smallest_singular_value().0.min(1.0))
}

/// `e_s^T C_S^-1` for the slave of row t, by row of the basis; blocks left out.
fn row_of_inverse(system: Local, basis: &Basis, history: &History, scaling: &Scaling, t: usize) -> Vec<f64> {
    let mut rest = vec![0.0; system.dofs()];
    rest[basis.slave(t) as usize] = 1.0;
    let first = basis.peeled.len();
    let mut weights = vec![0.0; first + basis.steps()];
    for (t, weight) in weights.iter_mut().enumerate() {
        let own = basis.slave(t);
        let value = std::mem::take(&mut rest[own as usize]);
        if value == 0.0 {
            continue;
        }
        let row = basis.row(system, t);
        for (j, v) in row.entries() {
            rest[j as usize] += value * ldexp(v, scaling.col(j as usize) - scaling.col(own as usize));
        }
        *weight = value / basis.pivot(t, &row, scaling);
    }
    for t in (first..weights.len()).rev() {
        let (weight, row) = (weights[t], history.steps[t - first] as usize);
        history.factors[row].iter().for_each(|&(step, factor)| weights[first + step as usize] -= factor * weight);
    }
    weights
}

/// `C_S^-1 right`; the slaves of blocks stay at zero.
fn solve(mut right: Vec<f64>, system: Local, basis: &Basis, history: &History, scaling: &Scaling) -> Vec<f64> {
    let first = basis.peeled.len();
    for (t, &row) in history.steps.iter().enumerate() {
        let sum: f64 = history.factors[row as usize].iter().map(|&(step, f)| f * right[first + step as usize]).sum();
        right[first + t] -= sum;
    }
    let mut x = vec![0.0; system.dofs()];
    for t in (0..right.len()).rev() {
        let own = basis.slave(t);
        let row = basis.row(system, t);
        let scaled = |(j, v): (u32, f64)| ldexp(v, scaling.col(j as usize) - scaling.col(own as usize)) * x[j as usize];
        let sum: f64 = row.entries().map(scaled).sum();
        x[own as usize] = sum + right[t] / basis.pivot(t, &row, scaling);
    }
    x
}
