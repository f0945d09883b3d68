//! Exact equations: a multiplier for each equation that is not eliminated. The accuracy does not depend on the stiffness of springs.
//!
//! This also decides whether the model is supported. Augmented equations get this solution directly. Penalties start from it:
//! `x <- A^-1 (b + Z x)`, where `Z x = lambda / D` is the displacement of the springs.
//!
//! ```text
//! [K C^T; C -1/D] [u; lambda] = [f; b]        A = [K C^T; C 0]
//! ```
//!
//! The corrections shrink by the relative error of the penalties; if they do not, the penalties are too soft for any accuracy. D may be
//! arbitrarily large, since no sum `K + C^T D C` is formed.

use qless::{Form, Options, SystemBuilder, analyse};

use super::super::problem::Method;
use super::super::refinement::{BALANCED, FLOOR, MeasuredEquations, Refined, RefinementGoal, SHARP, refine};
use super::super::saddle::{SaddleEquations, spring_stiffness};
use super::super::singularity::{ROUNDING, SHIFTS, SupportVerdict, check_support, null_motion, unsupported_part};
use super::super::{EnforceError, FreeMotion};
use super::penalty_error::SolutionRounding;
use super::{AUGMENTATIONS, EnforcedPart, FactoredPart, PartSolution, limits};

/// A solution in balance and to the requested accuracy, or an error.
pub fn by_multipliers(part: &EnforcedPart, accuracy: f64) -> Result<PartSolution, EnforceError> {
    let (mut exact, growth) = supported(part)?;
    let mut refined = exact.refined(accuracy)?;
    if refined.share > 1.0
        && refined.row >= part.dofs.len()
        && let Some(other) = try_elimination(part, accuracy)
    {
        (exact, refined) = other;
    }
    let rounding = match exact.rounding(&refined, growth) {
        Some(rounding) if refined.share <= 1.0 && rounding.share < 1.0 => rounding,
        _ => return Err(residual_error(part, &refined, accuracy)),
    };
    if part.methods.iter().any(|method| matches!(method, Method::Penalty { .. })) {
        return exact.penalised(&refined.x, &rounding, accuracy);
    }
    let accuracy_of_u = exact.rounding_share(&refined.x, &rounding);
    accept(part, refined, accuracy_of_u, accuracy)
}

/// Tries elimination if multipliers leave an equation unsatisfied: terms that are zero stay zero with T, but become rounding with factors
/// of the saddle matrix.
fn try_elimination<'a>(part: &'a EnforcedPart<'a>, accuracy: f64) -> Option<(FactoredPart<'a>, Refined)> {
    let mut prepared = FactoredPart::new(part, vec![Method::Elimination; part.methods.len()], 0.0).ok()?;
    let refined = prepared.refined(accuracy).ok().filter(|refined| refined.share <= 1.0)?;
    Some((prepared, refined))
}

/// A solution with the relative error `accuracy_of_u`, or an error if that is not below one.
pub fn accept(
    part: &EnforcedPart,
    refined: Refined,
    accuracy_of_u: f64,
    accuracy: f64,
) -> Result<PartSolution, EnforceError> {
    if accuracy_of_u.is_nan() || accuracy_of_u >= 1.0 {
        return Err(residual_error(part, &refined, accuracy));
    }
    let Refined { x, imbalance, .. } = refined;
    Ok(PartSolution { x, imbalance, accuracy: accuracy_of_u })
}

/// The error for a residual that rounding keeps above its limit.
fn residual_error(part: &EnforcedPart, refined: &Refined, tolerance: f64) -> EnforceError {
    let (n, residual) = (part.dofs.len(), refined.imbalance);
    match refined.row.checked_sub(n).map(|row| part.methods[row]) {
        Some(Method::Augmented { .. }) if refined.share > 1.0 => EnforceError::NoConvergence { residual, tolerance },
        _ => EnforceError::OutOfBalance { row: part.name(refined.row), imbalance: residual },
    }
}

/// The factored part without springs, and its growth of rounding; or an error with the free motion.
pub fn supported<'a>(part: &'a EnforcedPart<'a>) -> Result<(FactoredPart<'a>, f64), EnforceError> {
    let methods: Vec<Method> = part.methods.iter().map(|method| method.without_spring()).collect();
    let mut prepared = match FactoredPart::new(part, methods.clone(), 0.0) {
        Err(error @ EnforceError::Solver(_)) => return Err(free_motion(part, &methods, error)),
        other => other?,
    };
    let FactoredPart { model, inverse, .. } = &mut prepared;
    match check_support(model, &mut |r: &[f64]| inverse.solve(r)) {
        Ok(SupportVerdict::Supported(growth)) => Ok((prepared, growth)),
        Ok(SupportVerdict::Mechanism(motion, resistance)) => Err(unsupported(part, model, &motion, resistance)),
        Err(error) => Err(free_motion(part, &methods, error)),
    }
}

