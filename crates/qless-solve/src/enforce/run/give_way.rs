//! Whether springs hold what the equations that they stand for would not.
//!
//! ```text
//! d <- d - C M^-1 d        gaps d of equations with springs, M = [K C^T; C -1/D]
//! ```
//!
//! Multipliers that take over close gaps, but for a share of about 1 / factor in each step. A gap that stays has `C u = 0` and `K u = C^T D d`:
//! `[K C^T; C 0]` is singular, though M is not. Cost: a solve per step.

use super::super::equations::Equations;
use super::super::factor::uneven;
use super::Prepared;

/// Steps: what closes has then vanished beside what stays.
const STEPS: usize = 4;
/// The share of its gaps that a part may keep in the last step; of more it is not sure that anything closes it.
const CLOSES: f64 = 0.1;

impl Prepared<'_> {
    /// Whether the gaps close.
    pub fn springs_give_way(&mut self) -> bool {
        let (mut gaps, mut stays) = (self.first_gaps(), 0.0);
        for _ in 0..STEPS {
            let Ok(x) = self.inverse.solve(&gaps) else { return false };
            for (gap, closed) in gaps.iter_mut().zip(self.model.exactly(&x)).filter(|(gap, _)| **gap != 0.0) {
                *gap -= closed;
            }
            stays = self.levelled_gaps(&mut gaps);
        }
        // Also where it is no number.
        stays <= CLOSES
    }

    /// A gap for each equation with a spring, of size one in units without units; no two are the same, so that none cancel.
    fn first_gaps(&self) -> Vec<f64> {
        let (n, units) = (self.model.dofs(), self.model.units());
        let mut gaps = vec![0.0; units.len()];
        for row in (0..self.methods.len()).filter(|&row| self.methods[row].factor().is_some()) {
            gaps[n + row] = uneven(1.0, row, units[n + row].sqrt());
        }
        gaps
    }

    /// The largest gap, by which all are divided.
    fn levelled_gaps(&self, gaps: &mut [f64]) -> f64 {
        // Once no number, always none.
        let larger = |most: f64, size: f64| if size > most || size.is_nan() { size } else { most };
        let largest = gaps.iter().zip(self.model.units()).fold(0.0, |most, (gap, unit)| larger(most, gap.abs() * unit));
        gaps.iter_mut().filter(|gap| **gap != 0.0).for_each(|gap| *gap /= largest);
        largest
    }
}
