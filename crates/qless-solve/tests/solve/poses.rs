//! Poses of bodies, implemented independently of the library: quaternions, and their DOFs.

use qless_constraints::ConstraintSet;
use qless_constraints::types::Body;

use crate::linkages::{Outcome, random};

pub type Vector = [f64; 3];
pub type Quaternion = [f64; 4];

/// How the rotations of a body are described.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    Vector,
    Euler,
}

pub const KINDS: [Kind; 2] = [Kind::Vector, Kind::Euler];

/// Pose of a body: `x = at + R (X - from)` if it was at `from`.
#[derive(Clone, Copy, Debug)]
pub struct Pose {
    pub at: Vector,
    pub turn: Quaternion,
}

pub const AT_REST: Quaternion = [1.0, 0.0, 0.0, 0.0];

pub fn add(a: Vector, b: Vector) -> Vector {
    std::array::from_fn(|k| a[k] + b[k])
}

pub fn sub(a: Vector, b: Vector) -> Vector {
    std::array::from_fn(|k| a[k] - b[k])
}

pub fn scale(f: f64, a: Vector) -> Vector {
    a.map(|x| f * x)
}

pub fn dot(a: Vector, b: Vector) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

pub fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub fn norm(a: Vector) -> f64 {
    dot(a, a).sqrt()
}

pub fn unit(a: Vector) -> Vector {
    scale(1.0 / norm(a), a)
}

/// A rotation about an axis.
pub fn turn(axis: Vector, angle: f64) -> Quaternion {
    let [x, y, z] = scale((0.5 * angle).sin(), unit(axis));
    [(0.5 * angle).cos(), x, y, z]
}

/// Applies q first, then p.
pub fn then([p0, p @ ..]: Quaternion, [q0, q @ ..]: Quaternion) -> Quaternion {
    let [x, y, z] = add(add(scale(p0, q), scale(q0, p)), cross(p, q));
    [p0 * q0 - dot(p, q), x, y, z]
}

pub fn back([q0, x, y, z]: Quaternion) -> Quaternion {
    [q0, -x, -y, -z]
}

/// `R s`.
pub fn turned(q: Quaternion, s: Vector) -> Vector {
    let [_, x, y, z] = then(then(q, [0.0, s[0], s[1], s[2]]), back(q));
    [x, y, z]
}

/// The angle of a rotation, in [0, pi].
pub fn angle([q0, q @ ..]: Quaternion) -> f64 {
    2.0 * norm(q).atan2(q0.abs())
}

/// A unit vector, the same for a seed.
pub fn direction(seed: usize) -> Vector {
    let v: Vector = std::array::from_fn(|k| random(5 * seed + k));
    if norm(v) > 0.1 { unit(v) } else { direction(seed + 7_777) }
}

/// Seven DOFs for each body; a rotation vector does not use the last one.
pub const STRIDE: usize = 7;

/// Body `i`, at `from` in the reference configuration.
pub fn body(i: usize, kind: Kind, from: Vector) -> Body {
    let first = STRIDE * i;
    let position = [first, first + 1, first + 2];
    match kind {
        Kind::Vector => Body::with_vector(position, from, [first + 3, first + 4, first + 5]),
        Kind::Euler => Body::with_euler(position, from, [first + 3, first + 4, first + 5, first + 6]),
    }
}

/// Writes the DOFs of body `i`.
pub fn place(u: &mut [f64], i: usize, kind: Kind, from: Vector, pose: Pose) {
    let own = &mut u[STRIDE * i..][..STRIDE];
    own[..3].copy_from_slice(&sub(pose.at, from));
    let [q0, q @ ..] = pose.turn;
    match kind {
        Kind::Vector => {
            let (sine, sign) = (norm(q), if q0 < 0.0 { -1.0 } else { 1.0 });
            let factor = if sine > 0.0 { 2.0 * sign * sine.atan2(q0.abs()) / sine } else { 0.0 };
            own[3..6].copy_from_slice(&scale(factor, q));
            own[6] = 0.0;
        }
        Kind::Euler => own[3..].copy_from_slice(&[q0 - 1.0, q[0], q[1], q[2]]),
    }
}

/// Pose of body `i`.
pub fn pose(u: &[f64], i: usize, kind: Kind, from: Vector) -> Pose {
    let own = &u[STRIDE * i..][..STRIDE];
    let at = add(from, [own[0], own[1], own[2]]);
    let turn = match kind {
        Kind::Vector => {
            let theta = [own[3], own[4], own[5]];
            if norm(theta) > 0.0 { turn(theta, norm(theta)) } else { AT_REST }
        }
        Kind::Euler => [1.0 + own[3], own[4], own[5], own[6]],
    };
    Pose { at, turn }
}

/// New position of a point that was at `point` when the body was at `from`.
pub fn carried(pose: Pose, from: Vector, point: Vector) -> Vector {
    add(pose.at, turned(pose.turn, sub(point, from)))
}

/// c at u.
pub fn values(set: &ConstraintSet, u: &[f64]) -> Outcome<Vec<f64>> {
    let mut evaluation = set.allocate();
    set.evaluate(u, &mut evaluation)?;
    Ok(evaluation.c().to_vec())
}

/// Rank of G by singular values, with positions in a unit of length and rows divided by their largest entry.
pub fn dense_rank(set: &ConstraintSet, u: &[f64], unit: f64) -> Outcome<usize> {
    let mut evaluation = set.allocate();
    set.evaluate(u, &mut evaluation)?;
    let mut dense = faer::Mat::<f64>::zeros(set.equations(), set.dofs());
    for r in 0..set.equations() {
        let scaled = |(j, v): (usize, f64)| (j, if j % STRIDE < 3 { unit * v } else { v });
        let most = evaluation.g().row(r).map(|entry| scaled(entry).1.abs()).fold(0.0, f64::max);
        evaluation.g().row(r).map(scaled).for_each(|(j, v)| dense[(r, j)] = v / most);
    }
    let values = dense.singular_values().map_err(|_| "no singular values")?;
    // All singular values must be far from the gap.
    let rank = values.iter().filter(|&&s| s > 1e-6 * values[0]).count();
    let clear = values.iter().all(|s| !(1e-11..1e-4).contains(&(s / values[0])));
    if clear { Ok(rank) } else { Err(format!("no clear gap: {values:?}").into()) }
}
