//! What springs leave of u: a penalty is refused by what it costs, not by its factor.

use super::super::equations::{Equations, largest_of_parts};
use super::Prepared;

/// The second step as a share of the first, up to which they are taken for a geometric series.
const SHORTER: f64 = 0.5;

impl Prepared<'_> {
    /// `|u - u*| / |u|` of the exact u*, by the first two steps that multipliers would take towards it; none where they do not show it.
    pub fn left_by_springs(&mut self, x: &[f64]) -> Option<f64> {
        let [first, second] = self.steps_to_exact(x)?;
        let (first, second) = (self.size_of_dofs(&first), self.size_of_dofs(&second));
        if first == 0.0 {
            return Some(0.0);
        }
        // Many slow modes may hide behind a fast one: only where all of them are fast is the series known.
        let ratio = second / first;
        (ratio <= SHORTER).then(|| first / (1.0 - ratio) / self.reference(x))
    }

    /// `|a - b| / |a|` in DOFs.
    pub fn share(&self, a: &[f64], b: &[f64]) -> f64 {
        let off = self.size_of_dofs(&difference(a, b));
        if off > 0.0 { off / self.reference(a) } else { off }
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

    /// The largest number of u, in units without units.
    fn size_of_dofs(&self, x: &[f64]) -> f64 {
        let mut dofs = x.to_vec();
        dofs[self.model.dofs()..].fill(0.0);
        largest_of_parts(&self.model, &dofs)[0]
    }

    /// What u is measured by. Where equations keep it at zero, that is what its loads would do to the stiffness they act on. Without any there is
    /// no unit of energy, and nothing to measure loads by.
    fn reference(&self, x: &[f64]) -> f64 {
        let size = self.size_of_dofs(x);
        if !self.model.is_stiff() {
            return size;
        }
        let loads = self.part.rhs.0[..self.model.dofs()].iter().zip(self.model.units());
        loads.fold(size, |size, (load, unit)| size.max(load.abs() * unit))
    }
}

fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}
