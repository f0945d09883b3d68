//! What springs leave of u: a penalty is refused by what it costs, not by its factor.
//!
//! Shares are those of each kind of DOFs by itself ([`super::super::kinds`]).
//! @@ enforce/run/rounding.rs
//! What rounding does to each kind of DOFs ([`super::super::kinds`]).
//!
//! ```text
//! y = M^-1 (r (|b - A x| + e (|A| |x| + |b|)))        random r in +-[1/2, 1], e the share by which terms are wrong
//! ```
//!
//! DOFs that can be compared are as wrong as the growth of rounding says of the largest of them, or as y, if that is more: the growth is that of all
//! unknowns together by the worst x, and where multipliers are far larger than u, in units without units, their rounding is a larger share of u.
//! A number of a kind of its own may be far smaller or larger than others in any unit, and is as wrong as the largest of some y. Cost: a solve, and a few
//! more where there are such kinds. What is left of the equations is seen here however lightly it was taken.

use super::super::refinement::{MeasuredEquations, Refined};
use super::super::singularity::WRONG;
use super::FactoredPart;
use crate::common::RandomForces;

/// The second step as a share of the first, up to which they are taken for a geometric series.
const SHORTER: f64 = 0.5;

impl FactoredPart<'_> {
    /// `|u - u*| / |u*|` of the exact u*, by the first two steps that multipliers would take towards it; none where they do not show it.
    pub fn left_by_springs(&mut self, x: &[f64], rounding: &SolutionRounding) -> Option<f64> {
        let [first, second] = self.steps_to_exact(x)?;
        let exact: Vec<f64> =
            x.iter().zip(&first).zip(&second).map(|((x, first), second)| x + first + second).collect();
        let (first, second, references) = (self.sizes(&first), self.sizes(&second), self.references(&exact, rounding));
        let mut left = 0.0_f64;
        for (kind, (first, second)) in first.into_iter().zip(second).enumerate().filter(|(_, (first, _))| *first > 0.0)
        {
            // Many slow modes may hide behind a fast one: only where all of them are fast is the series known.
            let ratio = if first > rounding.of_kinds[kind] { second / first } else { SHORTER };
            if ratio.is_nan() || ratio > SHORTER {
                return None;
            }
            left = left.max(first / (1.0 - ratio) / references[kind]);
        }
        Some(left)
    }

    /// `|a - b| / |a|` in DOFs.
    pub fn share(&self, a: &[f64], b: &[f64], rounding: &SolutionRounding) -> f64 {
        let off = self.sizes(&difference(a, b)).into_iter().zip(self.references(a, rounding));
        off.map(|(off, reference)| if off > 0.0 { off / reference } else { off }).fold(0.0, f64::max)
    }

    /// The share of u that rounding may make wrong, in the kind that it does most to.
    pub fn rounded(&self, x: &[f64], rounding: &SolutionRounding) -> f64 {
        let of_kinds = rounding.of_kinds.iter().zip(self.references(x, rounding));
        of_kinds.filter(|(_, reference)| *reference > 0.0).map(|(off, reference)| off / reference).fold(WRONG, f64::max)
    }

    /// Corrections of x by `C u - b` with springs, twice. Forces are in balance already: what is left of them is rounding.
    fn steps_to_exact(&mut self, x: &[f64]) -> Option<[Vec<f64>; 2]> {
        let n = self.model.dofs();
        let mut left = difference(&self.part.rhs.0, &self.model.exactly(x));
        left[..n].fill(0.0);
        let first = self.inverse.solve(&left).ok()?;
        let second = self.inverse.solve(&difference(&left, &self.model.exactly(&first))).ok()?;
        Some([first, second])
    }

    /// The largest number of u of each kind, in units without units.
    pub fn sizes(&self, x: &[f64]) -> Vec<f64> {
        self.model.kinds().largest(x.iter().zip(self.model.units()).map(|(x, unit)| x / unit))
    }

    /// The largest number of each kind, or what its loads would do to the stiffness they act on, if that is more; without any stiffness there is no
    /// unit of energy, and nothing to measure loads by.
    pub fn sizes_and_loads(&self, x: &[f64]) -> Vec<f64> {
        let mut sizes = self.sizes(x);
        if self.model.is_stiff() {
            let loads = self.part.rhs.0.iter().zip(self.model.units()).map(|(load, unit)| load * unit);
            let loads = self.model.kinds().largest_load(loads);
            sizes.iter_mut().zip(loads).for_each(|(size, load)| *size = size.max(load));
        }
        sizes
    }

    /// What each kind is measured by: its numbers and loads; where those are no more than rounding, the terms of its equations, or of its forces
    /// where those are no more than that either.
    fn references(&self, x: &[f64], rounding: &SolutionRounding) -> Vec<f64> {
        let sizes = self.sizes_and_loads(x);
        let (kinds, units, mut references) = (self.model.kinds(), self.model.units(), sizes.clone());
        let zeros: Vec<_> = kinds.of_dofs().filter(|&(kind, _)| sizes[kind] <= rounding.of_kinds[kind]).collect();
        let terms = if zeros.is_empty() { Vec::new() } else { self.terms_of_dofs(x) };
        for (kind, j) in zeros {
            let mut terms = terms[j].into_iter().map(|term| term / units[j]);
            let term = terms.find(|term| *term > rounding.of_kinds[kind]).unwrap_or(0.0);
            references[kind] = references[kind].max(term);
        }
        // What nothing knows the size of is measured by all others.
        let top = references.iter().copied().fold(0.0, f64::max);
        references.iter_mut().filter(|size| **size == 0.0).for_each(|size| *size = top);
        references
    }

    /// `max_r (|C| |u| + |b|)_r / |C_rj|`: how large a DOF would be if it made up an equation alone; and the same of forces.
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

