//! Whether the model of a solve is held, or the motion that nothing holds.

use super::super::equations::Equations;
use super::super::method::Method;
use super::super::model::Model;
use super::super::problem::Problem;
use super::super::support::{SHIFTS, SUSPICIOUS, Verdict, judged, loose, sensitivity};
use super::super::{EnforceError, Motion};
use super::Prepared;

/// Factored; where that fails, the motion that the matrix leaves free.
pub fn prepared<'a>(problem: &'a Problem, methods: &'a [Method]) -> Result<Prepared<'a>, EnforceError> {
    Prepared::new(problem, methods, 0.0).map_err(|error| match error {
        EnforceError::Solver(_) => free_motion(problem, methods, error),
        other => other,
    })
}

/// How sensitive u is to rounding, or the motion that nothing holds.
pub fn supported(prepared: &mut Prepared) -> Result<f64, EnforceError> {
    let stiffest = prepared.methods.iter().filter_map(|method| method.factor()).reduce(f64::max);
    if let Some(stiffest) = stiffest {
        let Prepared { model, inverse, .. } = &mut *prepared;
        if let Ok(found) = sensitivity(model, &mut |r: &[f64]| inverse.solve(r)) {
            let seen = found.lost.is_none() && found.growth * stiffest.max(1.0) < SUSPICIOUS;
            if seen && prepared.springs_give_way() {
                return Ok(found.growth);
            }
        }
        // Springs hide K behind their rounding, or hold what the equations do not: the same without them.
        return supported(&mut self::prepared(prepared.problem, &without_springs(prepared.methods))?);
    }
    let Prepared { problem, methods, model, inverse } = prepared;
    let mut solve = |r: &[f64]| inverse.solve(r);
    match judged(model, &mut solve) {
        Ok(Verdict::Held(growth)) => Ok(growth),
        Ok(Verdict::Loose(motion, held)) => Err(unsupported(model, &motion, held)),
        Err(error) => Err(free_motion(problem, methods, error)),
    }
}

/// The motion that a matrix without inverse leaves free; what else went wrong, if nothing is.
fn free_motion(problem: &Problem, methods: &[Method], error: EnforceError) -> EnforceError {
    let without = without_springs(methods);
    let motion = |shift: f64| {
        let Prepared { model, mut inverse, .. } = Prepared::new(problem, &without, shift).ok()?;
        let (motion, held) = loose(&model, &mut |r: &[f64]| inverse.solve(r))?;
        Some(unsupported(&model, &motion, held))
    };
    SHIFTS.into_iter().find_map(motion).unwrap_or(match error {
        EnforceError::Solver(_) => EnforceError::Singular { what: "the stiffness with its constraints" },
        other => other,
    })
}

fn without_springs(methods: &[Method]) -> Vec<Method> {
    methods.iter().map(|method| method.without_spring()).collect()
}

/// The DOFs of a motion, in the units of the caller.
fn unsupported(model: &Model, motion: &[f64], held: f64) -> EnforceError {
    let n = model.dofs();
    EnforceError::Unsupported(Motion::new(&motion[..n], &model.units()[..n], held))
}
