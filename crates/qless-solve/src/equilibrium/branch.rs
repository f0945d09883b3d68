//! Whether a load step stays on its branch: DOFs that constraints and prescribed DOFs determine move along a curve, and loads have no part
//! in it.
//!
//! With G where a step starts, G' elsewhere and x on these DOFs, let `P x = dx` where `G dx = (G - G') x`. If `(1 - t) G x + t G' x = 0` then
//! `x = t P x`: while the spectral radius of P is below one, no G between the two loses rank, which it would where branches meet. A linkage that
//! went over to its mirror image has an eigenvalue above one, however well it satisfies the constraints. Units drop out: a change of them
//! is a similarity of P. Each part has a P of its own.
//! @@ equilibrium/branch/lead.rs
//! Whether functions of time lead along the branch from one load factor to another: a whole turn between two steps is none at their ends.
//!
//! Time is that of the whole model: one evaluation at each time serves all parts.

use std::collections::BTreeMap;
use std::sync::Arc;

use qless_constraints::Quantities;

use super::StepFailure;
use super::parts::EquilibriumParts;
use super::rows::KeptRows;
use super::saddle::{Saddle, SaddleEntries, SaddlePattern};
use super::time_path::TimePath;
use crate::common::random;
use crate::newton::change;

/// The largest spectral radius of a step that is accepted.
const MOST: f64 = 0.5;
/// What the next step is chosen for.
const AIM: f64 = 0.35;
/// Powers of P that are looked at; the second half tells the radius.
const POWERS: usize = 8;
/// Where G changes by less than this part of its entries, the branches that P tells apart have met.
const MET: f64 = 0.005;
/// So much nearer to where branches meet than the other end of the step, an end is there: P has the eigenvalue 1 if G' loses rank, and one
/// beyond all bounds if G does.
const NEARER: f64 = 1e-3;
/// Determined is what moves by less than this part of its unit where the others move by theirs.
const STILL: f64 = 1e-6;
/// Where a part starts a load step.
pub struct Branch {
    parts: Arc<EquilibriumParts>,
    part: usize,
    before: Arc<Quantities>,
    rows: KeptRows,
    /// Of DOFs that are not prescribed.
    units: Vec<f64>,
    /// `[S^-2, G^T; G, 0]` with the units S: the shortest of all motions that G allows.
    saddle: Saddle,
    determined: Vec<bool>,
}

/// What is seen of a step from where it starts to where it ends.
#[derive(Clone, Copy, Default)]
pub struct BranchTurn {
    /// The spectral radius of P.
    pub radius: f64,
    /// Whether branches meet on the way, or nearly so: which one is taken, Newton's method decides.
    pub met: bool,
}

impl Branch {
    /// At a configuration that satisfies the constraints of a part; nothing if they determine no DOF, or branches meet there.
    pub fn new(
        before: &Arc<Quantities>,
        rows: &KeptRows,
        (parts, part): (&Arc<EquilibriumParts>, usize),
        pattern: &mut SaddlePattern,
    ) -> Option<Self> {
        let units: Vec<f64> = parts.list[part].free.iter().map(|&j| rows.units()[j]).collect();
        let saddle = Saddle::new(&entries(before, rows, (parts, part)), units.len(), 0.0, pattern).ok()?;
        if saddle.null_vector(pattern).is_some() {
            return None;
        }
        let pulled = (0..).zip(&units).map(|(k, unit)| random(k) / unit);
        let loose = saddle.solve(&pulled.chain(rows.list().iter().map(|_| 0.0)).collect::<Vec<_>>());
        let determined: Vec<bool> = loose.iter().zip(&units).map(|(x, unit)| x.abs() <= STILL * unit).collect();
        let (parts, before, rows) = (parts.clone(), before.clone(), rows.clone());
        determined.contains(&true).then_some(Self { parts, part, before, rows, units, saddle, determined })
    }

