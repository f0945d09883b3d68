//! `sigma_min(C_S)`, from above: how near to dependence the equations are that presolve kept.
//!
//! `C_S = L U` are the kept rows in the slaves' columns, scaled. A sweep completes a random right-hand side, which shows the slave
//! for which `C_S^-1` is large. Its row of `C_S^-1` by one transposed solve, and that row solved for once more, are a step of
//! inverse iteration from a start that lies in the right direction.

use rayon::prelude::*;

use crate::Csr;
use crate::diagnosis::certificate::History;
use crate::diagnosis::classify::Dependent;
use crate::diagnosis::nullspace_probe::{NullspaceProbe, is_harmless};
use crate::factor::backend::sparse::Sparse;
use crate::factor::backend::{Backend, BackendError};
use crate::input::components::Labels;
use crate::input::numbering::LocalSystem;
use crate::input::scale::{Scaling, ldexp};
use crate::presolve::basis::Basis;

/// Below this the sample is as good as what a closer look would cost.
const ENOUGH: f64 = 64.0;

/// Rows of a component that are factored for the sake of their singular value alone.
const FEW: usize = 1000;

/// What is kept, in all components.
#[derive(Clone, Copy)]
pub(crate) struct KeptRows<'a> {
    pub system: LocalSystem<'a>,
    pub basis: &'a Basis,
    pub history: &'a History,
    pub scaling: &'a Scaling,
}

/// A component: its row of the basis for which `C_S^-1` is largest, and how large.
#[derive(Clone, Copy, Default)]
struct Worst {
    bound: f64,
    row: usize,
    sample: f64,
}

impl Worst {
    fn enter(&mut self, t: usize, bound: f64, sample: f64) {
        self.bound = self.bound.max(bound);
        if sample > self.sample || sample.is_nan() {
            (self.row, self.sample) = (t, sample);
        }
    }
}

impl KeptRows<'_> {
    /// Estimate of the smallest singular value of what presolve kept, at most 1: the least of those of the components, each of
    /// which depends on the component alone. `row(t)` is the user's equation of row t of the basis.
    pub fn sigma(
        self,
        swept: &NullspaceProbe,
        dependent: &[Dependent],
        row: impl Fn(usize) -> usize,
        memory: usize,
    ) -> Result<f64, BackendError> {
        if swept.sample_of_inverse.is_empty() {
            return Ok(1.0 / swept.largest().max(1.0));
        }
        let labels = Labels::of(self.system);
        let mut worst = vec![Worst::default(); labels.count];
        let sizes = swept.bound_of_inverse.iter().zip(&swept.sample_of_inverse);
        for (t, (&bound, &sample)) in sizes.enumerate() {
            worst[labels.of_row[row(t)] as usize].enter(t, bound, sample);
        }
        let mut ranks = vec![0_usize; labels.count];
        labels.of_row.iter().for_each(|&label| ranks[label as usize] += 1);
        dependent.iter().for_each(|d| ranks[labels.of_row[d.row] as usize] -= 1);
        let is_small = |k: usize| ranks[k] <= FEW;
        let harmless = worst.iter().filter(|of| is_harmless(of.bound)).map(|of| 1.0 / of.bound.max(1.0));
        let harmed: Vec<usize> = (0..labels.count).filter(|&k| !is_harmless(worst[k].bound)).collect();
        let (small, mut large): (Vec<usize>, Vec<usize>) = harmed.into_iter().partition(|&k| is_small(k));
        let factored = self.by_factors(&small, &labels, dependent, memory)?;
        let refused = small.iter().zip(&factored).filter(|(_, sigma)| sigma.is_none());
        large.extend(refused.map(|(&k, _)| k));
        let iterated = self.by_iteration(&large, &worst, &labels, row);
        Ok(harmless.chain(factored.into_iter().flatten()).chain(iterated).fold(1.0, f64::min))
    }

    /// Of some components by the factors of their equations; none for those that need more memory than is allowed.
    fn by_factors(
        self,
        which: &[usize],
        labels: &Labels,
        dependent: &[Dependent],
        memory: usize,
    ) -> Result<Vec<Option<f64>>, BackendError> {
        let mut equations = vec![Vec::new(); labels.count];
        let mut is_wanted = vec![false; labels.count];
        which.iter().for_each(|&k| is_wanted[k] = true);
        let mut is_dependent = vec![false; labels.of_row.len()];
        dependent.iter().for_each(|d| is_dependent[d.row] = true);
        for (i, &label) in labels.of_row.iter().enumerate() {
            if is_wanted[label as usize] && !is_dependent[i] {
                equations[label as usize].push(i);
            }
        }
        let of = |&k: &usize| match by_factors(self.system, &equations[k], self.scaling, memory) {
            Err(BackendError::OverLimit { .. }) => Ok(None),
            found => found.map(Some),
        };
        which.par_iter().map(of).collect()
    }

    /// Of some components by a step of inverse iteration, all at once.
    fn by_iteration(self, which: &[usize], worst: &[Worst], labels: &Labels, row: impl Fn(usize) -> usize) -> Vec<f64> {
        let of = |k: usize| worst[k].sample;
        let (near, closer): (Vec<usize>, Vec<usize>) = which.iter().partition(|&&k| of(k) <= ENOUGH);
        let mut out: Vec<f64> = near.into_iter().map(|k| 1.0 / of(k).max(1.0)).collect();
        if closer.is_empty() {
            return out;
        }
        let label = |t: usize| labels.of_row[row(t)] as usize;
        let starts: Vec<usize> = closer.iter().map(|&k| worst[k].row).collect();
        let mut inverse = row_of_inverse(self, &starts);
        let lengths = norms(&inverse, labels.count, label);
        inverse.iter_mut().enumerate().for_each(|(t, v)| *v /= lengths[label(t)]);
        let solutions = norms(&solve(self, inverse), labels.count, label);
        // Blocks have a part in the sample only.
        let sigma = |k: usize| {
            let all = [of(k) / 2.0, lengths[k], solutions[k]];
            let largest = all.into_iter().fold(0.0, f64::max);
            if all.iter().all(|v| v.is_finite()) && lengths[k] > 0.0 { (1.0 / largest).min(1.0) } else { 0.0 }
        };
        out.extend(closer.into_iter().map(sigma));
        out
    }
}

