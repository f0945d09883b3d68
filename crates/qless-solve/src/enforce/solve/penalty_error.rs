//! Errors of u by penalties and by rounding: a penalty is refused by the error that it causes, not by its factor.
//!
//! Errors are relative within each group of DOFs with comparable units ([`super::super::units::UnitGroups`]). Rounding of a solution is
//! estimated by random errors of the terms:
//!
//! ```text
//! y = M^-1 (r (|b - A x| + e (|A| |x| + |b|)))        random r in +-[1/2, 1], e the share by which terms are wrong
//! ```
//!
//! The error of the DOFs with known units is the larger of y and `e g` times the largest of these DOFs, where g is the growth of rounding.
//! The growth describes all unknowns together; if dimensionless multipliers are far larger than u, their rounding is a larger fraction of
//! u, which y shows. A DOF without a known unit may have any size; its error is the largest of several y. Cost: one solve, and four more if
//! there are such DOFs.

use super::super::refinement::{MeasuredEquations, Refined};
use super::super::singularity::WRONG;
use super::FactoredPart;
use crate::common::RandomForces;

/// Two steps count as a geometric series if the second is at most this fraction of the first.
const SHORTER: f64 = 0.5;

impl FactoredPart<'_> {
    /// Relative error `|u - u*| / |u*|` of the penalty solution, extrapolated from the first two steps of multipliers towards the exact u*;
    /// none if the steps do not converge fast enough.
    pub fn penalty_error(&mut self, x: &[f64], rounding: &SolutionRounding) -> Option<f64> {
        let [first, second] = self.corrections_to_exact(x)?;
        let exact: Vec<f64> =
            x.iter().zip(&first).zip(&second).map(|((x, first), second)| x + first + second).collect();
        let (first, second, references) = (self.sizes(&first), self.sizes(&second), self.references(&exact, rounding));
        let mut error = 0.0_f64;
        for (group, (first, second)) in first.into_iter().zip(second).enumerate().filter(|(_, (first, _))| *first > 0.0)
        {
            // A fast mode may hide many slow ones. The series is known only if all modes are fast.
            let ratio = if first > rounding.of_groups[group] { second / first } else { SHORTER };
            if ratio.is_nan() || ratio > SHORTER {
                return None;
            }
            error = error.max(first / (1.0 - ratio) / references[group]);
        }
        Some(error)
    }

    /// `|a - b| / |a|` in the group of DOFs where it is largest.
    pub fn share(&self, a: &[f64], b: &[f64], rounding: &SolutionRounding) -> f64 {
        let off = self.sizes(&difference(a, b)).into_iter().zip(self.references(a, rounding));
        off.map(|(off, reference)| if off > 0.0 { off / reference } else { off }).fold(0.0, f64::max)
    }

    /// Relative error of u by rounding, in the group where it is largest.
    pub fn rounding_share(&self, x: &[f64], rounding: &SolutionRounding) -> f64 {
        let of_groups = rounding.of_groups.iter().zip(self.references(x, rounding));
        of_groups
            .filter(|(_, reference)| *reference > 0.0)
            .map(|(off, reference)| off / reference)
            .fold(WRONG, f64::max)
    }

    /// The first two corrections of x by the gaps `C u - b`. Forces are in balance already; their residual is rounding.
    fn corrections_to_exact(&mut self, x: &[f64]) -> Option<[Vec<f64>; 2]> {
        let n = self.model.dofs();
        let mut residual = difference(&self.part.rhs.0, &self.model.apply_exact(x));
        residual[..n].fill(0.0);
        let first = self.inverse.solve(&residual).ok()?;
        let second = self.inverse.solve(&difference(&residual, &self.model.apply_exact(&first))).ok()?;
        Some([first, second])
    }

    /// The largest displacement of each group, dimensionless.
    pub fn sizes(&self, x: &[f64]) -> Vec<f64> {
        self.model.groups.largest(x.iter().zip(self.model.units()).map(|(x, unit)| x / unit))
    }

    /// For each group, the larger of its largest displacement and the displacement that the loads would cause on the stiffness of their
    /// DOFs. Without any stiffness there is no unit of energy, and loads do not count.
    pub fn sizes_and_loads(&self, x: &[f64]) -> Vec<f64> {
        let mut sizes = self.sizes(x);
        if self.model.is_stiff() {
            let loads = self.part.rhs.0.iter().zip(self.model.units()).map(|(load, unit)| load * unit);
            let loads = self.model.groups.largest_load(loads);
            sizes.iter_mut().zip(loads).for_each(|(size, load)| *size = size.max(load));
        }
        sizes
    }

    /// Reference size of each group: its displacements and loads. If these are rounding, the terms of its equations; if those are rounding
    /// as well, the terms of its forces.
    fn references(&self, x: &[f64], rounding: &SolutionRounding) -> Vec<f64> {
        let sizes = self.sizes_and_loads(x);
        let (groups, units, mut references) = (&self.model.groups, self.model.units(), sizes.clone());
        let zeros: Vec<_> = groups.of_dofs().filter(|&(group, _)| sizes[group] <= rounding.of_groups[group]).collect();
        let terms = if zeros.is_empty() { Vec::new() } else { self.terms_of_dofs(x) };
        for (group, j) in zeros {
            let mut terms = terms[j].into_iter().map(|term| term / units[j]);
            let term = terms.find(|term| *term > rounding.of_groups[group]).unwrap_or(0.0);
            references[group] = references[group].max(term);
        }
        // Groups without a scale use the largest known one.
        let top = references.iter().copied().fold(0.0, f64::max);
        references.iter_mut().filter(|size| **size == 0.0).for_each(|size| *size = top);
        references
    }

    /// `max_r (|C| |u| + |b|)_r / |C_rj|`: the size of a DOF that would make up an equation alone; then the same for forces.
    fn terms_of_dofs(&self, x: &[f64]) -> Vec<[f64; 2]> {
        let n = self.model.dofs();
        let sizes: Vec<f64> = self.model.size(x).iter().zip(&self.part.rhs.1).map(|(a, b)| a + b).collect();
        let mut most = vec![[0.0_f64; 2]; n];
        for (i, j, v) in self.model.entries().filter(|&(_, j, v)| j < n && v != 0.0) {
            let most = &mut most[j][usize::from(i < n)];
            *most = most.max(sizes[i] / v.abs());
        }
        most
    }
}

fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

/// Number of additional random solves with several groups.
const TRIALS: usize = 3;
/// Factor between the largest of few random errors and the largest possible one.
const SAFETY: f64 = 2.0;

/// Effect of rounding on one solution.
pub struct SolutionRounding {
    /// Relative error of the largest displacement, by the growth of rounding.
    pub share: f64,
    /// The largest error of each group, dimensionless.
    pub of_groups: Vec<f64>,
}

impl FactoredPart<'_> {
    /// Effect of rounding on a solution, given the growth; none if a solve fails.
    pub fn rounding(&mut self, refined: &Refined, growth: f64) -> Option<SolutionRounding> {
        let share = refined.rounding.max(WRONG) * growth;
        let mut of_groups: Vec<f64> = self.sizes_and_loads(&refined.x).into_iter().map(|size| share * size).collect();
        of_groups[1..].fill(0.0);
        for errors in self.errors(&refined.x) {
            let moved = self.inverse.solve(&errors).ok()?;
            of_groups.iter_mut().zip(self.sizes(&moved)).for_each(|(most, moved)| *most = most.max(moved));
        }
        Some(SolutionRounding { share, of_groups })
    }

    /// Random errors as large as the residual plus the rounding of the terms. With several groups, also the residual alone, and random
    /// errors of the terms alone.
    fn errors(&self, x: &[f64]) -> Vec<Vec<f64>> {
        let pairs = |ax: Vec<f64>, b: &[f64]| ax.into_iter().zip(b.to_vec());
        let (b, b_sizes) = (&self.part.rhs.0, &self.part.rhs.1);
        let residual: Vec<f64> = pairs(self.model.apply(x), b).map(|(ax, b)| b - ax).collect();
        let sizes: Vec<f64> = pairs(self.model.size(x), b_sizes).map(|(ax, b)| WRONG * (ax + b)).collect();
        let mut random = RandomForces::default();
        let both =
            residual.iter().zip(&sizes).map(|(residual, size)| random.next() * (residual.abs() + size)).collect();
        let mut all = vec![both];
        if self.model.groups.are_many() {
            all.push(residual);
            all.extend((0..TRIALS).map(|_| sizes.iter().map(|size| random.next() * SAFETY * size).collect()));
        }
        all
    }
}
