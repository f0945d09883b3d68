//! Whether functions of time lead along the branch from one load factor to another: a whole turn between two steps is none at their ends.
//!
//! Time is that of the whole model: one evaluation at each time serves all parts.

use std::collections::BTreeMap;

use super::super::Failure;
use super::super::course::Course;
use super::{Branch, MET, MOST, growth};
use qless_constraints::Quantities;

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

/// Of a part whose way is not straight: how far it goes, and the largest spectral radius that it may have there.
struct Bent<'a> {
    branch: &'a Branch,
    dx: Vec<f64>,
    most: f64,
}

/// The parts that functions of time may lead off their branches, each with the reason.
pub fn lead(
    branches: &[&Branch],
    course: &mut Course,
    [from, to]: [f64; 2],
    room: &mut Quantities,
) -> Result<BTreeMap<usize, Failure>, Failure> {
    let mut led = BTreeMap::new();
    if branches.is_empty() || matches!(course, Course::Still(_)) {
        return Ok(led);
    }
    let straight = ahead(branches, course, to, room)?;
    for part in BETWEEN {
        let there = ahead(branches, course, from + part * (to - from), room)?;
        let ways = branches.iter().zip(there).zip(&straight);
        let bent: Vec<Bent> = ways.filter_map(|((branch, dx), straight)| branch.bent(dx, straight, part)).collect();
        pass(&bent, course, room, &mut led)?;
    }
    course.go_between(to)?;
    Ok(led)
}

/// How far the determined DOFs of each part go by a load factor, to first order.
fn ahead(
    branches: &[&Branch],
    course: &mut Course,
    factor: f64,
    room: &mut Quantities,
) -> Result<Vec<Vec<f64>>, Failure> {
    course.go_between(factor)?;
    if let Some(first) = branches.first() {
        course.set().evaluate(first.before.u(), room)?;
    }
    Ok(branches.iter().map(|branch| branch.moved(branch.rows.list().iter().map(|&r| -room.c()[r]))).collect())
}

/// Adds the parts to which something may happen where they pass.
fn pass(
    bent: &[Bent],
    course: &Course,
    room: &mut Quantities,
    led: &mut BTreeMap<usize, Failure>,
) -> Result<(), Failure> {
    let Some(first) = bent.first() else { return Ok(()) };
    let mut u = first.branch.before.u().to_vec();
    let is_finite = |way: &Bent| way.dx.iter().all(|dx| dx.is_finite());
    for Bent { branch, dx, .. } in bent.iter().filter(|way| is_finite(way)) {
        branch.parts.list[branch.part].free.iter().zip(dx).for_each(|(&j, dx)| u[j] += dx);
    }
    course.set().evaluate(&u, room)?;
    for way in bent {
        let found = if is_finite(way) { way.branch.passes(room, way.most) } else { Err(Failure::Branch(0.0)) };
        found.unwrap_or_else(|failure| _ = led.entry(way.branch.part).or_insert(failure));
    }
    Ok(())
}

impl Branch {
    /// Nothing if a way is as straight as it needs to be; `straight` is that of the whole step, of which it is so large a part.
    fn bent(&self, dx: Vec<f64>, straight: &[f64], part: f64) -> Option<Bent<'_>> {
        let off: Vec<f64> = dx.iter().zip(straight).map(|(x, whole)| x - part * whole).collect();
        let off = self.size(&off) / self.size(straight);
        let most = if off <= BACK { MOST } else { MOST_BACK };
        (off.is_nan() || off > STRAIGHT).then_some(Bent { branch: self, dx, most })
    }

    fn passes(&self, there: &Quantities, most: f64) -> Result<(), Failure> {
        let radius = self.turn(there)?.radius;
        let far = radius > most && self.change(there) > MET;
        if far { Err(Failure::Branch(growth(radius))) } else { Ok(()) }
    }
}