/// 2-norms of a vector by row of the basis, part by part.
fn norms(x: &[f64], count: usize, label: impl Fn(usize) -> usize) -> Vec<f64> {
    let mut largest = vec![0.0_f64; count];
    let mut sums = vec![0.0; count];
    x.iter()
        .enumerate()
        .for_each(|(t, v)| largest[label(t)] = if v.is_nan() { f64::NAN } else { largest[label(t)].max(v.abs()) });
    for (t, v) in x.iter().enumerate().filter(|(_, v)| **v != 0.0) {
        sums[label(t)] += (v / largest[label(t)]).powi(2);
    }
    largest
        .iter()
        .zip(sums)
        .map(|(&largest, sum): (&f64, f64)| if largest == 0.0 { 0.0 } else { largest * sum.sqrt() })
        .collect()
}

/// The smallest singular value of some equations by their factors.
fn by_factors(system: LocalSystem, equations: &[usize], scaling: &Scaling, memory: usize) -> Result<f64, BackendError> {
    let free = |i: usize| system.row(i).filter(|&(j, _)| system.free()[j]);
    let mut dofs: Vec<usize> = equations.iter().flat_map(|&i| free(i)).map(|(j, _)| j).collect();
    dofs.sort_unstable();
    dofs.dedup();
    let mut rows = Csr::empty(dofs.len());
    for &i in equations {
        let place = |j: usize| dofs.binary_search(&j).unwrap_or_default();
        rows.append(free(i).map(|(j, v)| (place(j), scaling.entry(i, j, v))));
    }
    // Local numbers do not ascend within rows: transposing twice sorts them.
    let factor = Sparse { memory }.factor(&rows.transposed().transposed(), &[], 0.0)?;
    Ok(factor.smallest_singular_value().0.min(1.0))
}

/// `e_s^T C_S^-1` for the slaves of some rows, each of another component, by row of the basis; blocks left out.
fn row_of_inverse(kept: KeptRows, rows: &[usize]) -> Vec<f64> {
    let KeptRows { system, basis, history, scaling } = kept;
    let mut rest = vec![0.0; system.dofs()];
    rows.iter().for_each(|&t| rest[basis.slave(t) as usize] = 1.0);
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

/// `C_S^-1 right`, by row of the basis; the slaves of blocks stay at zero.
fn solve(kept: KeptRows, mut right: Vec<f64>) -> Vec<f64> {
    let KeptRows { system, basis, history, scaling } = kept;
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
    basis.slaves().iter().map(|&own| x[own as usize]).collect()
}
