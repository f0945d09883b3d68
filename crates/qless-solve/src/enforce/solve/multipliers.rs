//! The equations themselves: a multiplier for each that is not eliminated. What is right here is right, however stiff or soft a spring is.
//!
//! Augmented equations come to this anyway, step by step. Penalties are solved from here ([`super::penalties`]).
//! @@ enforce/run/support.rs
//! Whether the model of a solve is held, or the motion that nothing holds.
//! @@ enforce/run/penalties.rs
//! Penalties from the exact solution: `x <- A^-1 (b + Z x)`, where Z is what springs yield under their multipliers, `1 / D`.
//!
//! ```text
//! [K C^T; C -1/D] [u; lambda] = [f; b]        A = [K C^T; C 0]
//! ```
//!
//! The steps get shorter by what penalties leave of u. Where they do not, no accuracy was to be had; and D may be as large as it likes, since
//! no sum `K + C^T D C` is made.

use qless::{Form, Options, SystemBuilder, analyse};

use super::super::problem::Method;
use super::super::refinement::{BALANCED, FLOOR, MeasuredEquations, Refined, RefinementGoal, SHARP, refine};
use super::super::saddle::{SaddleEquations, spring_stiffness};
use super::super::singularity::{ROUNDING, SHIFTS, SupportVerdict, held, judged, loose};
use super::super::{EnforceError, FreeMotion};
use super::penalty_error::SolutionRounding;
use super::{AUGMENTATIONS, EnforcedPart, FactoredPart, PartSolution, limits};

/// In balance and to the accuracy asked for, or refused.
pub fn by_multipliers(part: &EnforcedPart, accuracy: f64) -> Result<PartSolution, EnforceError> {
    let (mut exact, growth) = supported(part)?;
    let mut refined = exact.refined(accuracy)?;
    if refined.share > 1.0
        && refined.row >= part.dofs.len()
        && let Some(other) = eliminated(part, accuracy)
    {
        (exact, refined) = other;
    }
    let rounding = match exact.rounding(&refined, growth) {
        Some(rounding) if refined.share <= 1.0 && rounding.share < 1.0 => rounding,
        _ => return Err(refused(part, &refined, accuracy)),
    };
    if part.methods.iter().any(|method| matches!(method, Method::Penalty { .. })) {
        return exact.penalised(&refined.x, &rounding, accuracy);
    }
    let stated = exact.rounded(&refined.x, &rounding);
    found(part, refined, stated, accuracy)
}

/// By elimination, where that meets equations that multipliers leave open: terms that are zero are zero in T, and rounding in factors.
fn eliminated<'a>(part: &'a EnforcedPart<'a>, accuracy: f64) -> Option<(FactoredPart<'a>, Refined)> {
    let mut prepared = FactoredPart::new(part, vec![Method::Elimination; part.methods.len()], 0.0).ok()?;
    let refined = prepared.refined(accuracy).ok().filter(|refined| refined.share <= 1.0)?;
    Some((prepared, refined))
}

/// A solution of which `stated` may be wrong: less than the whole, or refused.
pub fn found(part: &EnforcedPart, refined: Refined, stated: f64, accuracy: f64) -> Result<PartSolution, EnforceError> {
    if stated.is_nan() || stated >= 1.0 {
        return Err(refused(part, &refined, accuracy));
    }
    let Refined { x, imbalance, .. } = refined;
    Ok(PartSolution { x, imbalance, accuracy: stated })
}

/// What rounding leaves is too much: of a row, or of an equation that was to be met to less.
fn refused(part: &EnforcedPart, refined: &Refined, tolerance: f64) -> EnforceError {
    let (n, left) = (part.dofs.len(), refined.imbalance);
    match refined.row.checked_sub(n).map(|row| part.methods[row]) {
        Some(Method::Augmented { .. }) if refined.share > 1.0 => EnforceError::NoConvergence { left, tolerance },
        _ => EnforceError::OutOfBalance { row: part.name(refined.row), imbalance: left },
    }
}

/// Factored without springs, and how sensitive u is to rounding; or the motion that nothing holds.
pub fn supported<'a>(part: &'a EnforcedPart<'a>) -> Result<(FactoredPart<'a>, f64), EnforceError> {
    let methods: Vec<Method> = part.methods.iter().map(|method| method.without_spring()).collect();
    let mut prepared = match FactoredPart::new(part, methods.clone(), 0.0) {
        Err(error @ EnforceError::Solver(_)) => return Err(free_motion(part, &methods, error)),
        other => other?,
    };
    let FactoredPart { model, inverse, .. } = &mut prepared;
    match judged(model, &mut |r: &[f64]| inverse.solve(r)) {
        Ok(SupportVerdict::Held(growth)) => Ok((prepared, growth)),
        Ok(SupportVerdict::Loose(motion, held)) => Err(unsupported(part, model, &motion, held)),
        Err(error) => Err(free_motion(part, &methods, error)),
    }
}

