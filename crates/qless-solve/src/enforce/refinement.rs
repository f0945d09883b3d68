//! Iterative refinement of `A x = b`, and its residual `|A x - b|_i` relative to its terms `(|A| |x| + |b|)_i`, row by row.
//!
//! If all terms of a row are rounding of larger unknowns elsewhere, the row cannot satisfy this measure. Its terms therefore count as at
//! least [`FLOOR`] times what they would be if every unknown of its connected part were as large as the largest one, in the dimensionless
//! units of [`super::units`]. An unknown without a known unit ([`super::units::UnitGroups`]) counts as the largest size at which its term
//! alone equals the terms of a row, `max_i (|A| |x| + |b|)_i / |A_ij|`. Cost of one residual: three passes over the entries.

use super::EnforceError;

/// Floor for the terms of a row, relative to the largest terms of its connected part.
pub const FLOOR: f64 = 1e-3;
/// The largest relative residual of a row that a solution may have.
pub const BALANCED: f64 = 1e-10;
/// Refinement stops below this fraction of the limit.
pub const SHARP: f64 = 1e-4;

/// `M^-1 r`, where M is A up to rounding.
pub type Solve<'a> = dyn FnMut(&[f64]) -> Result<Vec<f64>, EnforceError> + 'a;

/// A square system that knows the sizes of its terms.
pub trait MeasuredEquations {
    /// `A x`.
    fn apply(&self, x: &[f64]) -> Vec<f64>;
    /// `|A| |x|`: the sizes of all terms of A x, before they cancel.
    fn size(&self, x: &[f64]) -> Vec<f64>;
    /// s, such that `x_j / s_j` is dimensionless.
    fn units(&self) -> &[f64];
    /// The connected part of each unknown, given by one of its members.
    fn parts(&self) -> &[usize];
    /// The size of each unknown in the floor for the terms of a row; `size` holds the sizes of the terms of each row.
    fn levels(&self, x: &[f64], _size: &[f64]) -> Vec<f64>
    where
        Self: Sized,
    {
        levelled(self, x)
    }
}

/// When refinement stops.
pub struct RefinementGoal<'a> {
    /// Floor for the terms of each row, relative to the largest: [`FLOOR`] or less.
    pub floor: &'a dyn Fn(usize) -> f64,
    /// The largest relative residual allowed in each row.
    pub limit: &'a dyn Fn(usize) -> f64,
    /// Rows whose residual may be larger than rounding; [`Refined::rounding`] ignores them.
    pub lax: &'a dyn Fn(usize) -> bool,
    /// Refinement stops at this fraction of the limit.
    pub enough: f64,
    /// Most solves.
    pub steps: usize,
    /// Whether slow progress towards the limit is expected.
    pub patient: bool,
}

impl RefinementGoal<'static> {
    /// Allows every row a relative residual of at most [`BALANCED`], with at most so many solves.
    pub fn balance(steps: usize) -> Self {
        Self { floor: &|_| FLOOR, limit: &|_| BALANCED, lax: &|_| false, enough: SHARP, steps, patient: false }
    }
}

/// x, and the row with the largest residual relative to its limit.
#[derive(Clone, Debug)]
pub struct Refined {
    pub x: Vec<f64>,
    /// Index of that row, and its relative residual.
    pub row: usize,
    pub imbalance: f64,
    /// The largest relative residual of the rows that are not lax, all with [`FLOOR`].
    pub rounding: f64,
    /// The largest residual relative to its limit; at most 1 is allowed.
    pub share: f64,
}

/// Solves and refines: `x += M^-1 (b - A x)`, with `solve` for `M^-1` and the sizes of the terms of b.
///
/// An error of the first solve is returned; an error of a correction ends the refinement.
pub fn refine(
    equations: &impl MeasuredEquations,
    solve: &mut Solve<'_>,
    b: (&[f64], &[f64]),
    goal: &RefinementGoal,
) -> Result<Refined, EnforceError> {
    let mut x = solve(b.0)?;
    let (mut residual, mut best) = measured(equations, &x, b, goal);
    for _ in 1..goal.steps {
        if best.share <= goal.enough {
            break;
        }
        let Ok(correction) = solve(&residual) else { break };
        x.iter_mut().zip(correction).for_each(|(x, more)| *x += more);
        let (rest, found) = measured(equations, &x, b, goal);
        let slow = found.share > 0.5 * best.share && (best.share <= 1.0 || !goal.patient);
        // True for NaN as well.
        let lost = found.share.is_nan() || found.share >= 1e3 * best.share;
        if found.share < best.share {
            best = found;
        }
        if slow || lost {
            break;
        }
        residual = rest;
    }
    Ok(best)
}

/// `b - A x` and its relative size.
fn measured(
    equations: &impl MeasuredEquations,
    x: &[f64],
    b: (&[f64], &[f64]),
    goal: &RefinementGoal,
) -> (Vec<f64>, Refined) {
    let residual: Vec<f64> = b.0.iter().zip(equations.apply(x)).map(|(b, ax)| b - ax).collect();
    let size: Vec<f64> = equations.size(x).iter().zip(b.1).map(|(ax, b)| ax + b).collect();
    let floor = equations.size(&equations.levels(x, &size));
    let mut worst = Refined { x: x.to_vec(), row: 0, imbalance: 0.0, rounding: 0.0, share: 0.0 };
    for (i, residual) in residual.iter().enumerate().filter(|(_, residual)| **residual != 0.0) {
        let measured_by = |share: f64| residual.abs() / size[i].max(share * floor[i]);
        let imbalance = measured_by((goal.floor)(i));
        let share = imbalance / (goal.limit)(i);
        if !(goal.lax)(i) {
            worst.rounding = worst.rounding.max(measured_by(FLOOR));
        }
        // NaN is worse than any number.
        let share = if share.is_nan() { f64::INFINITY } else { share };
        if share > worst.share {
            (worst.row, worst.imbalance, worst.share) = (i, imbalance, share);
        }
    }
    (residual, worst)
}

/// x with every unknown as large as the largest of its part.
pub fn levelled(equations: &impl MeasuredEquations, x: &[f64]) -> Vec<f64> {
    let (units, parts) = (equations.units(), equations.parts());
    let largest = largest_of_parts(equations, x);
    parts.iter().zip(units).map(|(&part, s)| s * largest[part]).collect()
}

/// `max |x_j| / s_j` of each part, stored at the index that names the part.
pub fn largest_of_parts(equations: &impl MeasuredEquations, x: &[f64]) -> Vec<f64> {
    let (units, parts) = (equations.units(), equations.parts());
    let mut largest = vec![0.0_f64; x.len()];
    (0..x.len()).for_each(|j| largest[parts[j]] = largest[parts[j]].max(x[j].abs() / units[j]));
    largest
}
