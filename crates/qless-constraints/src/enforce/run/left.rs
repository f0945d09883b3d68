//! What springs leave of u: a penalty is refused by what it costs, not by its factor.

use super::super::equations::{Equations, largest_of_parts};
use super::Prepared;

/// The second step as a share of the first, up to which their sum is known to some digits.
const LONGEST: f64 = 1.0 - 1e-6;

impl Prepared<'_> {
    /// `|u - u*| / |u|` of the exact u*, by the first two steps that multipliers would take towards it: a geometric series. The
    /// largest of all connected parts, each in its largest number, in units without units; zero without springs.
    pub fn left_by_springs(&mut self, x: &[f64]) -> f64 {
        if !self.methods.iter().any(|method| method.factor().is_some()) {
            return 0.0;
        }
        self.steps_to_exact(x).map_or(f64::INFINITY, |steps| self.share(x, &steps))
    }

    /// Corrections of x by `C u - b` with springs, twice. Forces are in balance already: what is left of them is rounding.
    fn steps_to_exact(&mut self, x: &[f64]) -> Option<[Vec<f64>; 2]> {
        let n = self.model.dofs();
        let mut left = difference(&self.model.rhs.0, &self.model.exactly(x));
        left[..n].fill(0.0);
        let first = self.inverse.solve(&left).ok()?;
        let second = self.inverse.solve(&difference(&left, &self.model.exactly(&first))).ok()?;
        Some([first, second])
    }

    fn share(&self, x: &[f64], steps: &[Vec<f64>; 2]) -> f64 {
        let of_dofs = |x: &[f64]| {
            let mut dofs = x.to_vec();
            dofs[self.model.dofs()..].fill(0.0);
            largest_of_parts(&self.model, &dofs)
        };
        let (mut size, first, second) = (of_dofs(x), of_dofs(&steps[0]), of_dofs(&steps[1]));
        // Where equations keep u at zero, it is measured by what its loads would do to the stiffness they act on. Without any there is
        // no unit of energy, and nothing to measure loads by.
        let (units, parts) = (self.model.units(), self.model.parts());
        let stiff = self.model.stiff_parts();
        for j in (0..self.model.dofs()).filter(|&j| stiff[parts[j]]) {
            size[parts[j]] = size[parts[j]].max(self.model.rhs.1[j] * units[j]);
        }
        let of_part = |part: usize| {
            if first[part] == 0.0 {
                return 0.0;
            }
            let ratio = second[part] / first[part];
            // Steps that do not get shorter lead anywhere; rounding decides where they hardly do.
            let all = if ratio < LONGEST { first[part] / (1.0 - ratio) } else { f64::INFINITY };
            if size[part] > 0.0 { all / size[part] } else { f64::INFINITY }
        };
        (0..units.len()).map(of_part).fold(0.0, f64::max)
    }
}

fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}
