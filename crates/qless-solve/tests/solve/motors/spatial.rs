//! Spatial linkages, and shafts at an angle.

use std::f64::consts::FRAC_PI_2;

use qless_constraints::ConstraintSet;
use qless_constraints::types::{Body, Revolute, RotationMotor, Universal};

use super::{ACCURACY, Driven, Ring, UNITS, Z, about, follow, twelfths};
use crate::linkages::{Outcome, rank};
use crate::poses::{
    AT_REST, KINDS, Kind, Pose, STRIDE, add, back, body, dense_rank, norm, place, scale, then, turn, turned,
};

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
/// The mobility is 1, although four hinges in space count as -2: 18 coordinates, 20 equations, rank 17.
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
            // The end of each link is the next hinge.
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
            // In either direction, the first angle is a right one, and the motor follows it.
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
