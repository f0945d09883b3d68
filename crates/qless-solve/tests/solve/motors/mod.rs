//! Mechanisms driven by motors over many turns, compared with their closed forms in every unit.

mod planar;
mod screws;
mod spatial;

use std::f64::consts::{PI, TAU};

use qless_constraints::types::{Body, Revolute, RotationMotor};
use qless_constraints::{ConstraintSet, SetBuilder};
use qless_solve::newton::{NewtonOptions, NewtonSolution, solve};

use crate::linkages::Outcome;
use crate::poses::{
    AT_REST, Kind, Pose, Quaternion, STRIDE, Vector, add, angle, back, body, dense_rank, dot, norm, place, pose, scale,
    sub, then, turned, values,
};

const Z: Vector = [0.0, 0.0, 1.0];
const UNITS: [f64; 3] = [1e-6, 1.0, 1e6];
/// Tolerance relative to the size of the mechanism, and in radians. Another branch differs by the size of the mechanism.
const ACCURACY: f64 = 1e-10;

/// A closed ring of hinges `(point, axis)` whose first body is the ground; a motor turns the first hinge with time.
struct Ring {
    hinges: Vec<(Vector, Vector)>,
    kind: Kind,
}

impl Ring {
    fn from(&self, i: usize) -> Vector {
        let (p, q) = (self.hinges[i].0, self.hinges[i + 1].0);
        scale(0.5, add(p, q))
    }

    /// Body `i`, from 0, is between its hinges; the ground follows the last one.
    fn body(&self, i: usize) -> Body {
        if i + 1 < self.hinges.len() { body(i, self.kind, self.from(i)) } else { Body::ground() }
    }

    fn add(&self, builder: &mut SetBuilder) -> Outcome {
        for (i, &(at, axis)) in self.hinges.iter().enumerate() {
            let before = if i == 0 { Body::ground() } else { self.body(i - 1) };
            builder.add(format!("hinge {}", i + 1), Revolute { a: before, b: self.body(i), at, axis })?;
        }
        Ok(())
    }

    fn builder(&self) -> SetBuilder {
        ConstraintSet::builder(STRIDE * (self.hinges.len() - 1))
    }

    fn driven(&self) -> Outcome<ConstraintSet> {
        let mut builder = self.builder();
        self.add(&mut builder)?;
        builder.add("motor", RotationMotor::new(Body::ground(), self.body(0), self.hinges[0].1, |t| t))?;
        Ok(builder.build()?)
    }

    fn pose(&self, u: &[f64], i: usize) -> Pose {
        pose(u, i, self.kind, self.from(i))
    }

    /// The rotation of body `i`, from 0; of the ground after the last body.
    fn turn_of(&self, u: &[f64], i: usize) -> Quaternion {
        if i + 1 < self.hinges.len() { self.pose(u, i).turn } else { AT_REST }
    }

    /// The angle about hinge `i`, from 0, in [-pi, pi].
    fn angle(&self, u: &[f64], i: usize) -> f64 {
        let before = if i == 0 { AT_REST } else { self.turn_of(u, i - 1) };
        let [q0, v @ ..] = then(back(before), self.turn_of(u, i));
        let axis = scale(1.0 / norm(self.hinges[i].1), self.hinges[i].1);
        difference(2.0 * dot(v, axis).atan2(q0), 0.0)
    }
}

/// `a - b` modulo whole turns.
fn difference(a: f64, b: f64) -> f64 {
    let d = a - b;
    d - TAU * (d / TAU).round()
}

/// Advances through the times by Newton's method, each time from the last configuration, and calls `look` at each.
fn follow(
    set: &mut ConstraintSet,
    times: impl IntoIterator<Item = f64>,
    mut look: impl FnMut(f64, (&ConstraintSet, &NewtonSolution)) -> Outcome,
) -> Outcome {
    let mut u = vec![0.0; set.dofs()];
    for time in times {
        set.set_time(time)?;
        let found = solve(set, &u, &[], &NewtonOptions::default()).map_err(|error| format!("time {time}: {error}"))?;
        look(time, (set, &found))?;
        u = found.u;
    }
    Ok(())
}

/// A driven mechanism, and the closed form of its configuration.
struct Driven<'a> {
    set: ConstraintSet,
    kinds: Vec<Kind>,
    from: Vec<Vector>,
    unit: f64,
    poses: &'a dyn Fn(f64) -> Vec<Pose>,
}

impl Driven<'_> {
    fn norms(&self) -> usize {
        self.kinds.iter().filter(|&&kind| kind == Kind::Euler).count()
    }

    /// At each time the closed form satisfies the equations to rounding, and the rank is full: the motor determines the configuration.
    fn check(&mut self, times: impl IntoIterator<Item = f64>) -> Outcome {
        let full = 6 * self.kinds.len() + self.norms();
        for time in times {
            self.set.set_time(time)?;
            let mut u = vec![0.0; self.set.dofs()];
            for (i, pose) in (self.poses)(time).into_iter().enumerate() {
                place(&mut u, i, self.kinds[i], self.from[i], pose);
            }
            let (c, rounding) = (values(&self.set, &u)?, self.set.rounding(&u)?);
            // Norms of Euler parameters come last; those of the closed form are exact by themselves.
            for row in 0..c.len() - self.norms() {
                let bound = 64.0 * rounding.c()[row];
                assert!(c[row].abs() <= bound, "time {time}, {}: {:e}, {bound:e}", self.set.label(row)?, c[row]);
            }
            assert_eq!(dense_rank(&self.set, &u, self.unit)?, full, "time {time}");
        }
        Ok(())
    }

    /// Newton's method reaches the closed form, each equation holds to its own rounding, and the rank agrees with the singular values.
    fn drive(&mut self, times: impl IntoIterator<Item = f64>) -> Outcome {
        let (poses, kinds, from) = (self.poses, self.kinds.clone(), self.from.clone());
        let (unit, full) = (self.unit, 6 * self.kinds.len() + self.norms());
        follow(&mut self.set, times, |time, (set, found)| {
            let (c, rounding) = (values(set, &found.u)?, set.rounding(&found.u)?);
            let held = |r: &usize| found.redundant.contains(r) || c[*r].abs() <= 4.0 * rounding.c()[*r];
            let open = (0..c.len()).find(|r| !held(r));
            assert_eq!(open, None, "{kinds:?}, time {time}: {c:?}");
            assert_eq!(found.iterates.last().map(|iterate| iterate.rank), Some(full), "{kinds:?}, time {time}");
            for (i, truth) in poses(time).into_iter().enumerate() {
                let found = pose(&found.u, i, kinds[i], from[i]);
                let off = (norm(sub(found.at, truth.at)) / unit).max(angle(then(back(truth.turn), found.turn)));
                assert!(off < ACCURACY, "{kinds:?}, unit {unit}, time {time}, body {i}: {off:e}");
            }
            Ok(())
        })
    }
}

/// A body that was at `from`, rotated so that its point `point` moves to `to`.
fn about(turn: Quaternion, from: Vector, point: Vector, to: Vector) -> Pose {
    Pose { at: sub(to, turned(turn, sub(point, from))), turn }
}

/// The angle of a vector in the plane.
fn slope(v: Vector) -> f64 {
    v[1].atan2(v[0])
}

/// Every twelfth of a turn, including dead centres.
fn twelfths(turns: u32) -> impl Iterator<Item = f64> {
    (0..=24 * turns).map(|k| f64::from(k) * PI / 12.0)
}
