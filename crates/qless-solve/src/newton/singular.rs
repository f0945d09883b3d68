//! Directions out of a singular configuration, to second order: `c_k + z^T Z^T H_k Z z / 2 = 0`.
//!
//! In a singular configuration a redundant row is a combination of the others, `y_k^T G = 0`, but its value may not be: `y_k^T c != 0`. No
//! du changes that to first order. Motions `du = Z z` that the kept rows allow change it by `z^T Z^T (sum_r y_kr H_r) Z z / 2`: the
//! effective Hessian with the certificate as weights. Let all contradicted rows be combined with the weights `f_k = c_k / rounding_k^2`,
//! and their effective Hessians H_k to `A = sum_k f_k Z^T H_k Z`. A solution nearby then requires `sum_k f_k c_k + z^T A z / 2 = 0`. Since
//! the sum is positive, A must have a negative eigenvalue. Its eigenvector is the direction; if there is none, there is no solution nearby.

use qless::{Analysis, ArgumentError, Form, Reduction};
use qless_constraints::Evaluation;

use super::configuration::sizes_of_dofs;
use super::error::NewtonError;
use super::lanczos::{KrylovParts, lowest};
use super::parts::EquationParts;
use super::state::NewtonState;
use super::step::times;

/// Eigenvalues above minus this, relative to the sizes of the terms, do not count as negative.
const NEGATIVE: f64 = 1e-10;

/// For each part, a motion that reduces its contradicted rows, of the length that second order predicts, and whether there is one. If not,
/// the rows conflict.
pub fn second_order_directions(
    run: &mut NewtonState,
    analysis: &Analysis,
    step: usize,
) -> Result<(Vec<f64>, Vec<bool>), NewtonError> {
    let argument = |source| NewtonError::Argument { step, source };
    let sizes = sizes_of_dofs(run.set, &run.configuration.u, &mut run.configuration.evaluation).map_err(argument)?;
    let WeightedConflicts { weights, amounts } = WeightedConflicts::new(run, analysis).map_err(argument)?;
    run.set.effective_hessian(&run.configuration.u, &weights, &mut run.configuration.evaluation).map_err(argument)?;
    let motions = AllowedMotions::new(run, sizes, step)?;
    let numbers = motions.numbers(&run.parts, &run.contradicted);
    let mut found = lowest(|z| motions.curvature(&run.configuration.evaluation, z), &numbers).map_err(argument)?;
    let scales = scales(run, &weights);
    let length = |part: usize| {
        let lowest = found.values[part].filter(|lowest| *lowest < -NEGATIVE * scales[part]);
        lowest.map(|lowest| (-2.0 * amounts[part] / lowest).sqrt())
    };
    let lengths: Vec<Option<f64>> = (0..run.parts.count).map(length).collect();
    numbers.each(|i, part| found.vectors[i] *= lengths[part].unwrap_or(0.0));
    let du = motions.with_sign(&found.vectors, &run.parts).map_err(argument)?;
    Ok((du, lengths.iter().map(Option::is_some).collect()))
}

/// Weights and values of the contradicted rows of each part, with `max |f_k| = 1`.
struct WeightedConflicts {
    /// `sum_k f_k y_k`.
    weights: Vec<f64>,
    /// `sum_k f_k c_k`.
    amounts: Vec<f64>,
}

impl WeightedConflicts {
    fn new(run: &NewtonState, analysis: &Analysis) -> Result<Self, ArgumentError> {
        let (c, rounding) = (run.configuration.evaluation.c(), run.configuration.rounding.c());
        let raw = |k: usize| Some(c[k] / rounding[k] / rounding[k]).filter(|f| f.is_finite());
        let mut most = vec![0.0_f64; run.parts.count];
        for &k in &run.contradicted {
            let most = &mut most[run.parts.of_row(k)];
            *most = most.max(raw(k).unwrap_or(0.0).abs());
        }
        let mut all = Self { weights: vec![0.0; c.len()], amounts: vec![0.0; run.parts.count] };
        for &k in &run.contradicted {
            let part = run.parts.of_row(k);
            let f = raw(k).map_or(0.0, |raw| raw / most[part]);
            all.weights[k] += f;
            all.amounts[part] += f * c[k];
            for because in analysis.because(k)? {
                all.weights[because.row] -= f * because.coefficient;
            }
        }
        Ok(all)
    }
}

