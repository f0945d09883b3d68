//! Relative errors of u, in dimensionless numbers. Each DOF is compared with a reference:
//!
//! ```text
//! known unit        the largest of all these DOFs, or the largest displacement that a load would cause on the stiffness of its DOF
//! no known unit     the DOF itself
//! rounding only     the terms of the DOF's equations, max_r (|C| |u| + |b|)_r / |C_rj|; if they are rounding too, those of its forces
//! ```
//!
//! Random errors of the terms estimate the rounding y of a solution x; e is their relative size, and M^-1 the computed inverse:
//!
//! ```text
//! y = M^-1 (r (|b - A x| + e (|A| |x| + |b|)))        random r in +-[1/2, 1]
//! ```
//!
//! The error of the DOFs with known units is the larger of y and `e g` times their reference, where g is the growth of rounding. The growth
//! describes all unknowns together. If dimensionless multipliers are far larger than u, their rounding is a larger fraction of u; only y
//! shows this. Cost: one solve, and a few more if units are unknown.

use super::equations::{Equations, Solve};
use super::matrix::entries;
use super::part::EnforcedPart;
use crate::common::{ENTRY_ROUNDING, RandomForces};

/// Number of random solves if a DOF has no known unit. The largest of four random errors of a DOF is seldom far below its largest possible
/// error.
const TRIALS: usize = 4;

/// Estimated rounding errors of the DOFs of one solution, and the references that these errors are compared with.
pub struct DisplacementErrors {
    known: Vec<bool>,
    rounding: Vec<f64>,
    references: Vec<f64>,
}

impl DisplacementErrors {
    /// Estimates the errors of the solution x from the growth of rounding; `solve` applies the computed inverse. None if a solve fails.
    pub fn new(
        part: &EnforcedPart,
        model: &Equations,
        solve: &mut Solve<'_>,
        (x, growth): (&[f64], f64),
    ) -> Option<Self> {
        let known = model.known[..part.dofs.len()].to_vec();
        let mut errors = Self { known, rounding: Vec::new(), references: Vec::new() };
        let mut sizes = errors.levelled(x.iter().copied());
        // Without any stiffness there is no unit of energy: loads then give no reference displacement.
        if part.k.val().iter().any(|v| *v != 0.0) {
            let loads = errors.known.iter().zip(&part.rhs.0).map(|(known, f)| if *known { *f } else { 0.0 });
            let loads = errors.levelled(loads);
            sizes.iter_mut().zip(loads).for_each(|(size, load)| *size = size.max(load));
        }
        let known = errors.known.iter().zip(&sizes);
        errors.rounding =
            known.map(|(known, size)| if *known { ENTRY_ROUNDING * growth * size } else { 0.0 }).collect();
        let terms: Vec<f64> = model.size(x).iter().zip(&part.rhs.1).map(|(ax, b)| ax + b).collect();
        let off: Vec<f64> = model.apply(x).iter().zip(&part.rhs.0).map(|(ax, b)| (ax - b).abs()).collect();
        let mut random = RandomForces::default();
        for _ in 0..if errors.known.contains(&false) { TRIALS } else { 1 } {
            let forces: Vec<f64> =
                terms.iter().zip(&off).map(|(t, off)| random.next() * (off + ENTRY_ROUNDING * t)).collect();
            let moved = errors.levelled(solve(&forces).ok()?.into_iter());
            errors.rounding.iter_mut().zip(moved).for_each(|(most, moved)| *most = most.max(moved));
        }
        errors.references = errors.referenced(sizes, model, &terms);
        Some(errors)
    }

    /// The reference of each DOF is its own size. If that is only rounding, the largest term of the DOF's rows is taken instead, divided by
    /// the DOF's coefficient in that row.
    fn referenced(&self, mut sizes: Vec<f64>, model: &Equations, terms: &[f64]) -> Vec<f64> {
        let n = sizes.len();
        let is_zero: Vec<bool> = sizes.iter().zip(&self.rounding).map(|(size, rounding)| size <= rounding).collect();
        for of_forces in [false, true] {
            for (i, j, v) in entries(&model.a).filter(|&(i, j, v)| j < n && (i < n) == of_forces && v != 0.0) {
                let term = terms[i] / v.abs();
                // The terms of a DOF's force rows are used only if the terms of its constraint rows are rounding as well.
                if is_zero[j] && term > self.rounding[j] && (!of_forces || sizes[j] <= self.rounding[j]) {
                    sizes[j] = sizes[j].max(term);
                }
            }
        }
        let sizes = self.levelled(sizes.into_iter());
        // A DOF without any reference is compared with the largest reference.
        let top = sizes.iter().copied().fold(0.0, f64::max);
        sizes.into_iter().map(|size| if size > 0.0 { size } else { top }).collect()
    }

    /// Largest difference `|a_j - b_j|` of a DOF, relative to the reference of the DOF.
    pub fn between(&self, a: &[f64], b: &[f64]) -> f64 {
        self.relative(&self.levelled(a.iter().zip(b).map(|(a, b)| a - b)))
    }

    /// Largest relative error of a DOF by rounding; at least the rounding of one matrix entry.
    pub fn share(&self) -> f64 {
        self.relative(&self.rounding).max(ENTRY_ROUNDING)
    }

    /// The largest ratio of a DOF's size to its reference; NaN counts as infinite.
    fn relative(&self, sizes: &[f64]) -> f64 {
        let shares = sizes.iter().zip(&self.references).filter(|(size, _)| **size != 0.0);
        shares.fold(0.0, |most: f64, (size, reference)| {
            let share = size / reference;
            if share.is_nan() { f64::INFINITY } else { most.max(share) }
        })
    }

    /// Absolute values of the DOFs. All DOFs with a known unit get the largest value among them.
    fn levelled(&self, values: impl Iterator<Item = f64>) -> Vec<f64> {
        let pairs: Vec<_> = values.zip(&self.known).collect();
        let largest = pairs.iter().filter(|(_, known)| **known).fold(0.0, |most: f64, (v, _)| most.max(v.abs()));
        pairs.into_iter().map(|(v, known)| if *known { largest } else { v.abs() }).collect()
    }
}
