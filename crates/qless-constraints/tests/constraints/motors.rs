//! Mechanisms that motors drive over many turns, against their closed forms, in every unit.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use qless_constraints::newton::{NewtonOptions, Solution, solve};
use qless_constraints::types::{
    Body, Cylindrical, Point, Prismatic, Revolute, RotationMotor, TranslationMotor, Universal,
};
use qless_constraints::{AddError, ConstraintSet, SetBuilder};

use crate::linkages::{Outcome, random, rank};
use crate::poses::{
    AT_REST, KINDS, Kind, Pose, Quaternion, STRIDE, Vector, add, angle, back, body, dense_rank, dot, norm, norm_of,
    place, pose, scale, sub, then, turn, turned, values,
};

const Z: Vector = [0.0, 0.0, 1.0];
const UNITS: [f64; 3] = [1e-6, 1.0, 1e6];
/// Relative to the size of the mechanism, in radians; another branch is off by its size.
const ACCURACY: f64 = 1e-10;

/// A closed ring of hinges `(point, axis)`, the first body being the ground; the first hinge has a motor that turns as time goes.
struct Ring {
    hinges: Vec<(Vector, Vector)>,
    kind: Kind,
}

impl Ring {
    fn from(&self, i: usize) -> Vector {
        let (p, q) = (self.hinges[i].0, self.hinges[i + 1].0);
        scale(0.5, add(p, q))
    }

    /// Body `i`, from 0, is between its hinges; after the last one comes the ground.
    fn body(&self, i: usize) -> Body {
        if i + 1 < self.hinges.len() { body(i, self.kind, self.from(i)) } else { Body::ground() }
    }

