//! Solves each connected part: factors its equations, checks the support, solves, and refines until the equations are in balance. If parts
//! fail, the most severe error is returned.
//!
//! Every part is first solved exactly, by elimination or multipliers; augmented equations get this solution, whatever their factor is.
//! Penalties start from it. D is the stiffness of the springs, `Z = 1 / D` their compliance, and M^-1 the inverse for Z = 0. In `Z x`, Z
//! multiplies the multipliers in x, which gives the displacements of the springs:
//!
//! ```text
//! [K C^T; C -Z] x = b        x <- M^-1 (b + Z x)
//! ```
//!
//! The corrections shrink by the relative error of the penalties; if they do not, the penalties are too soft for any accuracy. D may be
//! arbitrarily large, since no sum `K + C^T D C` is formed. A penalty is refused by the error that it causes, not by its factor.

use super::EnforceError::{self, PenaltyTooSmall, Unsupported};
use super::FreeMotion;
use super::accuracy::DisplacementErrors;
use super::equations::{Equations, Refined};
use super::part::{EnforcedPart, split};
use super::problem::{Method, Problem, Solution};
use super::saddle::{SaddleInverse, compliance, saddle_equations};
use super::scale::times_power;
use super::singularity::{SupportVerdict, check_support, free_motion};
use crate::common::times;

/// Computes u, multipliers and forces by the given methods.
pub fn run(problem: &Problem, methods: &[Method], accuracy: f64) -> Result<Solution, EnforceError> {
    let (n, m) = (problem.system.dofs(), problem.system.equations());
    let (u, forces, multipliers) = (vec![0.0; n], vec![0.0; n], vec![0.0; m]);
    let mut solution = Solution { u, multipliers, forces, reactions: Vec::new(), accuracy: 0.0, imbalance: 0.0 };
    let mut refused = None;
    for terms in split(problem) {
        let part = terms.scaled(problem, methods, accuracy)?;
        match solve_part(&part) {
            Ok((found, accuracy)) => {
                part.place(&found.x, &mut solution);
                solution.accuracy = solution.accuracy.max(accuracy);
                solution.imbalance = solution.imbalance.max(found.imbalance);
            }
            Err(error) => {
                refused = Some(match refused {
                    None => error,
                    Some(first) => worse(first, error),
                });
            }
        }
    }
    refused.map_or_else(|| with_reactions(problem, solution), Err)
}

/// Solves one part and refines until residuals are within their limits; returns the solution and the estimated relative error of u.
fn solve_part(part: &EnforcedPart) -> Result<(Refined, f64), EnforceError> {
    let (model, b) = (saddle_equations(part, &vec![0.0; part.rows.len()])?, (&part.rhs.0[..], &part.rhs.1[..]));
    let mut inverse = SaddleInverse::new(part, |method| *method != Method::Multiplier)
        .map_err(|error| singular(part, &model, error))?;
    let growth = match check_support(&model, &mut |r| inverse.solve(r)) {
        Ok(SupportVerdict::Supported(growth)) => growth,
        Ok(SupportVerdict::Mechanism(motion, resistance)) => return Err(unsupported(part, (motion, resistance))),
        Err(error) => return Err(singular(part, &model, error)),
    };
    let mut refined = model.refine(&mut |r| inverse.solve(r), b)?;
    // Elimination keeps terms that are exactly zero; factors of the saddle matrix turn them into rounding, which may exceed the limits. If
    // residuals are too large, elimination of all equations is therefore tried as well.
    if refined.share > 1.0
        && let Ok(mut other) = SaddleInverse::new(part, |_| true)
        && let Ok(found) = model.refine(&mut |r| other.solve(r), b)
    {
        (inverse, refined) = (other, found);
    }
    let errors = DisplacementErrors::new(part, &model, &mut |r| inverse.solve(r), (&refined.x, growth));
    let Some(errors) = errors.filter(|errors| refined.share <= 1.0 && errors.share() < 1.0) else {
        return Err(singular(part, &model, residual_error(part, &refined)));
    };
    if !part.methods.iter().any(|method| matches!(method, Method::Penalty { .. })) {
        return Ok((refined, errors.share()));
    }
    let (found, of_penalties) = penalised(part, &mut inverse, (&refined.x, &errors))?;
    let accuracy = errors.share() + of_penalties;
    if accuracy < 1.0 { Ok((found, accuracy)) } else { Err(residual_error(part, &found)) }
}

