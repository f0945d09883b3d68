//! Whether a load step stays on its branch: DOFs that constraints and prescribed DOFs determine move along a curve, and loads have no part
//! in it.
//!
//! With G where a step starts, G' elsewhere and x on these DOFs, let `P x = dx` where `G dx = (G - G') x`. If `(1 - t) G x + t G' x = 0` then
//! `x = t P x`: while the spectral radius of P is below one, no G between the two loses rank, which it would where branches meet. A linkage that
//! went over to its mirror image has an eigenvalue above one, however well it satisfies the constraints. Units drop out: a change of them
//! is a similarity of P. Each part has a P of its own.

mod lead;

use std::sync::Arc;

use super::Failure;
use super::parts::Parts;
use super::pattern::Pattern;
use super::rows::Rows;
use super::saddle::{Entries, Saddle};
use crate::common::random;
use crate::newton::change;
pub use lead::lead;
use qless_constraints::Quantities;

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
    parts: Arc<Parts>,
    part: usize,
    before: Arc<Quantities>,
    rows: Rows,
    /// Of DOFs that are not prescribed.
    units: Vec<f64>,
    /// `[S^-2, G^T; G, 0]` with the units S: the shortest of all motions that G allows.
    saddle: Saddle,
    determined: Vec<bool>,
}

/// What is seen of a step from where it starts to where it ends.
#[derive(Clone, Copy, Default)]
pub struct Turn {
    /// The spectral radius of P.
    pub radius: f64,
    /// Whether branches meet on the way, or nearly so: which one is taken, Newton's method decides.
    pub met: bool,
}

impl Branch {
    /// At a configuration that satisfies the constraints of a part; nothing if they determine no DOF, or branches meet there.
    pub fn new(
        before: &Arc<Quantities>,
        rows: &Rows,
        (parts, part): (&Arc<Parts>, usize),
        pattern: &mut Pattern,
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
    pub fn turn(&self, after: &Quantities) -> Result<Turn, Failure> {
        let changed = self.change(after);
        if changed == 0.0 {
            return Ok(Turn::default());
        }
        let radius = self.radius(after);
        let meet = (radius - 1.0).abs() <= NEARER || radius >= NEARER.recip();
        match changed <= MET || meet {
            true => Ok(Turn { radius: radius.min(AIM), met: radius.is_nan() || radius > MOST }),
            false if radius <= MOST => Ok(Turn { radius, met: false }),
            false => Err(Failure::Branch(growth(radius))),
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

fn entries(before: &Quantities, rows: &Rows, (parts, part): (&Parts, usize)) -> Entries {
    let (free, g) = (&parts.list[part].free, before.g());
    let n = free.len();
    let mut list: Vec<_> = free.iter().enumerate().map(|(i, &j)| (i, i, rows.units()[j].powi(-2))).collect();
    for (r, &row) in (n..).zip(rows.list()) {
        let there = g.row(row).filter_map(|(j, v)| Some((parts.place(part, j)?, v)));
        list.extend(there.flat_map(|(j, v)| [(r, j, v), (j, r, v)]));
    }
    Entries { size: n + rows.list().len(), stiff: n, list, units: Vec::new() }
}
