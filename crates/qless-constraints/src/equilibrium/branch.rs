//! Whether a load step stays on its branch: DOFs that constraints and prescribed DOFs determine move along a curve, and loads have no part
//! in it.
//!
//! With G where a step starts, G' elsewhere and x on these DOFs, let `P x = dx` where `G dx = (G - G') x`. If `(1 - t) G x + t G' x = 0` then
//! `x = t P x`: while the spectral radius of P is below one, no G between the two loses rank, which it would where branches meet. A linkage that
//! went over to its mirror image has an eigenvalue above one, however well it satisfies the constraints. Units drop out: a change of them
//! is a similarity of P.

use super::Failure;
use super::course::Course;
use super::pattern::Pattern;
use super::rows::Rows;
use super::saddle::{Entries, Saddle};
use crate::newton::{change, random};
use crate::{ConstraintSet, Quantities};

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
/// Parts of a step at which functions of time are looked at: square roots of primes less their whole part. Of no number of periods do they come near
/// whole ones together, unless it is very large.
const BETWEEN: [f64; 8] =
    [0.414_213_6, 0.732_050_8, 0.236_068, 0.645_751_3, 0.316_624_8, 0.605_551_3, 0.123_105_6, 0.358_898_9];
/// A step whose way is off the straight one by less than this part of its length is seen well enough from its end.
const STRAIGHT: f64 = 0.1;
/// One that is off by more than this part comes back, as from a whole turn: its end says nothing of it.
const BACK: f64 = 0.5;
/// The largest spectral radius anywhere on a way that comes back.
const MOST_BACK: f64 = 0.1;

/// Where a load step starts.
pub struct Branch {
    before: Quantities,
    rows: Rows,
    /// Those that are not prescribed, and their units.
    free: Vec<usize>,
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
    /// At a configuration that satisfies the constraints; nothing if they determine no DOF, or branches meet there.
    pub fn new(before: &Quantities, rows: &Rows, free: &[usize], pattern: &mut Pattern) -> Option<Self> {
        let units: Vec<f64> = free.iter().map(|&j| rows.units()[j]).collect();
        let saddle = Saddle::new(&entries(before, rows, free), free.len(), 0.0, pattern).ok()?;
        if saddle.null_vector(pattern).is_some() {
            return None;
        }
        let pulled = (0..).zip(&units).map(|(k, unit)| random(k) / unit);
        let loose = saddle.solve(&pulled.chain(rows.list().iter().map(|_| 0.0)).collect::<Vec<_>>());
        let determined: Vec<bool> = loose.iter().zip(&units).map(|(x, unit)| x.abs() <= STILL * unit).collect();
        let (before, rows, free) = (before.clone(), rows.clone(), free.to_vec());
        determined.contains(&true).then_some(Self { before, rows, free, units, saddle, determined })
    }

    /// What P says for G elsewhere; an error if a step that goes there may leave the branch.
    pub fn turn(&self, after: &Quantities) -> Result<Turn, Failure> {
        let changed = change(&self.before, after, self.rows.units());
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

    /// Whether functions of time lead along the branch from one load factor to another: a whole turn between two steps is none at their ends.
    pub fn lead(&self, course: &mut Course, [from, to]: [f64; 2], room: &mut Quantities) -> Result<(), Failure> {
        if let Course::Still(_) = course {
            return Ok(());
        }
        let straight = self.ahead(course, to, room)?;
        for part in BETWEEN {
            let there = self.ahead(course, from + part * (to - from), room)?;
            let off: Vec<f64> = there.iter().zip(&straight).map(|(x, whole)| x - part * whole).collect();
            let off = self.size(&off) / self.size(&straight);
            if off.is_nan() || off > STRAIGHT {
                self.passes(course.set(), &there, room, if off <= BACK { MOST } else { MOST_BACK })?;
            }
        }
        course.go_between(to)
    }

    /// Whether a way may go through where the determined DOFs have gone by dx: not if P has a larger spectral radius there than `most`.
    fn passes(&self, set: &ConstraintSet, dx: &[f64], room: &mut Quantities, most: f64) -> Result<(), Failure> {
        if dx.iter().any(|dx| !dx.is_finite()) {
            return Err(Failure::Branch(0.0));
        }
        let mut u = self.before.u().to_vec();
        self.free.iter().zip(dx).for_each(|(&j, dx)| u[j] += dx);
        set.evaluate(&u, room)?;
        let radius = self.turn(room)?.radius;
        let far = radius > most && change(&self.before, room, self.rows.units()) > MET;
        if far { Err(Failure::Branch(growth(radius))) } else { Ok(()) }
    }

    /// How far the determined DOFs go by a load factor, to first order.
    fn ahead(&self, course: &mut Course, factor: f64, room: &mut Quantities) -> Result<Vec<f64>, Failure> {
        course.go_between(factor)?;
        course.set().evaluate(self.before.u(), room)?;
        Ok(self.moved(self.rows.list().iter().map(|&r| -room.c()[r])))
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
        let rhs: Vec<f64> = self.free.iter().map(|_| 0.0).chain(b).collect();
        let dx = self.saddle.solve(&rhs);
        dx.iter().zip(&self.determined).map(|(&dx, &determined)| if determined { dx } else { 0.0 }).collect()
    }

    /// `(G - G') x` on the kept rows.
    fn turned(&self, after: &Quantities, x: &[f64]) -> Vec<f64> {
        let (before, after) = (self.before.g(), after.g());
        let mut whole = vec![0.0; before.cols()];
        self.free.iter().zip(x).for_each(|(&j, &x)| whole[j] = x);
        let pairs = |&row: &usize| before.row(row).zip(after.row(row));
        self.rows.list().iter().map(|r| pairs(r).map(|((j, a), (_, b))| (a - b) * whole[j]).sum()).collect()
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

/// Whether no G can change.
pub fn is_straight(set: &ConstraintSet) -> bool {
    set.linear_rows().len() == set.equations()
}

fn entries(before: &Quantities, rows: &Rows, free: &[usize]) -> Entries {
    let (n, g) = (free.len(), before.g());
    let mut place = vec![None; g.cols()];
    free.iter().enumerate().for_each(|(i, &j)| place[j] = Some(i));
    let mut list: Vec<_> = free.iter().enumerate().map(|(i, &j)| (i, i, rows.units()[j].powi(-2))).collect();
    for (r, &row) in (n..).zip(rows.list()) {
        let there = g.row(row).filter_map(|(j, v)| Some((place[j]?, v)));
        list.extend(there.flat_map(|(j, v)| [(r, j, v), (j, r, v)]));
    }
    Entries { size: n + rows.list().len(), stiff: n, list, units: Vec::new() }
}