/// Solves with errors at random.
const TRIALS: usize = 3;
/// What the largest of few may be short of the largest of all.
const SAFETY: f64 = 2.0;

/// Of one solution.
pub struct SolutionRounding {
    /// The share of the largest number, by the growth of rounding.
    pub share: f64,
    /// The largest error of each kind, in units without units.
    pub of_kinds: Vec<f64>,
}

impl FactoredPart<'_> {
    /// What rounding does to a solution, where it grows so much; none where that is not to be had.
    pub fn rounding(&mut self, refined: &Refined, growth: f64) -> Option<SolutionRounding> {
        let share = refined.rounding.max(WRONG) * growth;
        let mut of_kinds: Vec<f64> = self.sizes_and_loads(&refined.x).into_iter().map(|size| share * size).collect();
        of_kinds[1..].fill(0.0);
        for errors in self.errors(&refined.x) {
            let moved = self.inverse.solve(&errors).ok()?;
            of_kinds.iter_mut().zip(self.sizes(&moved)).for_each(|(most, moved)| *most = most.max(moved));
        }
        Some(SolutionRounding { share, of_kinds })
    }

    /// What is left of the equations and what may be wrong in their terms, at random; where there are many kinds more of the latter.
    fn errors(&self, x: &[f64]) -> Vec<Vec<f64>> {
        let pairs = |ax: Vec<f64>, b: &[f64]| ax.into_iter().zip(b.to_vec());
        let (b, b_sizes) = (&self.part.rhs.0, &self.part.rhs.1);
        let left: Vec<f64> = pairs(self.model.apply(x), b).map(|(ax, b)| b - ax).collect();
        let sizes: Vec<f64> = pairs(self.model.size(x), b_sizes).map(|(ax, b)| WRONG * (ax + b)).collect();
        let mut random = RandomForces::default();
        let both = left.iter().zip(&sizes).map(|(left, size)| random.next() * (left.abs() + size)).collect();
        let mut all = vec![both];
        if self.model.kinds().are_many() {
            all.push(left);
            all.extend((0..TRIALS).map(|_| sizes.iter().map(|size| random.next() * SAFETY * size).collect()));
        }
        all
    }
}