    fn add(&self, builder: &mut SetBuilder) -> Outcome {
        for (i, &(at, axis)) in self.hinges.iter().enumerate() {
            let before = if i == 0 { Body::ground() } else { self.body(i - 1) };
            builder.add(format!("hinge {}", i + 1), Revolute { a: before, b: self.body(i), at, axis })?;
        }
        (0..self.hinges.len() - 1).try_for_each(|i| norm_of(builder, i, self.kind))
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

    /// The rotation of body `i`, from 0; of the ground after the last one.
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

/// `a - b`, up to whole turns.
fn difference(a: f64, b: f64) -> f64 {
    let d = a - b;
    d - TAU * (d / TAU).round()
}

/// Goes from time to time by Newton's method, each time from where it was, and looks at each place.
fn follow(
    set: &mut ConstraintSet,
    times: impl IntoIterator<Item = f64>,
    mut look: impl FnMut(f64, (&ConstraintSet, &Solution)) -> Outcome,
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

/// A driven mechanism, and where its bodies are in closed form.
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

    /// At each time the closed form holds to rounding, and nothing can move: the motor holds the mechanism there.
    fn check(&mut self, times: impl IntoIterator<Item = f64>) -> Outcome {
        let full = 6 * self.kinds.len() + self.norms();
        for time in times {
            self.set.set_time(time)?;
            let mut u = vec![0.0; self.set.dofs()];
            for (i, pose) in (self.poses)(time).into_iter().enumerate() {
                place(&mut u, i, self.kinds[i], self.from[i], pose);
            }
            let (c, rounding) = (values(&self.set, &u)?, self.set.rounding(&u)?);
            // Lengths of Euler parameters come last; those that were put in are as long as they are.
            for row in 0..c.len() - self.norms() {
                let bound = 64.0 * rounding.c()[row];
                assert!(c[row].abs() <= bound, "time {time}, {}: {:e}, {bound:e}", self.set.label(row)?, c[row]);
            }
            assert_eq!(dense_rank(&self.set, &u, self.unit)?, full, "time {time}");
        }
        Ok(())
    }

    /// Newton's method goes there as well, each equation holds to its own rounding, and the rank is that of the singular values.
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

/// A body that was at `from`, turned so that its point `point` goes to `to`.
fn about(turn: Quaternion, from: Vector, point: Vector, to: Vector) -> Pose {
    Pose { at: sub(to, turned(turn, sub(point, from))), turn }
}

/// The angle of a vector in the plane.
fn slope(v: Vector) -> f64 {
    v[1].atan2(v[0])
}

/// Every twelfth part of a turn, dead centres included.
fn twelfths(turns: u32) -> impl Iterator<Item = f64> {
    (0..=24 * turns).map(|k| f64::from(k) * PI / 12.0)
}

/// `x = r cos phi + sqrt(l^2 - r^2 sin^2 phi)`, through both dead centres, which are hit exactly, six times round.
#[test]
fn slider_crank_through_dead_centres() -> Outcome {
    for unit in UNITS {
        for kind in KINDS {
            let (r, l, start) = (0.4 * unit, 1.1 * unit, PI / 3.0);
            let pin = |phi: f64| [r * phi.cos(), r * phi.sin(), 0.0];
            let end = |phi: f64| [r * phi.cos() + (l * l - (r * phi.sin()).powi(2)).sqrt(), 0.0, 0.0];
            let from = [scale(0.5, pin(start)), scale(0.5, add(pin(start), end(start))), end(start)];
            let bodies: [Body; 3] = std::array::from_fn(|i| body(i, kind, from[i]));
            let ground = Body::ground();
            let mut builder = ConstraintSet::builder(3 * STRIDE);
            builder.add("bearing", Revolute { a: ground, b: bodies[0], at: [0.0; 3], axis: Z })?;
            builder.add("pin", Revolute { a: bodies[0], b: bodies[1], at: pin(start), axis: Z })?;
            builder.add("wrist", Revolute { a: bodies[1], b: bodies[2], at: end(start), axis: Z })?;
            builder.add("bore", Prismatic { a: ground, b: bodies[2], at: end(start), axis: [1.0, 0.0, 0.0] })?;
            builder.add("motor", RotationMotor::new(ground, bodies[0], Z, |t| t))?;
            (0..3).try_for_each(|i| norm_of(&mut builder, i, kind))?;
            let rod = |phi: f64| slope(sub(end(phi), pin(phi)));
            let poses = |time: f64| {
                let phi = start + time;
                vec![
                    about(turn(Z, time), from[0], [0.0; 3], [0.0; 3]),
                    about(turn(Z, rod(phi) - rod(start)), from[1], pin(start), pin(phi)),
                    about(AT_REST, from[2], end(start), end(phi)),
                ]
            };
            let set = builder.build()?;
            let mut driven = Driven { set, kinds: vec![kind; 3], from: from.to_vec(), unit, poses: &poses };
            driven.check(twelfths(6))?;
            driven.drive(twelfths(2))?;
        }
    }
    Ok(())
}

/// The end of the rocker is where two circles meet; the crank turns three times.
#[test]
fn four_bar_linkage_follows_its_circles() -> Outcome {
    for unit in UNITS {
        for kind in KINDS {
            let (crank, coupler, rocker, base) = (0.5 * unit, 1.3 * unit, 1.1 * unit, [1.4 * unit, 0.0, 0.0]);
            let pin = |phi: f64| [crank * phi.cos(), crank * phi.sin(), 0.0];
            let end = |phi: f64| {
                let across = sub(base, pin(phi));
                let far = norm(across);
                let along = (coupler * coupler - rocker * rocker + far * far) / (2.0 * far);
                let high = (coupler * coupler - along * along).sqrt();
                let up = [-across[1], across[0], 0.0];
                add(pin(phi), add(scale(along / far, across), scale(high / far, up)))
            };
            let start = 0.7;
            let ring = Ring { hinges: vec![([0.0; 3], Z), (pin(start), Z), (end(start), Z), (base, Z)], kind };
            let poses = |time: f64| {
                let phi = start + time;
                let turn_of = |of: &dyn Fn(f64) -> Vector| turn(Z, slope(of(phi)) - slope(of(start)));
                vec![
                    about(turn(Z, time), ring.from(0), [0.0; 3], [0.0; 3]),
                    about(turn_of(&|phi| sub(end(phi), pin(phi))), ring.from(1), pin(start), pin(phi)),
                    about(turn_of(&|phi| sub(end(phi), base)), ring.from(2), base, base),
                ]
            };
            let from = (0..3).map(|i| ring.from(i)).collect();
            let mut driven = Driven { set: ring.driven()?, kinds: vec![kind; 3], from, unit, poses: &poses };
            driven.check(twelfths(3))?;
            driven.drive(twelfths(1))?;
        }
    }
    Ok(())
}

/// `T_1 .. T_k` of links with lengths and twists at joint angles: the point and the axis of the next hinge.
fn chain(angles: &[f64], lengths: &[f64], twists: &[f64]) -> Pose {
    let mut pose = Pose { at: [0.0; 3], turn: AT_REST };
    for k in 0..angles.len() {
        let about = then(pose.turn, turn(Z, angles[k]));
        pose.at = add(pose.at, turned(about, [lengths[k], 0.0, 0.0]));
        pose.turn = then(about, turn([1.0, 0.0, 0.0], twists[k]));
    }
    pose
}

/// Bennett's linkage: `a / sin alpha = b / sin beta` and `tan(theta_1 / 2) tan(theta_2 / 2) = sin((beta + alpha) / 2) / sin((beta - alpha) / 2)`.
///
/// Mobility 1, though four hinges in space have -2: 18 coordinates, 20 equations, rank 17.
#[test]
fn bennett_linkage_moves() -> Outcome {
    let (alpha, beta) = (0.7_f64, 1.2_f64);
    let ratio = f64::midpoint(beta, alpha).sin() / ((beta - alpha) / 2.0).sin();
    let second = |first: f64| 2.0 * (ratio * (first / 2.0).cos()).atan2((first / 2.0).sin());
    let angles = |first: f64| [first, second(first), -first, -second(first)];
    for unit in UNITS {
        let lengths = [unit, unit * beta.sin() / alpha.sin(), unit, unit * beta.sin() / alpha.sin()];
        let link = |first: f64, k: usize| chain(&angles(first)[..k], &lengths, &[alpha, beta, alpha, beta]);
        for kind in KINDS {
            let start: Vec<Pose> = (0..4).map(|k| link(1.0, k)).collect();
            let ring = Ring { hinges: start.iter().map(|f| (f.at, turned(f.turn, Z))).collect(), kind };
            // The end of each link is the hinge after it.
            let poses = |time: f64| {
                let moved = |i: usize| {
                    let end = link(1.0 + time, i + 1);
                    about(then(end.turn, back(start[i + 1].turn)), ring.from(i), start[i + 1].at, end.at)
                };
                (0..3).map(moved).collect()
            };
            let from = (0..3).map(|i| ring.from(i)).collect();
            let mut driven = Driven { set: ring.driven()?, kinds: vec![kind; 3], from, unit, poses: &poses };
            driven.check((0..=130).map(|k| 0.1 * f64::from(k)))?;
            driven.drive((0..=130).map(|k| 0.1 * f64::from(k)))?;
            let mut free = ring.builder();
            ring.add(&mut free)?;
            let free = free.build()?;
            for k in 0..=60 {
                let closed = link(1.0 + 0.1 * f64::from(k), 4);
                assert!(norm(closed.at) < 1e-13 * unit && (closed.turn[0].abs() - 1.0).abs() < 1e-13);
                let mut u = vec![0.0; free.dofs()];
                let all = poses(0.1 * f64::from(k)).into_iter().enumerate();
                all.for_each(|(i, pose)| place(&mut u, i, kind, ring.from(i), pose));
                assert_eq!(dense_rank(&free, &u, unit)?, 17 + driven.norms(), "place {k}");
            }
        }
    }
    Ok(())
}

/// Bricard's orthogonal linkage: angles alternate between theta and phi, and `cos theta + cos phi + cos theta cos phi = 0`
/// (Chen, You and Tarnai, Threefold-symmetric Bricard linkages for deployable structures, 2005, for a twist of a right angle). Mobility 1.
#[test]
fn bricard_linkage_moves() -> Outcome {
    let corners =
        [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 1.0, 1.0], [0.0, 1.0, 1.0], [0.0, 0.0, 1.0]];
    let axes = [[0.0, 1.0, 0.0], Z, [1.0, 0.0, 0.0]];
    for unit in UNITS {
        for kind in KINDS {
            let hinges = (0..6).map(|i| (scale(unit, corners[i]), axes[i % 3])).collect();
            let ring = Ring { hinges, kind };
            let mut free = ring.builder();
            ring.add(&mut free)?;
            let (free, mut set) = (free.build()?, ring.driven()?);
            let norms = if kind == Kind::Euler { 5 } else { 0 };
            // One way or the other, the first angle is a right one and what the motor does.
            let mut ways = [true; 2];
            follow(&mut set, (0..=9).map(|k| -0.05 * f64::from(k)), |time, (_, found)| {
                let u = &found.u;
                for (way, sign) in ways.iter_mut().zip([1.0, -1.0]) {
                    let theta = (FRAC_PI_2 + sign * time).cos();
                    let phi = (-theta / (1.0 + theta)).acos() - FRAC_PI_2;
                    let holds = |i: usize| {
                        let truth = if i.is_multiple_of(2) { time } else { phi };
                        (ring.angle(u, i).abs() - truth.abs()).abs() < ACCURACY
                    };
                    *way &= (0..6).all(holds);
                }
                assert!(
                    ways.contains(&true),
                    "unit {unit}, {kind:?}, time {time}: {:?}",
                    [0, 1, 2].map(|i| ring.angle(u, i))
                );
                assert_eq!(rank(&free, u)?, 29 + norms, "time {time}");
                Ok(())
            })?;
            assert_ne!(ways, [true; 2]);
        }
    }
    Ok(())
}

/// Shafts at an angle beta: `tan(psi_b) = tan(psi_a) cos(beta)`, over five turns.
#[test]
fn universal_joint_turns_unevenly() -> Outcome {
    let beta = 0.8_f64;
    let out = [beta.sin(), 0.0, beta.cos()];
    for unit in UNITS {
        for kinds in [[Kind::Vector; 2], [Kind::Euler; 2], [Kind::Vector, Kind::Euler]] {
            let from = [scale(-unit, Z), scale(unit, out)];
            let [a, b] = [0, 1].map(|i| body(i, kinds[i], from[i]));
            let mut builder = ConstraintSet::builder(2 * STRIDE);
            builder.add("in", Revolute { a: Body::ground(), b: a, at: scale(-2.0 * unit, Z), axis: Z })?;
            builder.add("out", Revolute { a: Body::ground(), b, at: scale(2.0 * unit, out), axis: out })?;
            let axes = ([0.0, 1.0, 0.0], [beta.cos(), 0.0, -beta.sin()]);
            builder.add("cross", Universal { a, b, at: [0.0; 3], axis_a: axes.0, axis_b: axes.1 })?;
            builder.add("motor", RotationMotor::new(Body::ground(), a, Z, |t| t))?;
            (0..2).try_for_each(|i| norm_of(&mut builder, i, kinds[i]))?;
            let poses = |psi: f64| {
                let other = (psi.sin() * beta.cos()).atan2(psi.cos());
                vec![Pose { at: from[0], turn: turn(Z, psi) }, Pose { at: from[1], turn: turn(out, other) }]
            };
            let set = builder.build()?;
            let mut driven = Driven { set, kinds: kinds.to_vec(), from: from.to_vec(), unit, poses: &poses };
            driven.check(twelfths(5))?;
            driven.drive(twelfths(5))?;
        }
    }
    Ok(())
}

/// A rod that is turned and pushed in its sleeve, which turns itself: it goes along a screw, eight times round.
#[test]
fn motors_drive_a_screw() -> Outcome {
    for unit in UNITS {
        for kinds in [[Kind::Vector; 2], [Kind::Euler; 2], [Kind::Euler, Kind::Vector]] {
            let (axis, carrier) = ([0.6, 0.0, -0.8], [0.0, 1.0, 0.0]);
            let (at, from) = (scale(unit, [0.2, 0.5, -0.3]), [[0.0; 3], scale(unit, [1.0, 0.4, 0.1])]);
            let [a, b] = [0, 1].map(|i| body(i, kinds[i], from[i]));
            let mut builder = ConstraintSet::builder(2 * STRIDE);
            builder.add("bearing", Revolute { a: Body::ground(), b: a, at: [0.0; 3], axis: carrier })?;
            builder.add("sleeve", Cylindrical { a, b, at, axis })?;
            builder.add("turns", RotationMotor::new(a, b, axis, |t| 2.0 * t))?;
            builder.add("pushes", TranslationMotor::new(a, b, at, axis, move |t| 0.1 * unit * t))?;
            builder.add("swings", RotationMotor::new(Body::ground(), a, carrier, |t| -t))?;
            (0..2).try_for_each(|i| norm_of(&mut builder, i, kinds[i]))?;
            let poses = |t: f64| {
                let swung = turn(carrier, -t);
                let joint = turned(swung, add(at, scale(0.1 * unit * t, axis)));
                let b = about(then(swung, turn(axis, 2.0 * t)), from[1], at, joint);
                vec![Pose { at: [0.0; 3], turn: swung }, b]
            };
            let set = builder.build()?;
            let mut driven = Driven { set, kinds: kinds.to_vec(), from: from.to_vec(), unit, poses: &poses };
            driven.check((0..=100).map(|k| 0.25 * f64::from(k)))?;
            driven.drive((0..=100).map(|k| 0.25 * f64::from(k)))?;
        }
    }
    Ok(())
}

/// A node without rotations, moved along three axes of a body that turns: `p = R(t) (P + sum d_k(t) t_k)`; by hand a node carries no axis.
#[test]
fn motors_move_nodes() -> Outcome {
    for unit in UNITS {
        for kind in KINDS {
            let (from, at) = (scale(unit, [0.3, -0.2, 0.5]), scale(unit, [1.0, 0.7, -0.4]));
            let (carrier, table) = ([0.6, 0.0, -0.8], body(0, kind, from));
            let node = Body::node(Point::new([7, 8, 9], at));
            let axes = [[1.0, 2.0, 2.0], [2.0, 1.0, -2.0], [2.0, -2.0, 1.0]];
            let travel = move |k: usize, t: f64| unit * (0.5 * t + random(k)) * (t + k as f64).sin();
            let mut builder = ConstraintSet::builder(STRIDE + 3);
            builder.add("bearing", Revolute { a: Body::ground(), b: table, at: from, axis: carrier })?;
            builder.add("turns", RotationMotor::new(Body::ground(), table, carrier, |t| t))?;
            for (k, axis) in axes.into_iter().enumerate() {
                builder.add("moves", TranslationMotor::new(table, node, at, axis, move |t| travel(k, t)))?;
            }
            let refused = builder.add("none", TranslationMotor::new(node, table, at, Z, |t| t)).expect_err("no axis");
            assert!(matches!(refused, AddError::Input { .. }), "{refused}");
            norm_of(&mut builder, 0, kind)?;
            let mut set = builder.build()?;
            follow(&mut set, (0..=40).map(|k| 0.3 * f64::from(k)), |time, (_, found)| {
                let moved = (0..3).fold(at, |p, k| add(p, scale(travel(k, time) / 3.0, axes[k])));
                let truth = add(from, turned(turn(carrier, time), sub(moved, from)));
                let off = norm(sub(add(at, [7, 8, 9].map(|j| found.u[j])), truth));
                assert!(off < ACCURACY * unit, "{kind:?}, unit {unit}, time {time}: {off:e}");
                Ok(())
            })?;
        }
    }
    Ok(())
}