    /// What P says for G elsewhere; an error if a step that goes there may leave the branch.
    pub fn turn(&self, after: &Quantities) -> Result<BranchTurn, StepFailure> {
        let changed = self.change(after);
        if changed == 0.0 {
            return Ok(BranchTurn::default());
        }
        let radius = self.radius(after);
        let meet = (radius - 1.0).abs() <= NEARER || radius >= NEARER.recip();
        match changed <= MET || meet {
            true => Ok(BranchTurn { radius: radius.min(AIM), met: radius.is_nan() || radius > MOST }),
            false if radius <= MOST => Ok(BranchTurn { radius, met: false }),
            false => Err(StepFailure::Branch(growth(radius))),
        }
    }

    fn change(&self, after: &Quantities) -> f64 {
        let rows = self.parts.list[self.part].rows.iter().copied();
        change([&self.before, after], rows, (&self.parts.of_equations.columns, self.rows.units()))
    }

    fn radius(&self, after: &Quantities) -> f64 {
        let drawn = (0..).zip(self.units.iter().zip(&self.determined));
        let mut x: Vec<f64> = drawn.map(|(k, (unit, &d))| if d { unit * random(k) } else { 0.0 }).collect();
        let mut half = 0.0;
        for power in 0..POWERS {
            if power == POWERS / 2 {
                half = self.size(&x);
            }
            x = self.moved(self.turned(after, &x).into_iter());
        }
        let last = self.size(&x);
        if last == 0.0 { 0.0 } else { (last / half).powf(2.0 / POWERS as f64) }
    }

    /// dx with `G dx = b` on the kept rows, on the determined DOFs.
    fn moved(&self, b: impl Iterator<Item = f64>) -> Vec<f64> {
        let rhs: Vec<f64> = self.units.iter().map(|_| 0.0).chain(b).collect();
        let dx = self.saddle.solve(&rhs);
        dx.iter().zip(&self.determined).map(|(&dx, &determined)| if determined { dx } else { 0.0 }).collect()
    }

    /// `(G - G') x` on the kept rows.
    fn turned(&self, after: &Quantities, x: &[f64]) -> Vec<f64> {
        let (before, after) = (self.before.g(), after.g());
        let x = |j: usize| self.parts.place(self.part, j).map_or(0.0, |place| x[place]);
        let pairs = |&row: &usize| before.row(row).zip(after.row(row));
        self.rows.list().iter().map(|r| pairs(r).map(|((j, a), (_, b))| (a - b) * x(j)).sum()).collect()
    }

    fn size(&self, x: &[f64]) -> f64 {
        let sizes = x.iter().zip(&self.units).map(|(x, unit)| (x / unit).abs());
        // No number is larger than all.
        sizes.fold(0.0, |most, x| if most.is_nan() || x <= most { most } else { x })
    }
}

/// How much longer the next step may be; a radius that is no number is as bad as a large one.
pub fn growth(radius: f64) -> f64 {
    (AIM / radius).max(0.1)
}

fn entries(before: &Quantities, rows: &KeptRows, (parts, part): (&EquilibriumParts, usize)) -> SaddleEntries {
    let (free, g) = (&parts.list[part].free, before.g());
    let n = free.len();
    let mut list: Vec<_> = free.iter().enumerate().map(|(i, &j)| (i, i, rows.units()[j].powi(-2))).collect();
    for (r, &row) in (n..).zip(rows.list()) {
        let there = g.row(row).filter_map(|(j, v)| Some((parts.place(part, j)?, v)));
        list.extend(there.flat_map(|(j, v)| [(r, j, v), (j, r, v)]));
    }
    SaddleEntries { size: n + rows.list().len(), stiff: n, list, units: Vec::new() }
}

/// EquilibriumParts of a step at which functions of time are looked at: square roots of primes less their whole part. Of no number of periods do they come near
/// whole ones together, unless it is very large.
const BETWEEN: [f64; 8] =
    [0.414_213_6, 0.732_050_8, 0.236_068, 0.645_751_3, 0.316_624_8, 0.605_551_3, 0.123_105_6, 0.358_898_9];
