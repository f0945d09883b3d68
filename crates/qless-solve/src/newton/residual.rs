//! How far a configuration is from the constraints, in units of the model.
//!
//! `r_i = eps |c_i| / rounding_i`: relative to the size of the terms of c_i, which is what its rounding is a multiple of. The unit of
//! length, angle or force drops out, row by row.

use qless::ArgumentError;

use super::parts::Columns;
use qless_constraints::{ConstraintSet, Quantities};

/// `|c_r|` in roundings of c_r; infinite where the rounding is not known and c is not zero.
pub fn in_roundings(c: &[f64], rounding: &[f64]) -> Vec<f64> {
    let measure = |(&c, &bound): (&f64, &f64)| {
        if c == 0.0 {
            return 0.0;
        }
        let ratio = c.abs() / bound;
        if bound.is_finite() && !ratio.is_nan() { ratio } else { f64::INFINITY }
    };
    c.iter().zip(rounding).map(measure).collect()
}

/// How much each DOF can move until something nonlinear has changed by its own size: `1 / max_r (|G_rj| / size_r)`, and less where
/// the curvature `|H_jj|`, each row by its size, says so. A length for a position, an angle for a rotation, in any unit. 0 for
/// DOFs in no equation.
pub fn sizes_of_dofs(set: &ConstraintSet, u: &[f64], quantities: &mut Quantities) -> Result<Vec<f64>, ArgumentError> {
    let weights: Vec<f64> = set.rounding(u)?.c().iter().map(|&bound| inverse(bound / f64::EPSILON)).collect();
    set.effective_hessian(u, &weights, quantities)?;
    let mut steepness = vec![0.0_f64; set.dofs()];
    for (row, weight) in weights.iter().enumerate() {
        quantities.g().row(row).for_each(|(j, v)| steepness[j] = steepness[j].max(v.abs() * weight));
    }
    for (j, steep) in steepness.iter_mut().enumerate() {
        let bent = quantities.h().row(j).find(|&(k, _)| k == j).map_or(0.0, |(_, v)| v.abs().sqrt());
        *steep = inverse(steep.max(bent));
    }
    Ok(steepness)
}

/// `1 / x`, and 0 where that is no number of use.
pub fn inverse(x: f64) -> f64 {
    let inverse = 1.0 / x;
    if inverse.is_finite() { inverse } else { 0.0 }
}

/// `max |G_rj - G'_rj| s_j / max |G'_rj| s_j` over j, the largest over the rows, with columns measured by their sizes s.
pub fn change(
    [before, after]: [&Quantities; 2],
    rows: impl IntoIterator<Item = usize>,
    (of, sizes): (&Columns, &[f64]),
) -> f64 {
    let of_row = |row: usize| {
        let pairs = || of.row(before.g(), row).zip(after.g().row(row));
        let most = pairs().map(|((j, a), (_, b))| (a - b).abs() * sizes[j]).fold(0.0, f64::max);
        let size = pairs().map(|((j, a), (_, b))| a.abs().max(b.abs()) * sizes[j]).fold(0.0, f64::max);
        if most == 0.0 { 0.0 } else { most / size }
    };
    rows.into_iter().map(of_row).fold(0.0, f64::max)
}
