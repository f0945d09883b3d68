//! Whether functions of time lead along the branch from one load factor to another: a whole turn between two steps is none at their ends.
//!
//! Time is that of the whole model: one evaluation at each time serves all parts.

use std::collections::BTreeMap;

use super::super::Failure;
use super::super::course::Course;
use super::{Branch, MET, growth};
use crate::Quantities;

/// Parts of a step at which functions of time are looked at: square roots of primes less their whole part. Of no number of periods do they come near
/// whole ones together, unless it is very large.
const BETWEEN: [f64; 8] =
    [0.414_213_6, 0.732_050_8, 0.236_068, 0.645_751_3, 0.316_624_8, 0.605_551_3, 0.123_105_6, 0.358_898_9];
/// A step whose way is off the straight one by less than this part of its length is seen well enough from its end.
const BENT: f64 = 0.5;
/// The spectral radius where a way is off the straight one, of a step that is accepted all the same.
const BENT_MOST: f64 = 0.1;

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
        let bent = ways.filter(|((branch, there), straight)| branch.is_bent(there, straight, part));
        let bent: Vec<(&Branch, Vec<f64>)> = bent.map(|((branch, there), _)| (*branch, there)).collect();
        come_back(&bent, course, room, &mut led)?;
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

/// Adds the parts to which something may happen on a way that goes so far and comes back.
fn come_back(
    bent: &[(&Branch, Vec<f64>)],
    course: &Course,
    room: &mut Quantities,
    led: &mut BTreeMap<usize, Failure>,
) -> Result<(), Failure> {
    let Some((first, _)) = bent.first() else { return Ok(()) };
    let mut u = first.before.u().to_vec();
    let is_finite = |dx: &[f64]| dx.iter().all(|dx| dx.is_finite());
    for (branch, dx) in bent.iter().filter(|(_, dx)| is_finite(dx)) {
        branch.parts.list[branch.part].free.iter().zip(dx).for_each(|(&j, dx)| u[j] += dx);
    }
    course.set().evaluate(&u, room)?;
    for (branch, dx) in bent {
        let found = if is_finite(dx) { branch.comes_back(room) } else { Err(Failure::Branch(0.0)) };
        found.unwrap_or_else(|failure| _ = led.entry(branch.part).or_insert(failure));
    }
    Ok(())
}

impl Branch {
    /// Whether a way is off the straight one, of which it is so large a part.
    fn is_bent(&self, there: &[f64], straight: &[f64], part: f64) -> bool {
        let off: Vec<f64> = there.iter().zip(straight).map(|(x, whole)| x - part * whole).collect();
        let is_straight = self.size(&off) <= BENT * self.size(straight);
        !is_straight
    }

    fn comes_back(&self, there: &Quantities) -> Result<(), Failure> {
        let turn = self.turn(there)?;
        let far = turn.radius > BENT_MOST && self.change(there) > MET;
        if far { Err(Failure::Branch(growth(turn.radius))) } else { Ok(()) }
    }
}
