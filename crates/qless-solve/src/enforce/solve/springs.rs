//! Penalties and augmented equations by `K + C^T D C`, if the result is certain.
//!
//! No model is refused here. If the result is not certain, [`super::multipliers`] solves again, at the cost of another factorization.
//! Springs can hide a mechanism, which their exact equations would leave free:
//!
//! ```text
//! d <- d - C M^-1 d        gaps d of equations with springs, M = [K C^T; C -1/D]
//! ```
//!
//! Multipliers that take over the springs' forces close all gaps except for a fraction of about 1 / factor per step. A gap that stays open
//! has `C u = 0` and `K u = C^T D d`: `[K C^T; C 0]` is singular although M is not. Cost: one solve per step.

use super::super::EnforceError;
use super::super::matrix::uneven;
use super::super::problem::Method;
use super::super::refinement::MeasuredEquations;
use super::super::singularity::{SUSPICIOUS, rounding_growth};
use super::{EnforcedPart, FactoredPart, PartSolution, ROUNDED};

/// A solution in balance and to the requested accuracy; none if it is not certain.
pub fn by_springs(part: &EnforcedPart, accuracy: f64) -> Result<Option<PartSolution>, EnforceError> {
    match FactoredPart::new(part, part.methods.clone(), 0.0) {
        Ok(mut prepared) => Ok(prepared.certain_solution(accuracy)),
        Err(EnforceError::Solver(_)) => Ok(None),
        Err(other) => Err(other),
    }
}

impl FactoredPart<'_> {
    fn certain_solution(&mut self, accuracy: f64) -> Option<PartSolution> {
        let growth = self.certain_growth()?;
        let refined = self.refined(accuracy).ok().filter(|refined| refined.share <= 1.0)?;
        let rounding = self.rounding(&refined, growth)?;
        let penalty_error = self.penalty_error(&refined.x, &rounding)?;
        // Whether springs cause rounding that the solution with multipliers would not have.
        let is_hidden = refined.rounding > ROUNDED && rounding.share > accuracy;
        let is_penalised = self.methods.iter().any(|method| matches!(method, Method::Penalty { .. }));
        let limit = if is_penalised { accuracy.min(1.0) } else { 1.0 };
        let accuracy = self.rounding_share(&refined.x, &rounding) + penalty_error;
        let is_right = accuracy < 1.0 && penalty_error <= limit && !is_hidden;
        is_right.then_some(PartSolution { x: refined.x, imbalance: refined.imbalance, accuracy })
    }

    /// Growth of rounding, if the springs neither make K lose its digits nor hide a mechanism.
    fn certain_growth(&mut self) -> Option<f64> {
        let Self { model, inverse, .. } = self;
        // The stiffest spring in balanced units has no dimension, like the growth. It can exceed the user's factor: that is relative to the
        // stiffest DOF of an equation, whose other DOFs may be softer.
        let of_rows = inverse.springs.iter().zip(&model.units()[model.dofs()..]);
        let stiffest = of_rows.map(|(spring, unit)| spring / unit / unit).fold(1.0, f64::max);
        let found = rounding_growth(model, &mut |r: &[f64]| inverse.solve(r)).ok()?;
        let is_visible = found.lost.is_none() && found.growth * stiffest < SUSPICIOUS;
        (is_visible && self.has_no_hidden_mechanism()).then_some(found.growth)
    }
}

/// Steps after which closing gaps are negligible compared with gaps that stay open.
const STEPS: usize = 4;
/// Largest fraction of the gaps that may remain in the last step.
const CLOSES: f64 = 0.1;

impl FactoredPart<'_> {
    /// Whether all gaps close, so that no mechanism is hidden.
    pub fn has_no_hidden_mechanism(&mut self) -> bool {
        let (mut gaps, mut stays) = (self.first_gaps(), 0.0);
        for _ in 0..STEPS {
            let Ok(x) = self.inverse.solve(&gaps) else { return false };
            for (gap, closed) in gaps.iter_mut().zip(self.model.apply_exact(&x)).filter(|(gap, _)| **gap != 0.0) {
                *gap -= closed;
            }
            stays = self.levelled_gaps(&mut gaps);
        }
        // False for NaN.
        stays <= CLOSES
    }

    /// A gap of dimensionless size between one and two for each equation with a spring. All gaps differ, so that they do not cancel.
    fn first_gaps(&self) -> Vec<f64> {
        let (n, units) = (self.model.dofs(), self.model.units());
        let mut gaps = vec![0.0; units.len()];
        for row in (0..self.methods.len()).filter(|&row| self.methods[row].factor().is_some()) {
            gaps[n + row] = uneven(1.0, row, units[n + row].sqrt());
        }
        gaps
    }

    /// Divides all gaps by the largest one, which is returned.
    fn levelled_gaps(&self, gaps: &mut [f64]) -> f64 {
        // Keeps NaN.
        let larger = |most: f64, size: f64| if size > most || size.is_nan() { size } else { most };
        let largest = gaps.iter().zip(self.model.units()).fold(0.0, |most, (gap, unit)| larger(most, gap.abs() * unit));
        gaps.iter_mut().filter(|gap| **gap != 0.0).for_each(|gap| *gap /= largest);
        largest
    }
}