/// The free motion of a singular matrix; `error` if none is found.
fn free_motion(part: &EnforcedPart, methods: &[Method], error: EnforceError) -> EnforceError {
    let motion = |shift: f64| {
        let FactoredPart { model, mut inverse, .. } = FactoredPart::new(part, methods.to_vec(), shift).ok()?;
        let (motion, resistance) = null_motion(&model, &mut |r: &[f64]| inverse.solve(r))?;
        Some(unsupported(part, &model, &motion, resistance))
    };
    SHIFTS.into_iter().find_map(motion).or_else(|| by_elimination(part)).unwrap_or(match error {
        EnforceError::Solver(_) => EnforceError::Singular { what: "the stiffness with its constraints" },
        other => other,
    })
}

/// Finds a nonzero solution of `A x = 0` by elimination, with the rows of A as equations. Unlike a shift, this also works if the null
/// spaces of A and A^T are orthogonal.
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
        let (motion, share) = unsupported_part(&model, &x);
        (share <= ROUNDING && motion[..n].iter().any(|u| *u != 0.0)).then(|| unsupported(part, &model, &motion, share))
    };
    (0..reduction.masters().len()).find_map(mode)
}

/// The error with the free motion in the caller's numbering.
fn unsupported(part: &EnforcedPart, model: &SaddleEquations, motion: &[f64], resistance: f64) -> EnforceError {
    let n = model.dofs();
    EnforceError::Unsupported(FreeMotion::new(&motion[..n], &model.units()[..n], resistance).renumbered(&part.dofs))
}

/// Number of powers of ten that are tried as larger factors.
const STIFFER: i32 = 6;

impl FactoredPart<'_> {
    /// Penalties to the requested accuracy, or an error with a sufficient factor.
    pub fn penalised(
        &mut self,
        exact: &[f64],
        rounding: &SolutionRounding,
        accuracy: f64,
    ) -> Result<PartSolution, EnforceError> {
        let factor = self.part.methods.iter().filter_map(|method| method.factor()).fold(0.0, f64::max);
        let cost = match self.yielded(exact, (1.0, rounding), accuracy)? {
            (Some(refined), error) if error <= accuracy && error < 1.0 => {
                let accuracy_of_u = self.rounding_share(exact, rounding) + error;
                return accept(self.part, refined, accuracy_of_u, accuracy);
            }
            (Some(_), error) => error,
            (None, error) => error.max(1.0),
        };
        // The error falls as 1 / factor once it is small.
        let first = 2.0 * cost.clamp(accuracy, accuracy.max(1e3)) / accuracy;
        let does = |&share: &f64| {
            let found = self.yielded(exact, (share, rounding), accuracy);
            matches!(found, Ok((Some(_), error)) if error <= accuracy && error < 1.0)
        };
        let shares = (0..STIFFER).map(|digits| first * 10_f64.powi(digits));
        let smallest = { shares }.find(does).map(|share| share * factor);
        Err(EnforceError::PenaltyTooSmall { factor, accuracy, cost, smallest })
    }

    /// The solution with all springs multiplied by `share`, if the iteration converges, and its relative error; otherwise the error of the
    /// first step.
    fn yielded(
        &mut self,
        exact: &[f64],
        (share, rounding): (f64, &SolutionRounding),
        accuracy: f64,
    ) -> Result<(Option<Refined>, f64), EnforceError> {
        let part = self.part;
        let methods: Vec<Method> = part.methods.iter().map(|method| method.times(share)).collect();
        let model = SaddleEquations::new(part)?.with_penalties(&methods, &spring_stiffness(part, &methods)?);
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
            // Two solutions cannot show a smaller difference.
            let error = self.share(exact, &refined.x, rounding).max(f64::EPSILON);
            return Ok((Some(refined), error));
        }
        let first: Vec<f64> = exact
            .iter()
            .zip(self.inverse.solve(&model.spring_displacements(exact))?)
            .map(|(x, step)| x + step)
            .collect();
        Ok((None, self.share(exact, &first, rounding)))
    }
}
