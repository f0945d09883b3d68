//! Penalties from the exact solution: `x <- A^-1 (b + Z x)`, where Z is what springs yield under their multipliers, `1 / D`.
//!
//! ```text
//! [K C^T; C -1/D] [u; lambda] = [f; b]        A = [K C^T; C 0]
//! ```
//!
//! The steps get shorter by what penalties leave of u. Where they do not, no accuracy was to be had; and D may be as large as it likes, since
//! no sum `K + C^T D C` is made.

use super::super::EnforceError;
use super::super::equations::{BALANCED, FLOOR, Goal, SHARP, Settled, settle};
use super::super::method::{Method, springs};
use super::super::model::Model;
use super::multipliers::found;
use super::rounding::Rounding;
use super::{AUGMENTATIONS, Found, Prepared, limits};

/// Powers of ten that are tried where a spring is too soft.
const STIFFER: i32 = 6;

impl Prepared<'_> {
    /// By penalties, to the accuracy asked for, or refused with a factor that does.
    pub fn penalised(&mut self, exact: &[f64], rounding: &Rounding, accuracy: f64) -> Result<Found, EnforceError> {
        let factor = self.part.methods.iter().filter_map(|method| method.factor()).fold(0.0, f64::max);
        let cost = match self.yielded(exact, (1.0, rounding), accuracy)? {
            (Some(settled), left) if left <= accuracy && left < 1.0 => {
                let stated = self.rounded(exact, rounding) + left;
                return found(self.part, settled, stated, accuracy);
            }
            (Some(_), left) => left,
            (None, left) => left.max(1.0),
        };
        // What is left falls as 1 / factor, once it is small.
        let first = 2.0 * cost.clamp(accuracy, accuracy.max(1e3)) / accuracy;
        let does = |&share: &f64| {
            let found = self.yielded(exact, (share, rounding), accuracy);
            matches!(found, Ok((Some(_), left)) if left <= accuracy && left < 1.0)
        };
        let shares = (0..STIFFER).map(|digits| first * 10_f64.powi(digits));
        let smallest = { shares }.find(does).map(|share| share * factor);
        Err(EnforceError::PenaltyTooSmall { factor, accuracy, cost, smallest })
    }

    /// The solution with all springs times `share`, if the steps lead to it, and the share of u by which it is off, by the first step otherwise.
    fn yielded(
        &mut self,
        exact: &[f64],
        (share, rounding): (f64, &Rounding),
        accuracy: f64,
    ) -> Result<(Option<Settled>, f64), EnforceError> {
        let part = self.part;
        let methods: Vec<Method> = part.methods.iter().map(|method| method.times(share)).collect();
        let model = Model::new(part)?.yielding(&methods, &springs(part, &methods)?);
        let goal = Goal {
            floor: &|_| FLOOR,
            limit: &limits(part, accuracy.min(BALANCED)),
            lax: &|_| false,
            enough: SHARP,
            steps: AUGMENTATIONS,
            patient: true,
        };
        let rhs = (&part.rhs.0[..], &part.rhs.1[..]);
        let settled = settle(&model, &mut |r: &[f64]| self.inverse.solve(r), rhs, &goal)?;
        if settled.share <= 1.0 {
            // Less is not to be seen between two solutions.
            let left = self.share(exact, &settled.x, rounding).max(f64::EPSILON);
            return Ok((Some(settled), left));
        }
        let first: Vec<f64> =
            exact.iter().zip(self.inverse.solve(&model.yields(exact))?).map(|(x, step)| x + step).collect();
        Ok((None, self.share(exact, &first, rounding)))
    }
}
