//! Checks that a load step stays on its branch. DOFs that constraints and prescribed DOFs determine move along a curve, independently of
//! the loads.
//!
//! Let G be the Jacobian at the start of a step, G' elsewhere, and x a vector on the determined DOFs. `P x = dx` is defined by
//! `G dx = (G - G') x`. If `(1 - t) G x + t G' x = 0`, then `x = t P x`. While the spectral radius of P is below one, no matrix between G
//! and G' is singular, as it would be where branches meet. If a linkage jumps to its mirror image, P has an eigenvalue above one, even if
//! all constraints hold. A change of units is a similarity of P and does not change its eigenvalues. Each part has its own P.
//!
//! With functions of time, the end points of a step cannot reveal a full turn between them: [`check_jumps`] looks at times in between. One
//! evaluation at each time serves all parts.

use std::collections::BTreeMap;
use std::sync::Arc;

use qless_constraints::Evaluation;

use super::StepFailure;
use super::parts::EquilibriumParts;
use super::rows::PartRows;
use super::saddle::{Saddle, SaddleEntries, SaddlePattern};
use super::time_path::TimePath;
use crate::common::random;
use crate::newton::change;

/// Largest spectral radius of an accepted step.
const MOST: f64 = 0.5;
/// Spectral radius that the next step aims at.
const AIM: f64 = 0.35;
/// Applications of P; the second half estimates the radius.
const POWERS: usize = 8;
/// A step in which G changes by less than this fraction of its entries is accepted. If its spectral radius exceeds [`MOST`], branches have
/// met.
const MET: f64 = 0.005;
/// Branches meet at an end of the step if its distance to the meeting point is at most this fraction of the distance of the other end. P
/// then has the eigenvalue 1 if G' is singular, and a very large one if G is.
const NEARER: f64 = 1e-3;
/// A DOF is determined if it moves by less than this fraction of its unit while the others move by theirs.
const STILL: f64 = 1e-6;
/// The state of one part at the start of a load step. [`Branch::check`] tests whether a step stays on the same solution branch.
pub struct Branch {
    parts: Arc<EquilibriumParts>,
    part: usize,
    before: Arc<Evaluation>,
    rows: PartRows,
    /// Units of the free DOFs.
    units: Vec<f64>,
    /// `[S^-2, G^T; G, 0]` with the units S; it gives the shortest motion with given G dx.
    saddle: Saddle,
    determined: Vec<bool>,
}

/// Result of the check of one step.
#[derive(Clone, Copy, Default)]
pub struct BranchCheck {
    /// The spectral radius of P.
    pub radius: f64,
    /// Whether branches meet on the way, or nearly meet, so that Newton's method chooses one.
    pub met: bool,
}

impl Branch {
    /// At a configuration that satisfies the constraints of a part; none if no DOF is determined, or if branches meet there.
    pub fn new(
        before: &Arc<Evaluation>,
        rows: &PartRows,
        (parts, part): (&Arc<EquilibriumParts>, usize),
        pattern: &mut SaddlePattern,
    ) -> Option<Self> {
        let units: Vec<f64> = parts.list[part].free.iter().map(|&j| rows.units()[j]).collect();
        let saddle = Saddle::new(&entries(before, rows, (parts, part)), units.len(), 0.0, pattern).ok()?;
        if saddle.null_vector(pattern).is_some() {
            return None;
        }
        let pulled = (0..).zip(&units).map(|(k, unit)| random(k) / unit);
        let loose = saddle.solve(&pulled.chain(rows.list.iter().map(|_| 0.0)).collect::<Vec<_>>());
        let determined: Vec<bool> = loose.iter().zip(&units).map(|(x, unit)| x.abs() <= STILL * unit).collect();
        let (parts, before, rows) = (parts.clone(), before.clone(), rows.clone());
        determined.contains(&true).then_some(Self { parts, part, before, rows, units, saddle, determined })
    }

    /// Checks the step to another configuration; an error if it may leave the branch.
    pub fn check(&self, after: &Evaluation) -> Result<BranchCheck, StepFailure> {
        let changed = self.change(after);
        if changed == 0.0 {
            return Ok(BranchCheck::default());
        }
        let radius = self.radius(after);
        let meet = (radius - 1.0).abs() <= NEARER || radius >= NEARER.recip();
        match changed <= MET || meet {
            true => Ok(BranchCheck { radius: radius.min(AIM), met: radius.is_nan() || radius > MOST }),
            false if radius <= MOST => Ok(BranchCheck { radius, met: false }),
            false => Err(StepFailure::Branch(growth(radius))),
        }
    }

