//! `A x = b` held against what its terms weigh: `|A x - b|_i` against `(|A| |x| + |b|)_i`, row by row.
//!
//! A row whose terms are all rounding of larger ones elsewhere cannot be in balance with itself. Its terms count as at least
//! [`FLOOR`] of what they would be if every unknown of its connected part were as large as the largest one, in the
//! units of [`super::scale`]: these have no units, so that this compares no length with a force. Unknowns whose units cannot be compared
//! ([`super::kinds`]) are taken as large as would make up a row of theirs, `max_i (|A| |x| + |b|)_i / |A_ij|`.
//! Cost of each measure: three passes over the entries.

use super::EnforceError;

/// The least share of the largest terms that a row is measured by.
pub const FLOOR: f64 = 1e-3;
/// The largest imbalance of a row, relative to its terms, that a solution may have.
pub const BALANCED: f64 = 1e-10;
/// Below this share of what is allowed a refinement is not worth its cost.
pub const SHARP: f64 = 1e-4;

/// `M^-1 r`, where M is all but A.
pub type Solve<'a> = dyn FnMut(&[f64]) -> Result<Vec<f64>, EnforceError> + 'a;

/// A square system whose terms are known, one by one.
pub trait MeasuredEquations {
    /// `A x`.
    fn apply(&self, x: &[f64]) -> Vec<f64>;
    /// `|A| |x|`: the sizes of all terms that go into it, before any of them cancel.
    fn size(&self, x: &[f64]) -> Vec<f64>;
    /// s: `x_j / s_j` has no units.
    fn units(&self) -> &[f64];
    /// The connected part of each unknown, named by one of its members.
    fn parts(&self) -> &[usize];
    /// How large each unknown may be taken for where it is rounding of others; `size` are the terms of each row.
    fn levels(&self, x: &[f64], _size: &[f64]) -> Vec<f64>
    where
        Self: Sized,
    {
        levelled(self, x)
    }
}

/// How the balance of x is reached.
pub struct RefinementGoal<'a> {
    /// What the terms of each row count as at least, as a share of the largest: [`FLOOR`] or less.
    pub floor: &'a dyn Fn(usize) -> f64,
    /// The largest imbalance of each row, relative to its terms.
    pub limit: &'a dyn Fn(usize) -> f64,
    /// Rows of which more than rounding is left, and known otherwise.
    pub lax: &'a dyn Fn(usize) -> bool,
    /// The share of the limit at which it is left at that.
    pub enough: f64,
    /// Solutions and corrections at most.
    pub steps: usize,
    /// Whether slow progress towards the limit is to be expected.
    pub patient: bool,
}

impl RefinementGoal<'static> {
    /// Every row balanced, in so many steps.
    pub fn balance(steps: usize) -> Self {
        Self { floor: &|_| FLOOR, limit: &|_| BALANCED, lax: &|_| false, enough: SHARP, steps, patient: false }
    }
}

/// x, and the row that is worst off.
#[derive(Clone, Debug)]
pub struct Refined {
    pub x: Vec<f64>,
    /// Its place, and `|A x - b|` relative to its terms.
    pub row: usize,
    pub imbalance: f64,
    /// The largest imbalance of rows of which only rounding is left, all with [`FLOOR`].
    pub rounding: f64,
    /// The largest imbalance relative to its limit: up to 1 is allowed.
    pub share: f64,
}

/// Solves and refines: `x += M^-1 (b - A x)` with what `solve` knows of A; `b_size` are the sizes of the terms of b.
///
/// The first solution must come, or its error; a correction that does not come is left out.
pub fn refine(
    equations: &impl MeasuredEquations,
    solve: &mut Solve<'_>,
    b: (&[f64], &[f64]),
    goal: &RefinementGoal,
) -> Result<Refined, EnforceError> {
    let mut x = solve(b.0)?;
    let (mut left, mut best) = measured(equations, &x, b, goal);
    for _ in 1..goal.steps {
        if best.share <= goal.enough {
            break;
        }
        let Ok(correction) = solve(&left) else { break };
        x.iter_mut().zip(correction).for_each(|(x, more)| *x += more);
        let (rest, found) = measured(equations, &x, b, goal);
        let slow = found.share > 0.5 * best.share && (best.share <= 1.0 || !goal.patient);
        // Also where it is no number.
        let lost = found.share.is_nan() || found.share >= 1e3 * best.share;
        if found.share < best.share {
            best = found;
        }
        if slow || lost {
            break;
        }
        left = rest;
    }
    Ok(best)
}

/// `b - A x`, and how large it is.
fn measured(
    equations: &impl MeasuredEquations,
    x: &[f64],
    b: (&[f64], &[f64]),
    goal: &RefinementGoal,
) -> (Vec<f64>, Refined) {
    let left: Vec<f64> = b.0.iter().zip(equations.apply(x)).map(|(b, ax)| b - ax).collect();
    let size: Vec<f64> = equations.size(x).iter().zip(b.1).map(|(ax, b)| ax + b).collect();
    let floor = equations.size(&equations.levels(x, &size));
    let mut worst = Refined { x: x.to_vec(), row: 0, imbalance: 0.0, rounding: 0.0, share: 0.0 };
    for (i, left) in left.iter().enumerate().filter(|(_, left)| **left != 0.0) {
        let measured_by = |share: f64| left.abs() / size[i].max(share * floor[i]);
        let imbalance = measured_by((goal.floor)(i));
        let share = imbalance / (goal.limit)(i);
        if !(goal.lax)(i) {
            worst.rounding = worst.rounding.max(measured_by(FLOOR));
        }
        // No number is worse than any.
        let share = if share.is_nan() { f64::INFINITY } else { share };
        if share > worst.share {
            (worst.row, worst.imbalance, worst.share) = (i, imbalance, share);
        }
    }
    (left, worst)
}

/// x with every unknown as large as the largest of its part.
pub fn levelled(equations: &impl MeasuredEquations, x: &[f64]) -> Vec<f64> {
    let (units, parts) = (equations.units(), equations.parts());
    let largest = largest_of_parts(equations, x);
    parts.iter().zip(units).map(|(&part, s)| s * largest[part]).collect()
}

/// `max |x_j| / s_j` of each part, at its name.
pub fn largest_of_parts(equations: &impl MeasuredEquations, x: &[f64]) -> Vec<f64> {
    let (units, parts) = (equations.units(), equations.parts());
    let mut largest = vec![0.0_f64; x.len()];
    (0..x.len()).for_each(|j| largest[parts[j]] = largest[parts[j]].max(x[j].abs() / units[j]));
    largest
}
