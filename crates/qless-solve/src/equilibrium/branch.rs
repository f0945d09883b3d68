//! Checks that a load step stays on its solution branch. Some DOFs are determined by the constraints and the prescribed DOFs alone: they
//! move along a curve, whatever the loads are.
//!
//! Let G be the constraint Jacobian at the start of a step, and G' elsewhere in the step, both on the determined DOFs. The matrix P maps x
//! to dx with `G dx = (G - G') x`. If a matrix between G and G' is singular, `(1 - t) G x + t G' x = 0`, then `x = t P x`, so that P has
//! the eigenvalue `1 / t`. While the spectral radius of P is below one, no such matrix is singular, as it would be where branches meet. If
//! a linkage jumps to its mirror image, P has an eigenvalue above one, even if all constraints hold. A change of units is a similarity of P
//! and does not change its eigenvalues. Each part has its own P.
//!
//! With functions of time, the end points of a step cannot reveal a full turn between them: [`check_jumps`] looks at times in between.

use std::sync::Arc;

use qless_constraints::Evaluation;

use super::EquilibriumError;
use super::rows::PartRows;
use super::saddle::{SINGULAR, Saddle, SaddleEntries, SaddlePattern};
use super::time_path::TimePath;
use crate::common::random;
use crate::newton::{Parts, change};

/// Largest spectral radius of P in an accepted step. At one, branches may meet; the limit leaves a margin for the curvature of the path.
const MOST: f64 = 0.5;
/// Number of applications of P to a vector. The growth in the second half of them estimates the spectral radius of P, to about a tenth.
const POWERS: usize = 8;
/// A step is accepted if it changes the constraint Jacobian G by at most this fraction, or if its path deviates from a straight one by at
/// most this fraction of the units of the DOFs. The result is then near its start, even if branches meet on the way.
const SMALL: f64 = 0.005;
/// Branches meet at an end of the step if the meeting point is at most this fraction as far from this end as from the other one. The
/// spectral radius of P is then near 1 if the Jacobian is singular at the end of the step, and very large if it is singular at the start.
/// The square of this number is the fraction of a step by which the step may miss the meeting point.
const NEARER: f64 = 1e-3;
/// The constraints determine a DOF if it moves by at most this fraction of its unit while the other DOFs move by about their units. The
/// fraction is far above the rounding of the saddle solution, and far below any motion.
const STILL: f64 = 1e-6;
/// Number of times at which a load step is checked for full turns between its ends. A step over whole periods passes the check at each of
/// these times with a probability of about 0.1.
const TIMES: u32 = 8;

/// The state of one part at the start of a load step. [`Branch::check`] tests whether a step stays on the same solution branch.
pub struct Branch {
    parts: Arc<Parts>,
    part: usize,
    before: Arc<Evaluation>,
    rows: PartRows,
    /// Units of the free DOFs.
    units: Vec<f64>,
    /// The matrix `[S^-2, G^T; G, 0]` with the units S and the constraint Jacobian G; it gives the shortest motion with given G dx.
    saddle: Saddle,
    determined: Vec<bool>,
}

/// Result of the check of one step.
#[derive(Clone, Copy, Default)]
pub struct BranchCheck {
    /// Spectral radius of P, where `P x = dx` is defined by `G dx = (G - G') x`: G is the constraint Jacobian at the start of the step, G'
    /// at its end.
    pub radius: f64,
    /// Whether branches meet on the way, or nearly meet, so that Newton's method chooses one.
    pub met: bool,
}

impl BranchCheck {
    /// Factor for the length of the next step. With it, the spectral radius of that step is about half of the limit. The factor is at least
    /// 0.1, and 2 if branches met.
    pub fn growth(&self) -> f64 {
        if self.met { 2.0 } else { (0.5 * MOST / self.radius).max(0.1) }
    }
}

impl Branch {
    /// Creates the branch at a configuration that satisfies the constraints of a part; none if no DOF is determined, or if branches meet
    /// there.
    pub fn new(before: &Arc<Evaluation>, rows: &PartRows, (parts, part): (&Arc<Parts>, usize)) -> Option<Self> {
        let units: Vec<f64> = parts.list[part].free.iter().map(|&j| rows.units()[j]).collect();
        let mut list: Vec<_> = units.iter().enumerate().map(|(i, unit)| (i, i, unit.powi(-2))).collect();
        for (r, &row) in (units.len()..).zip(&rows.list) {
            let there = before.g().row(row).filter_map(|(j, v)| Some((parts.place(part, j)?, v)));
            list.extend(there.flat_map(|(j, v)| [(r, j, v), (j, r, v)]));
        }
        let free = units.len();
        let ones = units.iter().map(|_| 1.0).chain(rows.list.iter().map(|_| 1.0)).collect();
        let saddle =
            Saddle::new(&SaddleEntries { units: ones, free, stiff: free, list }, 0.0, &mut SaddlePattern::default())
                .ok()?;
        let pulled = (0..).zip(&units).map(|(k, unit)| random(k) / unit);
        let loose = saddle.solve(&pulled.chain(rows.list.iter().map(|_| 0.0)).collect::<Vec<_>>());
        let determined: Vec<bool> = loose.iter().zip(&units).map(|(x, unit)| x.abs() <= STILL * unit).collect();
        let is_regular = saddle.softest.1 >= SINGULAR && determined.contains(&true);
        let (parts, before, rows) = (parts.clone(), before.clone(), rows.clone());
        is_regular.then_some(Self { parts, part, before, rows, units, saddle, determined })
    }

