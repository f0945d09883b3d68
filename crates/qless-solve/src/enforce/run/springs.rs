//! `K + C^T D C`: penalties and augmented equations by the springs they ask for, where those leave no doubt.
//!
//! Nothing is refused here. What springs do not show goes to [`super::multipliers`], at the cost of another factorization.

use super::super::EnforceError;
use super::super::equations::Equations;
use super::super::support::{SUSPICIOUS, sensitivity};
use super::{Found, Part, Prepared, ROUNDED};

/// A solution in balance, to the accuracy asked for; none in doubt.
pub fn solved(part: &Part, accuracy: f64) -> Result<Option<Found>, EnforceError> {
    match Prepared::new(part, part.methods.clone(), 0.0) {
        Ok(mut prepared) => Ok(prepared.without_doubt(accuracy)),
        Err(EnforceError::Solver(_)) => Ok(None),
        Err(other) => Err(other),
    }
}

impl Prepared<'_> {
    fn without_doubt(&mut self, accuracy: f64) -> Option<Found> {
        let growth = self.seen_growth()?;
        let settled = self.settled(accuracy).ok().filter(|settled| settled.share <= 1.0)?;
        let rounding = self.rounding(&settled, growth)?;
        let left = self.left_by_springs(&settled.x, &rounding)?;
        // Rounding that multipliers would not have.
        let is_hidden = settled.rounding > ROUNDED && rounding.share > accuracy;
        let is_penalised = self.methods.iter().any(|method| matches!(method, super::Method::Penalty { .. }));
        let limit = if is_penalised { accuracy.min(1.0) } else { 1.0 };
        let accuracy = self.rounded(&settled.x, &rounding) + left;
        let is_right = accuracy < 1.0 && left <= limit && !is_hidden;
        is_right.then_some(Found { x: settled.x, imbalance: settled.imbalance, accuracy })
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
