//! What springs leave of u: a penalty is refused by what it costs, not by its factor.
//!
//! Shares are those of each kind of DOFs by itself ([`super::super::kinds`]). Numbers that are rounding beside those of other kinds are no measure
//! of their own kind.

use super::super::equations::Equations;
use super::Prepared;

/// The second step as a share of the first, up to which they are taken for a geometric series.
const SHORTER: f64 = 0.5;

impl Prepared<'_> {
    /// `|u - u*| / |u|` of the exact u*, by the first two steps that multipliers would take towards it; none where they do not show it.
    pub fn left_by_springs(&mut self, x: &[f64], noise: f64) -> Option<f64> {
        let [first, second] = self.steps_to_exact(x)?;
        let (first, second, references) =
            (self.sizes(&first), self.sizes(&second), self.references_of_springs(x, noise));
        let top = references.iter().copied().fold(0.0, f64::max);
        let mut left = 0.0_f64;
        for ((first, second), reference) in
            first.into_iter().zip(second).zip(references).filter(|((first, _), _)| *first > 0.0)
        {
            // Many slow modes may hide behind a fast one: only where all of them are fast is the series known.
            let ratio = if first > noise * top { second / first } else { SHORTER };
            if ratio.is_nan() || ratio > SHORTER {
                return None;
            }
            left = left.max(first / (1.0 - ratio) / reference);
        }
        Some(left)
    }

    /// `|a - b| / |a|` in DOFs.
    pub fn share(&self, a: &[f64], b: &[f64], noise: f64) -> f64 {
        let off = self.sizes(&difference(a, b)).into_iter().zip(self.references_of_springs(a, noise));
        off.map(|(off, reference)| if off > 0.0 { off / reference } else { off }).fold(0.0, f64::max)
    }

    /// What rounding leaves of the kind that has the smallest numbers, where it leaves `noise` of the largest.
    pub fn noise_of_kinds(&self, x: &[f64], noise: f64) -> f64 {
        let references = self.references(x, noise);
        let top = references.iter().copied().fold(0.0, f64::max);
        let least = references.into_iter().filter(|size| *size > 0.0).fold(top, f64::min);
        if top > 0.0 { noise * (top / least) } else { noise }
    }

    /// `|e| / |u|` of errors e of u.
    pub fn share_of(&self, e: &[f64], x: &[f64], noise: f64) -> f64 {
        let off = self.sizes(e).into_iter().zip(self.references(x, noise));
        off.filter(|(_, reference)| *reference > 0.0).map(|(off, reference)| off / reference).fold(0.0, f64::max)
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
    fn sizes(&self, x: &[f64]) -> Vec<f64> {
        self.model.kinds().largest(x.iter().zip(self.model.units()).map(|(x, unit)| x / unit))
    }

    /// What each kind is measured by. Where equations keep it at zero, that is what its loads would do to the stiffness they act on; without any
    /// there is no unit of energy, and nothing to measure loads by.
    fn references(&self, x: &[f64], noise: f64) -> Vec<f64> {
        let mut references = self.sizes(x);
        if self.model.is_stiff() {
            let loads = self.part.rhs.0.iter().zip(self.model.units()).map(|(load, unit)| load * unit);
            let loads = self.model.kinds().largest_load(loads);
            references.iter_mut().zip(loads).for_each(|(size, load)| *size = size.max(load));
        }
        let top = references.iter().copied().fold(0.0, f64::max);
        references.iter_mut().filter(|size| **size <= noise * top).for_each(|size| *size = top);
        references
    }

    /// What springs may leave is measured by these: a DOF of a kind of its own that is zero, by the terms of its equations, if there are any.
    fn references_of_springs(&self, x: &[f64], noise: f64) -> Vec<f64> {
        let (mut references, sizes) = (self.references(x, noise), self.sizes(x));
        let (kinds, units) = (self.model.kinds(), self.model.units());
        let zeros: Vec<_> = kinds.alone().filter(|&(kind, _)| sizes[kind] < references[kind]).collect();
        let terms = if zeros.is_empty() { Vec::new() } else { self.terms_of_dofs(x) };
        for (kind, j) in zeros.into_iter().filter(|&(_, j)| terms[j] > 0.0) {
            references[kind] = references[kind].min(sizes[kind].max(terms[j] / units[j]));
        }
        references
    }

    /// `max_r (|C| |u| + |b|)_r / |C_rj|`: how large a DOF would be if it made up an equation alone.
    fn terms_of_dofs(&self, x: &[f64]) -> Vec<f64> {
        let n = self.model.dofs();
        let sizes: Vec<f64> = self.model.size(x).iter().zip(&self.part.rhs.1).map(|(a, b)| a + b).collect();
        let mut most = vec![0.0_f64; n];
        let of_equations = self.model.entries().filter(|&(i, j, v)| i >= n && j < n && v != 0.0);
        of_equations.for_each(|(i, j, v)| most[j] = most[j].max(sizes[i] / v.abs()));
        most
    }
}

fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}
