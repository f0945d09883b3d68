//! Mechanisms that motors drive over many turns, against their closed forms, in every unit.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use qless_constraints::newton::{NewtonOptions, solve};
use qless_constraints::types::{Body, Cylindrical, Prismatic, Revolute, RotationMotor, TranslationMotor, Universal};
use qless_constraints::{ConstraintSet, SetBuilder};

use crate::linkages::{Outcome, rank};
use crate::poses::{
    KINDS, Kind, Pose, Quaternion, STRIDE, Vector, add, back, body, carried, dot, norm, norm_of, pose, scale, sub,
    then, turn, turned,
};

const Z: Vector = [0.0, 0.0, 1.0];
const UNITS: [f64; 3] = [1e-6, 1.0, 1e6];

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

    fn turn_of(&self, u: &[f64], i: usize) -> Quaternion {
        if i + 1 < self.hinges.len() { self.pose(u, i).turn } else { [1.0, 0.0, 0.0, 0.0] }
    }

    /// The angle about hinge `i`, from 1, in [-pi, pi].
    fn angle(&self, u: &[f64], i: usize) -> f64 {
        let q = then(back(self.turn_of(u, i - 1)), self.turn_of(u, i));
        let [q0, v @ ..] = q;
        let axis = scale(1.0 / norm(self.hinges[i].1), self.hinges[i].1);
        difference(2.0 * dot(v, axis).atan2(q0), 0.0)
    }
}

/// `a - b`, up to whole turns.
fn difference(a: f64, b: f64) -> f64 {
    let d = a - b;
    d - TAU * (d / TAU).round()
}

/// Goes from time to time, each time from where it was, and looks at each place.
fn follow(
    set: &mut ConstraintSet,
    times: impl IntoIterator<Item = f64>,
    mut look: impl FnMut(f64, &[f64]) -> Outcome,
) -> Outcome {
    let mut u = vec![0.0; set.dofs()];
    for time in times {
        set.set_time(time)?;
        u = solve(set, &u, &[], &NewtonOptions::default()).map_err(|error| format!("time {time}: {error}"))?.u;
        look(time, &u)?;
    }
    Ok(())
}

/// `x = r cos phi + sqrt(l^2 - r^2 sin^2 phi)`, through both dead centres, which are hit exactly, six times round.
#[test]
fn slider_crank_through_dead_centres() -> Outcome {
    for unit in UNITS {
        for kind in KINDS {
            let (r, l, start) = (0.4 * unit, 1.1 * unit, PI / 3.0);
            let slider_at = |phi: f64| r * phi.cos() + (l * l - (r * phi.sin()).powi(2)).sqrt();
            let (pin, end) = ([r * start.cos(), r * start.sin(), 0.0], [slider_at(start), 0.0, 0.0]);
            let from = [scale(0.5, pin), scale(0.5, add(pin, end)), end];
            let bodies: [Body; 3] = std::array::from_fn(|i| body(i, kind, from[i]));
            let ground = Body::ground();
            let mut builder = ConstraintSet::builder(3 * STRIDE);
            builder.add("bearing", Revolute { a: ground, b: bodies[0], at: [0.0; 3], axis: Z })?;
            builder.add("pin", Revolute { a: bodies[0], b: bodies[1], at: pin, axis: Z })?;
            builder.add("wrist", Revolute { a: bodies[1], b: bodies[2], at: end, axis: Z })?;
            builder.add("bore", Prismatic { a: ground, b: bodies[2], at: end, axis: [1.0, 0.0, 0.0] })?;
            builder.add("motor", RotationMotor::new(ground, bodies[0], Z, move |t| t - start))?;
            (0..3).try_for_each(|i| norm_of(&mut builder, i, kind))?;
            let mut set = builder.build()?;
            let times = (4..=6 * 24 + 4).map(|k| k as f64 * PI / 12.0);
            follow(&mut set, times, |phi, u| {
                let [crank, rod, slider] = [0, 1, 2].map(|i| pose(u, i, kind, from[i]));
                let found = carried(slider, end, end);
                let off = norm(sub(found, [slider_at(phi), 0.0, 0.0])) / unit;
                assert!(off < 4e-14, "unit {unit}, {kind:?}, phi {phi}: {found:?}, off by {off:e}");
                let pins = [carried(crank, from[0], pin), carried(rod, from[1], pin)];
                let truth = [r * phi.cos(), r * phi.sin(), 0.0];
                assert!(pins.iter().all(|p| norm(sub(*p, truth)) < 4e-14 * unit), "phi {phi}: {pins:?}");
                Ok(())
            })?;
        }
    }
    Ok(())
}

