//! Several motors on one joint, and motors that carry other nodes.

use qless_constraints::types::{Body, Cylindrical, Point, Revolute, RotationMotor, TranslationMotor};
use qless_constraints::{AddError, ConstraintSet};

use super::{ACCURACY, Driven, UNITS, Z, about, follow};
use crate::linkages::{Outcome, random};
use crate::poses::{KINDS, Kind, Pose, STRIDE, add, body, norm, scale, sub, then, turn, turned};

/// A rod that is turned and pushed in its sleeve, which turns as well: it moves along a screw for eight turns.
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

/// A node without rotations, moved along three axes of a rotating body: `p = R(t) (P + sum d_k(t) t_k)`.
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
