//! Whether a model is held: how much its unknowns move when each number of A is wrong in its last place.
//!
//! ```text
//! v <- A^-1 (r |A| |v|),  g = max |v after| / max |v before|       random r in +-[1/2, 1], units of super::scale
//! ```
//!
//! g tends to the condition number of Skeel and Bauer, `| |A^-1| |A| |`: rounding of the entries of A moves x by a share of about
//! `g eps`. It does not change with the units of rows and columns, and stiff parts on soft ones do not make it large. Sizes are
//! those of the terms that A was made of: a stiffness `0.1 + 0.2 - 0.3` has a size of 0.6.
//!
//! Where g says that rounding decides, v is sharpened to a null vector, `v <- v - M^-1 A v`, and held against its terms: where
//! `|A v|` is rounding of `|A| max |v|` in every row, a matrix that differs from A by rounding is singular (Rigal and Gaches).
//!
//! Where forces that A cannot carry act on rows that no motion it does not feel enters, as where its zeros alone make it singular, g stays small.
//! The factors are then no inverse: `M^-1 A v` is not v for the first v, which is looked at whatever g is.

use super::refinement::{MeasuredEquations, Solve, largest_of_parts, levelled};
use super::{EnforceError, SolverError};
use crate::common::RandomForces;

/// What makes a singular matrix regular, in units without units: far above rounding, far below what holds a model.
pub const SHIFTS: [f64; 2] = [1e-12, 1e-9];
/// Steps of the iteration; the first depends on where it starts.
const STEPS: usize = 3;
/// Steps that sharpen a null vector, at most.
const SHARPENINGS: usize = 6;
/// The share by which entries of A are taken to be wrong: each was rounded more than once before it came here.
pub const WRONG: f64 = 16.0 * f64::EPSILON;
/// Entries of A that are wrong by this share make it singular: rounding, in what assembled models have of it.
pub const ROUNDING: f64 = 64.0 * f64::EPSILON;
/// Sensitivities from which on a null vector is looked for: factors may be far more wrong than A is.
pub const SUSPICIOUS: f64 = 1e-4 / f64::EPSILON;
/// The share of a direction that an inverse must give back.
const LOST: f64 = 0.5;
/// Sensitivities from which on u has not one digit that is sure.
const HOPELESS: f64 = 1.0 / WRONG;

/// What is known of the support of a model.
pub enum SupportVerdict {
    /// It is held, with this g.
    Held(f64),
    /// Nothing holds this motion, but for this share of its terms.
    Loose(Vec<f64>, f64),
}

/// Whether the model is held; an error if `solve` has one.
pub fn judged(equations: &impl MeasuredEquations, solve: &mut Solve<'_>) -> Result<SupportVerdict, EnforceError> {
    let RoundingGrowth { growth, mode, lost } = sensitivity(equations, solve)?;
    if growth < SUSPICIOUS && lost.is_none() {
        return Ok(SupportVerdict::Held(growth));
    }
    let (motion, held) = sharpest(equations, solve, lost, mode);
    Ok(if held <= ROUNDING || growth >= HOPELESS {
        SupportVerdict::Loose(motion, held)
    } else {
        SupportVerdict::Held(growth)
    })
}

/// The motion that a singular model leaves free, by the inverse of a matrix that was shifted a little.
pub fn loose(equations: &impl MeasuredEquations, solve: &mut Solve<'_>) -> Option<(Vec<f64>, f64)> {
    let RoundingGrowth { mode, lost, .. } = sensitivity(equations, solve).ok()?;
    let (motion, held) = sharpest(equations, solve, lost, mode);
    (held <= ROUNDING).then_some((motion, held))
}

/// How much rounding moves.
pub struct RoundingGrowth {
    /// g.
    pub growth: f64,
    /// The direction that grew.
    mode: Vec<f64>,
    /// The first direction, where the factors are no inverse along it.
    pub lost: Option<Vec<f64>>,
}

/// g, and the directions in which A may be singular.
pub fn sensitivity(equations: &impl MeasuredEquations, solve: &mut Solve<'_>) -> Result<RoundingGrowth, EnforceError> {
    let (mut v, mut growth, mut lost) = (equations.units().to_vec(), 0.0_f64, None);
    let mut random = RandomForces::default();
    for step in 0..STEPS {
        // A row without terms feels a force of size one: nothing else would find that it has no stiffness.
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
        if step == 0 && is_lost(equations, solve, &v) {
            lost = Some(v.clone());
        }
    }
    Ok(RoundingGrowth { growth, mode: v, lost })
}

/// Whether `M^-1 A v` is something else than v, which is of size one.
fn is_lost(equations: &impl MeasuredEquations, solve: &mut Solve<'_>, v: &[f64]) -> bool {
    let Ok(again) = solve(&equations.apply(v)) else { return true };
    let off: Vec<f64> = again.iter().zip(v).map(|(again, v)| again - v).collect();
    let off = largest(equations, &off);
    off.is_nan() || off > LOST
}

/// The sharper null vector of two.
fn sharpest(
    equations: &impl MeasuredEquations,
    solve: &mut Solve<'_>,
    lost: Option<Vec<f64>>,
    mode: Vec<f64>,
) -> (Vec<f64>, f64) {
    let (a, b) = (lost.map(|v| sharpened(equations, solve, v)), sharpened(equations, solve, mode));
    match a {
        Some(a) if a.1 < b.1 => a,
        _ => b,
    }
}

/// A sharper null vector, and how strongly it is held.
fn sharpened(equations: &impl MeasuredEquations, solve: &mut Solve<'_>, mut v: Vec<f64>) -> (Vec<f64>, f64) {
    let mut best = held(equations, &v);
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
        let found = held(equations, &v);
        if found.1 < best.1 {
            best = found;
        }
    }
    best
}

/// v in the connected parts that nothing holds, and the largest `|A v|_i / (|A| |v'|)_i` of them, where every number of v' is as
/// large as the largest of its part. Where all parts are held, v in the part that is held least.
pub fn held(equations: &impl MeasuredEquations, v: &[f64]) -> (Vec<f64>, f64) {
    let (left, size) = (equations.apply(v), equations.size(&levelled(equations, v)));
    let parts = equations.parts();
    let mut worst: Vec<f64> = largest_of_parts(equations, v);
    worst.iter_mut().for_each(|moves| *moves = if *moves > 0.0 { 0.0 } else { f64::INFINITY });
    for (i, left) in left.iter().enumerate().filter(|(_, left)| **left != 0.0) {
        worst[parts[i]] = worst[parts[i]].max(left.abs() / size[i]);
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