    /// Checks the step to another configuration; an error if it may leave the branch.
    pub fn check(&self, after: &Evaluation) -> Result<BranchCheck, EquilibriumError> {
        let (rows, units) = (&self.parts.list[self.part].rows, self.rows.units());
        let changed = change([self.before.g(), after.g()], rows, units, &self.parts);
        let radius = if changed == 0.0 { 0.0 } else { self.radius(after) };
        let met = radius.is_nan() || radius > MOST;
        let at_end = (radius - 1.0).abs() <= NEARER || radius >= NEARER.recip();
        if met && changed > SMALL && !at_end {
            return Err(EquilibriumError::Branch { factor: 0.0 });
        }
        Ok(BranchCheck { radius, met })
    }

    fn radius(&self, after: &Evaluation) -> f64 {
        let drawn = (0..).zip(self.units.iter().zip(&self.determined));
        let mut x: Vec<f64> = drawn.map(|(k, (unit, &d))| if d { unit * random(k) } else { 0.0 }).collect();
        let mut half = 0.0;
        for power in 0..POWERS {
            if power == POWERS / 2 {
                half = self.size(&x);
            }
            x = self.moved(self.jacobian_change(after, &x).into_iter());
        }
        let last = self.size(&x);
        if last == 0.0 { 0.0 } else { (last / half).powf(2.0 / POWERS as f64) }
    }

    /// The shortest motion dx with `G dx = b` on the kept rows, where G is the constraint Jacobian; zero at DOFs that are not determined.
    fn moved(&self, b: impl Iterator<Item = f64>) -> Vec<f64> {
        let rhs: Vec<f64> = self.units.iter().map(|_| 0.0).chain(b).collect();
        let dx = self.saddle.solve(&rhs);
        dx.iter().zip(&self.determined).map(|(&dx, &determined)| if determined { dx } else { 0.0 }).collect()
    }

    /// `(G - G') x` on the kept rows, where G is the constraint Jacobian at the start of the step and G' at `after`.
    fn jacobian_change(&self, after: &Evaluation, x: &[f64]) -> Vec<f64> {
        let (before, after) = (self.before.g(), after.g());
        let x = |j: usize| self.parts.place(self.part, j).map_or(0.0, |place| x[place]);
        let pairs = |&row: &usize| before.row(row).zip(after.row(row));
        self.rows.list.iter().map(|r| pairs(r).map(|((j, a), (_, b))| (a - b) * x(j)).sum()).collect()
    }

    /// The largest entry of a motion, relative to the units.
    fn size(&self, x: &[f64]) -> f64 {
        let sizes = x.iter().zip(&self.units).map(|(x, unit)| (x / unit).abs());
        // NaN counts as larger than any number.
        sizes.fold(0.0, |most, x| if most.is_nan() || x <= most { most } else { x })
    }
}

/// Checks whether the DOFs that constraints determine move about straight between two load factors. It fails for a part whose first-order
/// path differs from a straight one by more than a quarter of its length, as an arc of 110 degrees does. The end of the step then does not
/// represent the path: DOFs may have returned there, as after a full turn.
pub fn check_jumps(
    branches: &[&Branch],
    time_path: &mut TimePath,
    [from, to]: [f64; 2],
    scratch: &mut Evaluation,
) -> Result<(), EquilibriumError> {
    let Some(first) = branches.first().filter(|_| matches!(time_path, TimePath::Driven { .. })) else { return Ok(()) };
    let mut ahead = |factor: f64| -> Result<Vec<Vec<f64>>, EquilibriumError> {
        time_path.set_factor(factor)?;
        time_path.set().evaluate(first.before.u(), scratch)?;
        Ok(branches.iter().map(|branch| branch.moved(branch.rows.list.iter().map(|&r| -scratch.c()[r]))).collect())
    };
    let (start, end) = (ahead(from)?, ahead(to)?);
    for k in 1..=TIMES {
        // These times are multiples of the golden ratio, modulo one. No period of a motion fits all of them.
        let part = (f64::from(k) * 0.618_033_988_749_895).fract();
        for (((branch, dx), from), to) in branches.iter().zip(ahead(from + part * (to - from))?).zip(&start).zip(&end) {
            let whole: Vec<f64> = to.iter().zip(from).map(|(to, from)| to - from).collect();
            let off: Vec<f64> = (0..dx.len()).map(|j| dx[j] - from[j] - part * whole[j]).collect();
            let limit = (0.25 * branch.size(&whole)).max(SMALL);
            // The comparison is false for NaN, so that NaN fails the check.
            let is_straight = branch.size(&off) <= limit;
            if !is_straight {
                return Err(EquilibriumError::Branch { factor: 0.0 });
            }
        }
    }
    ahead(to).map(drop)
}