/// Solves with penalties. Returns the solution and its relative error of u. Fails if this error exceeds the requested accuracy; the failure
/// names a sufficient factor, if one was found.
fn penalised(
    part: &EnforcedPart,
    inverse: &mut SaddleInverse,
    (exact, errors): (&[f64], &DisplacementErrors),
) -> Result<(Refined, f64), EnforceError> {
    // The solution with all penalty factors multiplied by `share`, and its error relative to the exactly constrained solution: 1 if the
    // refinement does not converge.
    let mut softened = |share: f64| -> Result<(Refined, f64), EnforceError> {
        let z: Vec<f64> = compliance(part).into_iter().map(|z| z / share).collect();
        let model = saddle_equations(part, &z)?;
        let refined = model.refine(&mut |r| inverse.solve(r), (&part.rhs.0, &part.rhs.1))?;
        // Differences below eps are rounding, so the relative error is at least eps.
        let error = if refined.share <= 1.0 { errors.between(exact, &refined.x).max(f64::EPSILON) } else { 1.0 };
        Ok((refined, error))
    };
    let accuracy = part.accuracy;
    let is_enough = |error: f64| error <= accuracy && error < 1.0;
    let (found, cost) = softened(1.0)?;
    if is_enough(cost) {
        return Ok((found, cost));
    }
    // Once the error is small, it falls as 1 / factor. This gives the first `share` to try; later ones are ten times larger each.
    let first = 2.0 * cost.clamp(accuracy, accuracy.max(1e3)) / accuracy;
    let mut shares = (0..6).map(|digits| first * 10_f64.powi(digits));
    let share = shares.find(|&share| matches!(softened(share), Ok((_, error)) if is_enough(error)));
    let factors = part.methods.iter().map(|method| if let Method::Penalty { factor } = *method { factor } else { 0.0 });
    let factor = factors.fold(0.0, f64::max);
    Err(PenaltyTooSmall { factor, accuracy, cost, smallest: share.map(|share| share * factor) })
}

/// The error for a residual that rounding keeps above its limit.
fn residual_error(part: &EnforcedPart, refined: &Refined) -> EnforceError {
    let residual = refined.imbalance;
    match refined.row.checked_sub(part.dofs.len()).map(|row| part.methods[row]) {
        Some(Method::Augmented { .. }) if refined.share > 1.0 => {
            EnforceError::NoConvergence { residual, tolerance: part.tolerance }
        }
        _ => EnforceError::OutOfBalance { row: part.name(refined.row), imbalance: residual },
    }
}

/// The error for factors that failed: the free motion if one is found, otherwise `error`.
fn singular(part: &EnforcedPart, model: &Equations, error: EnforceError) -> EnforceError {
    match (free_motion(model, part.dofs.len()), error) {
        (Some(motion), _) => unsupported(part, motion),
        (None, EnforceError::Solver(_)) => EnforceError::Singular { what: "the stiffness with its constraints" },
        (None, other) => other,
    }
}

/// The error with the free motion in the caller's numbering.
fn unsupported(part: &EnforcedPart, (motion, resistance): (Vec<f64>, f64)) -> EnforceError {
    let sizes = &motion[..part.dofs.len()];
    let u: Vec<f64> = sizes.iter().zip(&part.scale).map(|(size, e)| times_power(*size, *e)).collect();
    Unsupported(FreeMotion::new(&u, sizes, resistance).renumbered(&part.dofs))
}

/// Adds prescribed values and reactions; fails if a number is not finite.
fn with_reactions(problem: &Problem, mut solution: Solution) -> Result<Solution, EnforceError> {
    let Solution { u, multipliers, forces, reactions, .. } = &mut solution;
    problem.system.prescribed().iter().for_each(|&(j, value)| u[j] = value);
    let stressed = times(&problem.k, u);
    let prescribed = problem.system.prescribed().iter();
    reactions.extend(prescribed.map(|&(j, _)| (j, stressed[j] - forces[j] - problem.f[j])));
    let mut all = u.iter().chain(&*multipliers).chain(&*forces).chain(reactions.iter().map(|(_, force)| force));
    if !all.all(|v| v.is_finite()) {
        return Err(EnforceError::OutOfRange);
    }
    problem.check_doubtful(u)?;
    Ok(solution)
}

/// The more severe of two errors, or the first one if they are equally severe. Two free motions are merged, and so are two errors of soft
/// penalties.
fn worse(first: EnforceError, second: EnforceError) -> EnforceError {
    match (first, second) {
        (Unsupported(a), Unsupported(b)) => Unsupported(a.union(&b)),
        (
            PenaltyTooSmall { factor, accuracy, cost, smallest },
            PenaltyTooSmall { factor: f, cost: c, smallest: s, .. },
        ) => {
            // The larger factor is sufficient for the penalties of both errors.
            let smallest = smallest.zip(s).map(|(a, b)| a.max(b));
            PenaltyTooSmall { factor: factor.max(f), accuracy, cost: cost.max(c), smallest }
        }
        // An error that no larger factor avoids is more severe.
        (PenaltyTooSmall { .. }, other) | (_, other @ Unsupported(_)) => other,
        (first, _) => first,
    }
}