/// The end of the rocker is where two circles meet; the crank turns three times.
#[test]
fn four_bar_linkage_follows_its_circles() -> Outcome {
    for unit in UNITS {
        for kind in KINDS {
            let (crank, coupler, rocker, base) = (0.5 * unit, 1.3 * unit, 1.1 * unit, 1.4 * unit);
            let pin = |phi: f64| [crank * phi.cos(), crank * phi.sin(), 0.0];
            let end = |phi: f64| {
                let (p, d) = (pin(phi), [base, 0.0, 0.0]);
                let across = sub(d, p);
                let far = norm(across);
                let along = (coupler * coupler - rocker * rocker + far * far) / (2.0 * far);
                let high = (coupler * coupler - along * along).sqrt();
                add(p, add(scale(along / far, across), scale(high / far, [-across[1], across[0], 0.0])))
            };
            let start = 0.7;
            let hinges = vec![([0.0; 3], Z), (pin(start), Z), (end(start), Z), ([base, 0.0, 0.0], Z)];
            let ring = Ring { hinges, kind };
            let mut set = ring.driven()?;
            follow(&mut set, (0..=108).map(|k| k as f64 * PI / 18.0), |time, u| {
                let found = carried(ring.pose(u, 1), ring.from(1), ring.hinges[2].0);
                let off = norm(sub(found, end(start + time))) / unit;
                assert!(off < 4e-14, "unit {unit}, {kind:?}, time {time}: off by {off:e}");
                Ok(())
            })?;
        }
    }
    Ok(())
}

/// `T_1 .. T_k` of links with lengths and twists at joint angles: the point and the axis of the next hinge.
fn chain(angles: &[f64], lengths: &[f64], twists: &[f64]) -> Pose {
    let mut pose = Pose { at: [0.0; 3], turn: [1.0, 0.0, 0.0, 0.0] };
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
    let ratio = ((beta + alpha) / 2.0).sin() / ((beta - alpha) / 2.0).sin();
    let second = |first: f64| 2.0 * (ratio * (first / 2.0).cos()).atan2((first / 2.0).sin());
    let angles = |first: f64| [first, second(first), -first, -second(first)];
    for unit in UNITS {
        let lengths = [unit, unit * beta.sin() / alpha.sin(), unit, unit * beta.sin() / alpha.sin()];
        let twists = [alpha, beta, alpha, beta];
        for kind in KINDS {
            let start = angles(1.0);
            let hinges: Vec<_> = (0..4).map(|k| chain(&start[..k], &lengths, &twists)).collect();
            let ring = Ring { hinges: hinges.iter().map(|f| (f.at, turned(f.turn, Z))).collect(), kind };
            let mut free = ring.builder();
            ring.add(&mut free)?;
            let (free, mut set) = (free.build()?, ring.driven()?);
            let norms = if kind == Kind::Euler { 3 } else { 0 };
            follow(&mut set, (0..=130).map(|k| 0.1 * f64::from(k)), |time, u| {
                let truth = angles(1.0 + time);
                // The formula itself: the ring closes.
                let closed = chain(&truth, &lengths, &twists);
                assert!(norm(closed.at) < 1e-13 * unit && (closed.turn[0].abs() - 1.0).abs() < 1e-13);
                for (i, (angle, start)) in truth.iter().zip(start).enumerate() {
                    let off = difference(ring.angle(u, i), angle - start);
                    assert!(off.abs() < 1e-12, "unit {unit}, {kind:?}, time {time}, hinge {}: {off:e}", i + 1);
                }
                assert_eq!(rank(&free, u)?, 17 + norms, "time {time}");
                Ok(())
            })?;
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
            follow(&mut set, (0..=9).map(|k| -0.05 * f64::from(k)), |time, u| {
                for (way, sign) in ways.iter_mut().zip([1.0, -1.0]) {
                    let theta = (FRAC_PI_2 + sign * time).cos();
                    let phi = (-theta / (1.0 + theta)).acos() - FRAC_PI_2;
                    let holds = |i: usize| {
                        let truth = if i % 2 == 0 { time } else { phi };
                        (ring.angle(u, i).abs() - truth.abs()).abs() < 1e-12
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
            let mut set = builder.build()?;
            follow(&mut set, (0..=120).map(|k| k as f64 * PI / 12.0), |psi, u| {
                let [q0, v @ ..] = pose(u, 1, kinds[1], from[1]).turn;
                let found = 2.0 * dot(v, out).atan2(q0);
                let off = difference(found, (psi.sin() * beta.cos()).atan2(psi.cos()));
                assert!(off.abs() < 1e-13, "unit {unit}, {kinds:?}, psi {psi}: {off:e}");
                Ok(())
            })?;
        }
    }
    Ok(())
}

/// A rod that is turned and pushed in its sleeve, which turns itself: a point of it goes along a screw, eight times round.
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
            let mut set = builder.build()?;
            let point = scale(unit, [0.9, -0.2, 0.7]);
            follow(&mut set, (0..=100).map(|k| 0.25 * f64::from(k)), |t, u| {
                let on_a = add(turned(turn(axis, 2.0 * t), sub(point, at)), scale(0.1 * unit * t, axis));
                let truth = turned(turn(carrier, -t), add(at, on_a));
                let found = carried(pose(u, 1, kinds[1], from[1]), from[1], point);
                let off = norm(sub(found, truth)) / unit;
                assert!(off < 1e-13, "unit {unit}, {kinds:?}, t {t}: {off:e}");
                let longest = kinds
                    .iter()
                    .enumerate()
                    .filter(|k| *k.1 == Kind::Vector)
                    .map(|(i, _)| norm([u[STRIDE * i + 3], u[STRIDE * i + 4], u[STRIDE * i + 5]]));
                assert!(longest.fold(0.0, f64::max) < PI + 1e-12);
                Ok(())
            })?;
        }
    }
    Ok(())
}