/// The motion that a matrix without inverse leaves free; what else went wrong, if nothing is.
fn free_motion(part: &EnforcedPart, methods: &[Method], error: EnforceError) -> EnforceError {
    let motion = |shift: f64| {
        let FactoredPart { model, mut inverse, .. } = FactoredPart::new(part, methods.to_vec(), shift).ok()?;
        let (motion, held) = loose(&model, &mut |r: &[f64]| inverse.solve(r))?;
        Some(unsupported(part, &model, &motion, held))
    };
    SHIFTS.into_iter().find_map(motion).or_else(|| by_elimination(part)).unwrap_or(match error {
        EnforceError::Solver(_) => EnforceError::Singular { what: "the stiffness with its constraints" },
        other => other,
    })
}

/// The rows of A as equations of their own: a solution of `A x = 0` that is not zero. Forces that A cannot carry and motions that it does not feel
/// need have nothing in common here.
fn by_elimination(part: &EnforcedPart) -> Option<EnforceError> {
    let model = SaddleEquations::new(part).ok()?;
    let (n, units) = (model.dofs(), model.units());
    let mut builder = SystemBuilder::new(units.len());
    let mut rows = vec![Vec::new(); units.len()];
    for (i, j, v) in model.entries() {
        rows[i].push((j, units[i] * v * units[j]));
    }
    rows.into_iter().for_each(|row| {
        builder.equation(row, 0.0);
    });
    let analysis = analyse(&builder.build().ok()?, &Options::default()).ok()?;
    let reduction = analysis.reduction_in(Form::Explicit).ok()?;
    let mode = |master: usize| {
        let mut masters = vec![0.0; reduction.masters().len()];
        masters[master] = 1.0;
        let x = reduction.expand(&masters, &[]).ok()?;
        let x: Vec<f64> = x.iter().zip(units).map(|(x, s)| x * s).collect();
        let (motion, share) = held(&model, &x);
        (share <= ROUNDING && motion[..n].iter().any(|u| *u != 0.0)).then(|| unsupported(part, &model, &motion, share))
    };
    (0..reduction.masters().len()).find_map(mode)
}

/// The DOFs of a motion, in the units of the caller.
fn unsupported(part: &EnforcedPart, model: &SaddleEquations, motion: &[f64], held: f64) -> EnforceError {
    let n = model.dofs();
    EnforceError::Unsupported(FreeMotion::new(&motion[..n], &model.units()[..n], held).of(&part.dofs))
}

/// Powers of ten that are tried where a spring is too soft.
const STIFFER: i32 = 6;

impl FactoredPart<'_> {
    /// By penalties, to the accuracy asked for, or refused with a factor that does.
    pub fn penalised(
        &mut self,
        exact: &[f64],
        rounding: &SolutionRounding,
        accuracy: f64,
    ) -> Result<PartSolution, EnforceError> {
        let factor = self.part.methods.iter().filter_map(|method| method.factor()).fold(0.0, f64::max);
        let cost = match self.yielded(exact, (1.0, rounding), accuracy)? {
            (Some(refined), left) if left <= accuracy && left < 1.0 => {
                let stated = self.rounded(exact, rounding) + left;
                return found(self.part, refined, stated, accuracy);
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
        (share, rounding): (f64, &SolutionRounding),
        accuracy: f64,
    ) -> Result<(Option<Refined>, f64), EnforceError> {
        let part = self.part;
        let methods: Vec<Method> = part.methods.iter().map(|method| method.times(share)).collect();
        let model = SaddleEquations::new(part)?.yielding(&methods, &spring_stiffness(part, &methods)?);
        let goal = RefinementGoal {
            floor: &|_| FLOOR,
            limit: &limits(part, accuracy.min(BALANCED)),
            lax: &|_| false,
            enough: SHARP,
            steps: AUGMENTATIONS,
            patient: true,
        };
        let rhs = (&part.rhs.0[..], &part.rhs.1[..]);
        let refined = refine(&model, &mut |r: &[f64]| self.inverse.solve(r), rhs, &goal)?;
        if refined.share <= 1.0 {
            // Less is not to be seen between two solutions.
            let left = self.share(exact, &refined.x, rounding).max(f64::EPSILON);
            return Ok((Some(refined), left));
        }
        let first: Vec<f64> =
            exact.iter().zip(self.inverse.solve(&model.yields(exact))?).map(|(x, step)| x + step).collect();
        Ok((None, self.share(exact, &first, rounding)))
    }
}