/// A step whose way is off the straight one by less than this part of its length is seen well enough from its end.
const STRAIGHT: f64 = 0.1;
/// One that is off by more than this part comes back, as from a whole turn: its end says nothing of it.
const BACK: f64 = 0.5;
/// The largest spectral radius anywhere on a way that comes back.
const MOST_BACK: f64 = 0.1;

/// Of a part whose way is not straight: how far it goes, and the largest spectral radius that it may have there.
struct CurvedWay<'a> {
    branch: &'a Branch,
    dx: Vec<f64>,
    most: f64,
}

/// The parts that functions of time may lead off their branches, each with the reason.
pub fn check_jumps(
    branches: &[&Branch],
    course: &mut TimePath,
    [from, to]: [f64; 2],
    room: &mut Quantities,
) -> Result<BTreeMap<usize, StepFailure>, StepFailure> {
    let mut led = BTreeMap::new();
    if branches.is_empty() || matches!(course, TimePath::Still(_)) {
        return Ok(led);
    }
    let straight = ahead(branches, course, to, room)?;
    for part in BETWEEN {
        let there = ahead(branches, course, from + part * (to - from), room)?;
        let ways = branches.iter().zip(there).zip(&straight);
        let bent: Vec<CurvedWay> =
            ways.filter_map(|((branch, dx), straight)| branch.bent(dx, straight, part)).collect();
        pass(&bent, course, room, &mut led)?;
    }
    course.go_between(to)?;
    Ok(led)
}

/// How far the determined DOFs of each part go by a load factor, to first order.
fn ahead(
    branches: &[&Branch],
    course: &mut TimePath,
    factor: f64,
    room: &mut Quantities,
) -> Result<Vec<Vec<f64>>, StepFailure> {
    course.go_between(factor)?;
    if let Some(first) = branches.first() {
        course.set().evaluate(first.before.u(), room)?;
    }
    Ok(branches.iter().map(|branch| branch.moved(branch.rows.list().iter().map(|&r| -room.c()[r]))).collect())
}

/// Adds the parts to which something may happen where they pass.
fn pass(
    bent: &[CurvedWay],
    course: &TimePath,
    room: &mut Quantities,
    led: &mut BTreeMap<usize, StepFailure>,
) -> Result<(), StepFailure> {
    let Some(first) = bent.first() else { return Ok(()) };
    let mut u = first.branch.before.u().to_vec();
    let is_finite = |way: &CurvedWay| way.dx.iter().all(|dx| dx.is_finite());
    for CurvedWay { branch, dx, .. } in bent.iter().filter(|way| is_finite(way)) {
        branch.parts.list[branch.part].free.iter().zip(dx).for_each(|(&j, dx)| u[j] += dx);
    }
    course.set().evaluate(&u, room)?;
    for way in bent {
        let found = if is_finite(way) { way.branch.passes(room, way.most) } else { Err(StepFailure::Branch(0.0)) };
        found.unwrap_or_else(|failure| _ = led.entry(way.branch.part).or_insert(failure));
    }
    Ok(())
}

impl Branch {
    /// Nothing if a way is as straight as it needs to be; `straight` is that of the whole step, of which it is so large a part.
    fn bent(&self, dx: Vec<f64>, straight: &[f64], part: f64) -> Option<CurvedWay<'_>> {
        let off: Vec<f64> = dx.iter().zip(straight).map(|(x, whole)| x - part * whole).collect();
        let off = self.size(&off) / self.size(straight);
        let most = if off <= BACK { MOST } else { MOST_BACK };
        (off.is_nan() || off > STRAIGHT).then_some(CurvedWay { branch: self, dx, most })
    }

    fn passes(&self, there: &Quantities, most: f64) -> Result<(), StepFailure> {
        let radius = self.turn(there)?.radius;
        let far = radius > most && self.change(there) > MET;
        if far { Err(StepFailure::Branch(growth(radius))) } else { Ok(()) }
    }
}
