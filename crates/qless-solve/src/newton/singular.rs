//! Directions out of a singular configuration, to second order: `c_k + z^T Z^T H_k Z z / 2 = 0`.
//!
//! In a singular configuration a redundant row k is a combination of others, `y_k^T G = 0`, but its value need not be: `y_k^T c != 0`. No
//! du changes `y_k^T c` to first order. Motions `du = Z z` that the kept rows allow change it by `z^T Z^T H_k Z z / 2` with the effective
//! Hessian `H_k = sum_r y_kr H_r`. Let all contradicted rows be combined with the weights `f_k = c_k / rounding_k^2`, and their Hessians to
//! `A = sum_k f_k Z^T H_k Z`. A solution nearby then requires `sum_k f_k c_k + z^T A z / 2 = 0`. The first sum is positive, so A must have
//! a negative eigenvalue. Its eigenvector is the direction; without one, there is no solution nearby.

use qless::{Analysis, ArgumentError};
use qless_constraints::ConstraintSet;

use super::configuration::Configuration;
use super::lanczos::{KrylovParts, lowest};
use super::linearisation::{LOST, Motions};
use super::parts::Parts;
use super::step::times;

/// Returns a motion du that reduces the residuals of the contradicted rows, and for each part with such rows whether there is such a
/// motion. If a part has none, its rows conflict.
///
/// The residuals depend on the motion by second order. The direction is the eigenvector of the lowest eigenvalue of this quadratic form on
/// the admissible motions, and the form gives the length. Eigenvalues above minus [`LOST`], relative to the sizes of the terms, do not
/// count as negative.
pub fn second_order_directions(
    (set, parts, now): (&ConstraintSet, &Parts, &mut Configuration),
    (contradicted, analysis): (&[usize], &Analysis),
    motions: &Motions,
) -> Result<(Vec<f64>, Vec<bool>), ArgumentError> {
    let count = parts.list.len();
    let Conflicts { weights, amounts } = Conflicts::new((parts, now), contradicted, analysis)?;
    set.effective_hessian(&now.u, &weights, &mut now.evaluation)?;
    let mut asked = vec![false; count];
    contradicted.iter().for_each(|&row| asked[parts.of_row(row)] = true);
    let part_of = |&j: &usize| parts.of_dof(j).filter(|&part| asked[part]);
    let part_of: Vec<_> = motions.reduction.masters().iter().map(part_of).collect();
    let numbers = KrylovParts { part_of, parts: count };
    // The kept rows of parts with contradicted rows hold, so that g = 0 in `y_s = T y_q + g`: the curvature is linear in z.
    let curvature = |z: &[f64]| motions.restrict(&times(now.evaluation.h(), &motions.expand(z)?));
    let (values, mut z) = lowest(curvature, &numbers)?;
    let rounding = now.rounding.c();
    let scales = parts.fold(0.0, |scale, r| {
        let terms = weights[r].abs() * rounding[r] / f64::EPSILON;
        *scale += if terms.is_finite() { terms } else { 0.0 };
    });
    let length = |part: usize| {
        let lowest = values[part].filter(|lowest| *lowest < -LOST * scales[part]);
        lowest.map(|lowest| (-2.0 * amounts[part] / lowest).sqrt())
    };
    let lengths: Vec<Option<f64>> = (0..count).map(length).collect();
    numbers.each(|i, part| z[i] *= lengths[part].unwrap_or(0.0));
    let mut du = motions.expand(&z)?;
    choose_signs(parts, motions.units, &mut du);
    Ok((du, lengths.iter().map(Option::is_some).collect()))
}

/// Chooses the sign of the motion of each part: the DOF that moves most, relative to its unit, increases.
fn choose_signs(parts: &Parts, units: &[f64], du: &mut [f64]) {
    for part in &parts.list {
        let most = part
            .free
            .iter()
            .map(|&j| du[j] / units[j])
            .fold(0.0, |most: f64, y| if y.abs() > most.abs() { y } else { most });
        part.free.iter().for_each(|&j| du[j] *= most.signum());
    }
}

/// Weights f_k and values c_k of the contradicted rows k, summed for each part and scaled such that `max |f_k| = 1`.
struct Conflicts {
    /// `sum_k f_k y_k` over the contradicted rows k, where y_k is row k minus its certificate.
    weights: Vec<f64>,
    /// For each part, `sum_k f_k c_k` over its contradicted rows k.
    amounts: Vec<f64>,
}

impl Conflicts {
    fn new(
        (parts, now): (&Parts, &Configuration),
        contradicted: &[usize],
        analysis: &Analysis,
    ) -> Result<Self, ArgumentError> {
        let (c, rounding) = (now.evaluation.c(), now.rounding.c());
        let raw = |k: usize| Some(c[k] / rounding[k] / rounding[k]).filter(|f| f.is_finite());
        let mut most = vec![0.0_f64; parts.list.len()];
        for &k in contradicted {
            let most = &mut most[parts.of_row(k)];
            *most = most.max(raw(k).unwrap_or(0.0).abs());
        }
        let mut all = Self { weights: vec![0.0; c.len()], amounts: vec![0.0; most.len()] };
        for &k in contradicted {
            let part = parts.of_row(k);
            let f = raw(k).map_or(0.0, |raw| raw / most[part]);
            all.weights[k] += f;
            all.amounts[part] += f * c[k];
            for term in analysis.because(k)? {
                all.weights[term.row] -= f * term.coefficient;
            }
        }
        Ok(all)
    }
}
