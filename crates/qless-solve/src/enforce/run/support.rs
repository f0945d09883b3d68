//! Whether the model of a solve is held, or the motion that nothing holds.

use qless::{Form, Options, SystemBuilder, analyse};

use super::super::equations::Equations;
use super::super::method::Method;
use super::super::model::Model;
use super::super::part::Part;
use super::super::support::{ROUNDING, SHIFTS, Verdict, held, judged, loose};
use super::super::{EnforceError, Motion};
use super::Prepared;

/// Factored without springs, and how sensitive u is to rounding; or the motion that nothing holds.
pub fn supported<'a>(part: &'a Part<'a>) -> Result<(Prepared<'a>, f64), EnforceError> {
    let methods: Vec<Method> = part.methods.iter().map(|method| method.without_spring()).collect();
    let mut prepared = match Prepared::new(part, methods.clone(), 0.0) {
        Err(error @ EnforceError::Solver(_)) => return Err(free_motion(part, &methods, error)),
        other => other?,
    };
    let Prepared { model, inverse, .. } = &mut prepared;
    match judged(model, &mut |r: &[f64]| inverse.solve(r)) {
        Ok(Verdict::Held(growth)) => Ok((prepared, growth)),
        Ok(Verdict::Loose(motion, held)) => Err(unsupported(part, model, &motion, held)),
        Err(error) => Err(free_motion(part, &methods, error)),
    }
}

/// The motion that a matrix without inverse leaves free; what else went wrong, if nothing is.
fn free_motion(part: &Part, methods: &[Method], error: EnforceError) -> EnforceError {
    let motion = |shift: f64| {
        let Prepared { model, mut inverse, .. } = Prepared::new(part, methods.to_vec(), shift).ok()?;
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
fn by_elimination(part: &Part) -> Option<EnforceError> {
    let model = Model::new(part).ok()?;
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
fn unsupported(part: &Part, model: &Model, motion: &[f64], held: f64) -> EnforceError {
    let n = model.dofs();
    EnforceError::Unsupported(Motion::new(&motion[..n], &model.units()[..n], held).of(&part.dofs))
}
