//! Whether a matrix is singular up to rounding: how far the unknowns move if each entry of A is wrong in its last place.
//!
//! ```text
//! v <- A^-1 (r |A| |v|),  g = max |v after| / max |v before|       random r in +-[1/2, 1], in units of super::units
//! ```
//!
//! g tends to the condition number of Skeel and Bauer, `| |A^-1| |A| |`: rounding of the entries of A changes x by a fraction of about
//! `g eps`. Units of rows and columns do not change g, and stiff parts on soft ones do not make it large. Sizes are those of the terms that
//! were summed into A: a stiffness `0.1 + 0.2 - 0.3` has the size 0.6.
//!
//! If g is so large that rounding decides, v is refined to a null vector, `v <- v - M^-1 A v`. If `|A v|` is rounding of `|A| max |v|` in
//! every row, then a matrix that differs from A by rounding is singular (Rigal and Gaches).
//!
//! If the load is incompatible with a singular A, g can stay small, for example if the zero pattern alone makes A singular. The factors are
//! then not an inverse: `M^-1 A v` differs from v. This is tested for the first v, whatever g is.

use super::refinement::{MeasuredEquations, Solve, largest_of_parts, levelled};
use super::{EnforceError, SolverError};
use crate::common::RandomForces;

/// Shifts that make a singular matrix regular, dimensionless: far above rounding, far below any support.
pub const SHIFTS: [f64; 2] = [1e-12, 1e-9];
/// Power iterations; the growth in the first one depends on the start vector and does not count.
const STEPS: usize = 3;
/// Most refinements of a null vector.
const SHARPENINGS: usize = 6;
/// Relative error assumed for the entries of A, which were rounded several times before.
pub const WRONG: f64 = 16.0 * f64::EPSILON;
/// A is singular if relative errors of its entries up to this size can make it so.
pub const ROUNDING: f64 = 64.0 * f64::EPSILON;
/// Growth at which a null vector is searched for; factors may have larger errors than A.
pub const SUSPICIOUS: f64 = 1e-4 / f64::EPSILON;
/// `M^-1 A v` may differ from v by this fraction.
const LOST: f64 = 0.5;
/// Growth at which u has no correct digit.
const HOPELESS: f64 = 1.0 / WRONG;

/// Whether the model is supported.
pub enum SupportVerdict {
    /// It is supported, with this growth g.
    Supported(f64),
    /// This motion is free, except for forces of this fraction of their terms.
    Mechanism(Vec<f64>, f64),
}

/// Decides whether the model is supported; returns the error of `solve`, if there is one.
pub fn check_support(
    equations: &impl MeasuredEquations,
    solve: &mut Solve<'_>,
) -> Result<SupportVerdict, EnforceError> {
    let RoundingGrowth { growth, mode, lost } = rounding_growth(equations, solve)?;
    if growth < SUSPICIOUS && lost.is_none() {
        return Ok(SupportVerdict::Supported(growth));
    }
    let (motion, resistance) = better_null_vector(equations, solve, lost, mode);
    Ok(if resistance <= ROUNDING || growth >= HOPELESS {
        SupportVerdict::Mechanism(motion, resistance)
    } else {
        SupportVerdict::Supported(growth)
    })
}

/// The free motion of a singular model, from the inverse of a slightly shifted matrix.
pub fn null_motion(equations: &impl MeasuredEquations, solve: &mut Solve<'_>) -> Option<(Vec<f64>, f64)> {
    let RoundingGrowth { mode, lost, .. } = rounding_growth(equations, solve).ok()?;
    let (motion, resistance) = better_null_vector(equations, solve, lost, mode);
    (resistance <= ROUNDING).then_some((motion, resistance))
}

/// Sensitivity of the unknowns to rounding.
pub struct RoundingGrowth {
    /// g.
    pub growth: f64,
    /// The vector that grew most.
    mode: Vec<f64>,
    /// The first vector, if the factors do not invert A along it.
    pub lost: Option<Vec<f64>>,
}

