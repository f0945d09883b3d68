//! `K + C^T D C`: penalties and augmented equations by the springs they ask for, where those leave no doubt.
//!
//! Nothing is refused here. What springs do not show goes to [`super::multipliers`], at the cost of another factorization.
//! @@ enforce/run/give_way.rs
//! Whether springs hold what the equations that they stand for would not.
//!
//! ```text
//! d <- d - C M^-1 d        gaps d of equations with springs, M = [K C^T; C -1/D]
//! ```
//!
//! Multipliers that take over close gaps, but for a share of about 1 / factor in each step. A gap that stays has `C u = 0` and `K u = C^T D d`:
//! `[K C^T; C 0]` is singular, though M is not. Cost: a solve per step.

use super::super::EnforceError;
use super::super::matrix::uneven;
use super::super::problem::Method;
use super::super::refinement::MeasuredEquations;
use super::super::singularity::{SUSPICIOUS, sensitivity};
use super::{EnforcedPart, FactoredPart, PartSolution, ROUNDED};

/// A solution in balance, to the accuracy asked for; none in doubt.
pub fn by_springs(part: &EnforcedPart, accuracy: f64) -> Result<Option<PartSolution>, EnforceError> {
    match FactoredPart::new(part, part.methods.clone(), 0.0) {
        Ok(mut prepared) => Ok(prepared.without_doubt(accuracy)),
        Err(EnforceError::Solver(_)) => Ok(None),
        Err(other) => Err(other),
    }
}

impl FactoredPart<'_> {
    fn without_doubt(&mut self, accuracy: f64) -> Option<PartSolution> {
        let growth = self.seen_growth()?;
        let refined = self.refined(accuracy).ok().filter(|refined| refined.share <= 1.0)?;
        let rounding = self.rounding(&refined, growth)?;
        let left = self.left_by_springs(&refined.x, &rounding)?;
        // SolutionRounding that multipliers would not have.
        let is_hidden = refined.rounding > ROUNDED && rounding.share > accuracy;
        let is_penalised = self.methods.iter().any(|method| matches!(method, Method::Penalty { .. }));
        let limit = if is_penalised { accuracy.min(1.0) } else { 1.0 };
        let accuracy = self.rounded(&refined.x, &rounding) + left;
        let is_right = accuracy < 1.0 && left <= limit && !is_hidden;
        is_right.then_some(PartSolution { x: refined.x, imbalance: refined.imbalance, accuracy })
    }

    /// How sensitive u is to rounding, if springs neither hide K behind their rounding nor hold what their equations do not.
    fn seen_growth(&mut self) -> Option<f64> {
        let Self { model, inverse, .. } = self;
        // In units without units, like the growth: a factor is relative to the stiffest DOF of its equation, and others feel more.
        let of_rows = inverse.springs().iter().zip(&model.units()[model.dofs()..]);
        let stiffest = of_rows.map(|(spring, unit)| spring / unit / unit).fold(1.0, f64::max);
        let found = sensitivity(model, &mut |r: &[f64]| inverse.solve(r)).ok()?;
        let seen = found.lost.is_none() && found.growth * stiffest < SUSPICIOUS;
        (seen && self.springs_give_way()).then_some(found.growth)
    }
}

/// Steps: what closes has then vanished beside what stays.
const STEPS: usize = 4;
/// The share of its gaps that a part may keep in the last step; of more it is not sure that anything closes it.
const CLOSES: f64 = 0.1;

impl FactoredPart<'_> {
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