/// Sizes of the terms of the weighted equations of each part.
fn scales(run: &NewtonState, weights: &[f64]) -> Vec<f64> {
    let rounding = run.configuration.rounding.c();
    run.parts.fold(0.0, |scale, r| {
        let terms = weights[r].abs() * rounding[r] / f64::EPSILON;
        *scale += if terms.is_finite() { terms } else { 0.0 };
    })
}

/// `du = Z z`: motions that the kept rows allow, with masters scaled by their sizes.
struct AllowedMotions {
    reduction: Reduction,
    sizes: Vec<f64>,
    zeros: Vec<f64>,
    /// `du_j = s_j y_j`; the reduction is of y.
    units: Vec<f64>,
}

impl AllowedMotions {
    fn new(run: &NewtonState, sizes: Vec<f64>, step: usize) -> Result<Self, NewtonError> {
        let mut still = run.configuration.evaluation.clone();
        still.clear_values();
        let found = run.linearised(&still, step)?;
        let reduction = found.analysis.reduction_in(Form::Factored);
        let reduction = reduction.map_err(|source| NewtonError::Reduction { step, source })?;
        Ok(Self { reduction, sizes, zeros: vec![0.0; run.prescribed.len()], units: found.units })
    }

    /// The masters of the parts that contain `rows`.
    fn numbers(&self, parts: &EquationParts, rows: &[usize]) -> KrylovParts {
        let mut asked = vec![false; parts.count];
        rows.iter().for_each(|&row| asked[parts.of_row(row)] = true);
        let part_of = |&j: &usize| parts.of_dof(j).filter(|&part| asked[part]);
        KrylovParts { part_of: self.reduction.masters().iter().map(part_of).collect(), parts: parts.count }
    }

    fn motion(&self, z: &[f64]) -> Result<Vec<f64>, ArgumentError> {
        let masters = self.reduction.masters().iter().zip(z);
        let masters: Vec<f64> = masters.map(|(&j, z)| self.sizes[j] / self.units[j] * z).collect();
        let y = self.reduction.expand(&masters, &self.zeros)?;
        Ok(y.iter().zip(&self.units).map(|(y, unit)| unit * y).collect())
    }

    /// `Z^T H Z z`.
    fn curvature(&self, evaluation: &Evaluation, z: &[f64]) -> Result<Vec<f64>, ArgumentError> {
        let force = times(evaluation.h(), &self.motion(z)?);
        let force: Vec<f64> = force.iter().zip(&self.units).map(|(force, unit)| unit * force).collect();
        let slaves: Vec<f64> = self.reduction.slaves().iter().map(|&j| force[j]).collect();
        let back = self.reduction.apply_transposed(&slaves)?;
        let masters = self.reduction.masters().iter().zip(back);
        Ok(masters.map(|(&j, back)| self.sizes[j] / self.units[j] * (force[j] + back)).collect())
    }

    /// Chooses the sign of the motion in each part: the DOF that moves most increases.
    fn with_sign(&self, z: &[f64], parts: &EquationParts) -> Result<Vec<f64>, ArgumentError> {
        let mut du = self.motion(z)?;
        let mut most = vec![0.0_f64; parts.count];
        for (j, part) in (0..du.len()).filter_map(|j| Some((j, parts.of_dof(j)?))) {
            let by_size = if self.sizes[j] > 0.0 { du[j] / self.sizes[j] } else { 0.0 };
            most[part] = if by_size.abs() > most[part].abs() { by_size } else { most[part] };
        }
        let sign = |j: usize| parts.of_dof(j).map_or(1.0, |part| most[part].signum());
        du.iter_mut().enumerate().for_each(|(j, du)| *du *= sign(j));
        Ok(du)
    }
}