/// Computes g and the candidates for null vectors of A.
pub fn rounding_growth(
    equations: &impl MeasuredEquations,
    solve: &mut Solve<'_>,
) -> Result<RoundingGrowth, EnforceError> {
    let (mut v, mut growth, mut lost) = (equations.units().to_vec(), 0.0_f64, None);
    let mut random = RandomForces::default();
    for step in 0..STEPS {
        // A row without terms gets a force of size one, which reveals that it has no stiffness.
        let force = |(size, unit): (f64, &f64)| random.next() * if size > 0.0 { size } else { unit.recip() };
        let forces: Vec<f64> = equations.size(&v).into_iter().zip(equations.units()).map(force).collect();
        let y = solve(&forces)?;
        let largest = largest(equations, &y);
        if largest == 0.0 {
            break;
        }
        if !largest.is_finite() {
            return Err(SolverError("the solution leaves the range of doubles".into()).into());
        }
        growth = if step == 0 { 1.0 } else { growth.max(largest) };
        v = y.iter().map(|y| y / largest).collect();
        if step == 0 && is_not_inverted(equations, solve, &v) {
            lost = Some(v.clone());
        }
    }
    Ok(RoundingGrowth { growth, mode: v, lost })
}

/// Whether `M^-1 A v` differs from v, which has size one.
fn is_not_inverted(equations: &impl MeasuredEquations, solve: &mut Solve<'_>, v: &[f64]) -> bool {
    let Ok(again) = solve(&equations.apply(v)) else { return true };
    let off: Vec<f64> = again.iter().zip(v).map(|(again, v)| again - v).collect();
    let off = largest(equations, &off);
    off.is_nan() || off > LOST
}

/// The null vector with the smaller relative force.
fn better_null_vector(
    equations: &impl MeasuredEquations,
    solve: &mut Solve<'_>,
    lost: Option<Vec<f64>>,
    mode: Vec<f64>,
) -> (Vec<f64>, f64) {
    let (a, b) = (lost.map(|v| refined_null_vector(equations, solve, v)), refined_null_vector(equations, solve, mode));
    match a {
        Some(a) if a.1 < b.1 => a,
        _ => b,
    }
}

/// A refined null vector, and the relative force that resists it.
fn refined_null_vector(equations: &impl MeasuredEquations, solve: &mut Solve<'_>, mut v: Vec<f64>) -> (Vec<f64>, f64) {
    let mut best = unsupported_part(equations, &v);
    for _ in 0..SHARPENINGS {
        if best.1 <= 4.0 * f64::EPSILON {
            break;
        }
        let Ok(wrong) = solve(&equations.apply(&v)) else { break };
        v.iter_mut().zip(wrong).for_each(|(v, wrong)| *v -= wrong);
        let largest = largest(equations, &v);
        if !(largest > 0.0 && largest.is_finite()) {
            break;
        }
        v.iter_mut().for_each(|v| *v /= largest);
        let found = unsupported_part(equations, &v);
        if found.1 < best.1 {
            best = found;
        }
    }
    best
}

/// Restricts v to the connected parts without support, and returns the largest `|A v|_i / (|A| |v'|)_i` there, where every entry of v' is
/// as large as the largest of its part. If all parts are supported, restricts v to the part with the weakest support.
pub fn unsupported_part(equations: &impl MeasuredEquations, v: &[f64]) -> (Vec<f64>, f64) {
    let (residual, size) = (equations.apply(v), equations.size(&levelled(equations, v)));
    let parts = equations.parts();
    let mut worst: Vec<f64> = largest_of_parts(equations, v);
    worst.iter_mut().for_each(|moves| *moves = if *moves > 0.0 { 0.0 } else { f64::INFINITY });
    for (i, residual) in residual.iter().enumerate().filter(|(_, residual)| **residual != 0.0) {
        worst[parts[i]] = worst[parts[i]].max(residual.abs() / size[i]);
    }
    let least = worst.iter().copied().fold(f64::INFINITY, f64::min);
    let limit = least.max(ROUNDING);
    let of_part = |(v, &part): (&f64, &usize)| if worst[part] <= limit { *v } else { 0.0 };
    let most = worst.iter().copied().filter(|worst| *worst <= limit).fold(0.0, f64::max);
    (v.iter().zip(parts).map(of_part).collect(), most)
}

fn largest(equations: &impl MeasuredEquations, x: &[f64]) -> f64 {
    x.iter().zip(equations.units()).fold(0.0, |most: f64, (x, s)| most.max(x.abs() / s))
}