    fn change(&self, after: &Evaluation) -> f64 {
        let rows = self.parts.list[self.part].rows.iter().copied();
        change([&self.before, after], rows, (&self.parts.of_equations.columns, self.rows.units()))
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

    /// dx on the determined DOFs, with `G dx = b` on the kept rows.
    fn moved(&self, b: impl Iterator<Item = f64>) -> Vec<f64> {
        let rhs: Vec<f64> = self.units.iter().map(|_| 0.0).chain(b).collect();
        let dx = self.saddle.solve(&rhs);
        dx.iter().zip(&self.determined).map(|(&dx, &determined)| if determined { dx } else { 0.0 }).collect()
    }

    /// `(G - G') x` on the kept rows.
    fn jacobian_change(&self, after: &Evaluation, x: &[f64]) -> Vec<f64> {
        let (before, after) = (self.before.g(), after.g());
        let x = |j: usize| self.parts.place(self.part, j).map_or(0.0, |place| x[place]);
        let pairs = |&row: &usize| before.row(row).zip(after.row(row));
        self.rows.list.iter().map(|r| pairs(r).map(|((j, a), (_, b))| (a - b) * x(j)).sum()).collect()
    }

    fn size(&self, x: &[f64]) -> f64 {
        let sizes = x.iter().zip(&self.units).map(|(x, unit)| (x / unit).abs());
        // Keeps NaN.
        sizes.fold(0.0, |most, x| if most.is_nan() || x <= most { most } else { x })
    }
}

/// Factor for the length of the next step; NaN counts as a large radius.
pub fn growth(radius: f64) -> f64 {
    (AIM / radius).max(0.1)
}

fn entries(before: &Evaluation, rows: &PartRows, (parts, part): (&EquilibriumParts, usize)) -> SaddleEntries {
    let (free, g) = (&parts.list[part].free, before.g());
    let n = free.len();
    let mut list: Vec<_> = free.iter().enumerate().map(|(i, &j)| (i, i, rows.units()[j].powi(-2))).collect();
    for (r, &row) in (n..).zip(&rows.list) {
        let there = g.row(row).filter_map(|(j, v)| Some((parts.place(part, j)?, v)));
        list.extend(there.flat_map(|(j, v)| [(r, j, v), (j, r, v)]));
    }
    SaddleEntries { size: n + rows.list.len(), stiff: n, list, units: Vec::new() }
}

/// Fractions of a step at which functions of time are checked: fractional parts of square roots of primes. Small numbers of periods do not
/// align with all of them.
const BETWEEN: [f64; 8] =
    [0.414_213_6, 0.732_050_8, 0.236_068, 0.645_751_3, 0.316_624_8, 0.605_551_3, 0.123_105_6, 0.358_898_9];
/// If the path differs from a straight one by less than this fraction of its length, its end is representative.
const STRAIGHT: f64 = 0.1;
/// If the path differs from a straight one by more than this fraction, it returns, as after a full turn, and its end is not representative.
const BACK: f64 = 0.5;
/// Takes the place of [`MOST`] at an intermediate time at which the path returns (see [`BACK`]).
const MOST_BACK: f64 = 0.1;

/// A part whose path is curved: its displacement, and the largest spectral radius allowed there.
struct CurvedWay<'a> {
    branch: &'a Branch,
    dx: Vec<f64>,
    most: f64,
}

/// Checks all parts between two load factors; returns the parts that may leave their branches, with the reasons.
pub fn check_jumps(
    branches: &[&Branch],
    time_path: &mut TimePath,
    [from, to]: [f64; 2],
    scratch: &mut Evaluation,
) -> Result<BTreeMap<usize, StepFailure>, StepFailure> {
    let mut failures = BTreeMap::new();
    if branches.is_empty() || matches!(time_path, TimePath::Still(_)) {
        return Ok(failures);
    }
    let straight = ahead(branches, time_path, to, scratch)?;
    for part in BETWEEN {
        let there = ahead(branches, time_path, from + part * (to - from), scratch)?;
        let ways = branches.iter().zip(there).zip(&straight);
        let bent: Vec<CurvedWay> =
            ways.filter_map(|((branch, dx), straight)| branch.bent(dx, straight, part)).collect();
        pass(&bent, time_path, scratch, &mut failures)?;
    }
    time_path.set_factor(to)?;
    Ok(failures)
}

/// First-order displacement of the determined DOFs of each part up to a load factor.
fn ahead(
    branches: &[&Branch],
    time_path: &mut TimePath,
    factor: f64,
    scratch: &mut Evaluation,
) -> Result<Vec<Vec<f64>>, StepFailure> {
    time_path.set_factor(factor)?;
    if let Some(first) = branches.first() {
        time_path.set().evaluate(first.before.u(), scratch)?;
    }
    Ok(branches.iter().map(|branch| branch.moved(branch.rows.list.iter().map(|&r| -scratch.c()[r]))).collect())
}

/// Checks curved parts at their intermediate positions, and adds those that fail to `failures`.
fn pass(
    bent: &[CurvedWay],
    time_path: &TimePath,
    scratch: &mut Evaluation,
    failures: &mut BTreeMap<usize, StepFailure>,
) -> Result<(), StepFailure> {
    let Some(first) = bent.first() else { return Ok(()) };
    let mut u = first.branch.before.u().to_vec();
    let is_finite = |curved: &CurvedWay| curved.dx.iter().all(|dx| dx.is_finite());
    for CurvedWay { branch, dx, .. } in bent.iter().filter(|curved| is_finite(curved)) {
        branch.parts.list[branch.part].free.iter().zip(dx).for_each(|(&j, dx)| u[j] += dx);
    }
    time_path.set().evaluate(&u, scratch)?;
    for curved in bent {
        let found =
            if is_finite(curved) { curved.branch.passes(scratch, curved.most) } else { Err(StepFailure::Branch(0.0)) };
        found.unwrap_or_else(|failure| _ = failures.entry(curved.branch.part).or_insert(failure));
    }
    Ok(())
}

impl Branch {
    /// `dx` is the displacement after the fraction `part` of a step, and `straight` that of the whole step along a straight path. None if
    /// dx is near `part * straight`.
    fn bent(&self, dx: Vec<f64>, straight: &[f64], part: f64) -> Option<CurvedWay<'_>> {
        let off: Vec<f64> = dx.iter().zip(straight).map(|(x, whole)| x - part * whole).collect();
        let off = self.size(&off) / self.size(straight);
        let most = if off <= BACK { MOST } else { MOST_BACK };
        (off.is_nan() || off > STRAIGHT).then_some(CurvedWay { branch: self, dx, most })
    }

    fn passes(&self, there: &Evaluation, most: f64) -> Result<(), StepFailure> {
        let radius = self.check(there)?.radius;
        let far = radius > most && self.change(there) > MET;
        if far { Err(StepFailure::Branch(growth(radius))) } else { Ok(()) }
    }
}
