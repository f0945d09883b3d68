//! Joints assembled from far away, and the motions that they allow, in every unit.

use faer::Mat;
use qless_constraints::types::{
    Body, Cylindrical, Fixed, Parallel, Perpendicular, Planar, Prismatic, Revolute, RotationMotor, Spherical,
    TranslationMotor, Universal,
};
use qless_constraints::{ConstraintSet, SetBuilder};
use qless_solve::newton::{NewtonOptions, solve};

use crate::linkages::{Outcome, random};
use crate::poses::{
    AT_REST, KINDS, Kind, Pose, Quaternion, STRIDE, Vector, add, angle, back, body, carried, cross, direction, dot,
    norm, place, pose, scale, sub, then, turn, turned, unit, values,
};

#[derive(Clone, Copy, Debug, PartialEq)]
enum Joint {
    Fixed,
    Prismatic,
    Revolute,
    Cylindrical,
    Planar,
    Parallel,
    Spherical,
    Universal,
    Perpendicular,
    RotationMotor,
    TranslationMotor,
}

use Joint as J;

/// Each joint with the number of degrees of freedom that it removes.
const JOINTS: [(Joint, usize); 11] = [
    (J::Fixed, 6),
    (J::Prismatic, 5),
    (J::Revolute, 5),
    (J::Cylindrical, 4),
    (J::Planar, 3),
    (J::Parallel, 2),
    (J::Spherical, 3),
    (J::Universal, 4),
    (J::Perpendicular, 1),
    (J::RotationMotor, 1),
    (J::TranslationMotor, 1),
];

const AXIS: Vector = [0.6, 0.0, -0.8];
const OTHER: Vector = [0.0, 1.0, 0.0];
/// Position of the motors.
const ANGLE: f64 = 9.0;
const TRAVEL: f64 = 0.7;

/// Unit of length, reference positions of the bodies, and the description of their rotations.
struct Model {
    unit: f64,
    from: [Vector; 2],
    kinds: [Kind; 2],
    /// Whether the first body is the ground.
    grounded: bool,
}

impl Model {
    fn new(unit: f64, kinds: [Kind; 2], grounded: bool) -> Self {
        let from = if grounded { [[0.0; 3], [1.3, 0.1, -0.4]] } else { [[0.2, -0.5, 0.3], [1.3, 0.1, -0.4]] };
        Self { unit, from: from.map(|x| scale(unit, x)), kinds, grounded }
    }

    fn at(&self) -> Vector {
        scale(self.unit, [0.7, 0.3, 0.2])
    }

    fn set(&self, joint: Joint) -> Outcome<ConstraintSet> {
        let mut builder = ConstraintSet::builder(2 * STRIDE);
        let a = if self.grounded { Body::ground() } else { body(0, self.kinds[0], self.from[0]) };
        self.add(&mut builder, joint, a, body(1, self.kinds[1], self.from[1]))?;
        Ok(builder.build()?)
    }

    fn add(&self, builder: &mut SetBuilder, joint: Joint, a: Body, b: Body) -> Outcome {
        let (at, axis, axis_a, axis_b, travel) = (self.at(), scale(3.0, AXIS), AXIS, OTHER, TRAVEL * self.unit);
        match joint {
            J::Fixed => builder.add("joint", Fixed { a, b, at })?,
            J::Prismatic => builder.add("joint", Prismatic { a, b, at, axis })?,
            J::Revolute => builder.add("joint", Revolute { a, b, at, axis })?,
            J::Cylindrical => builder.add("joint", Cylindrical { a, b, at, axis })?,
            J::Planar => builder.add("joint", Planar { a, b, at, normal: axis })?,
            J::Parallel => builder.add("joint", Parallel { a, b, axis })?,
            J::Spherical => builder.add("joint", Spherical { a, b, at })?,
            J::Universal => builder.add("joint", Universal { a, b, at, axis_a, axis_b })?,
            J::Perpendicular => builder.add("joint", Perpendicular { a, b, axis_a, axis_b })?,
            J::RotationMotor => builder.add("joint", RotationMotor::new(a, b, axis, |_| ANGLE))?,
            J::TranslationMotor => builder.add("joint", TranslationMotor::new(a, b, at, axis, move |_| travel))?,
        };
        Ok(())
    }

    /// Pose of body a in a case.
    fn pose_a(&self, case: usize) -> Pose {
        if self.grounded {
            return Pose { at: [0.0; 3], turn: AT_REST };
        }
        let turn = turn(direction(case + 50), 6.0 * random(case));
        Pose { at: scale(self.unit, direction(case + 90)), turn }
    }

    /// Pose of body b after it was turned by `turn` and moved by `shift` relative to body a, about the joint.
    fn pose_b(&self, a: Pose, on_a: Quaternion, shift: Vector) -> Pose {
        let joint = add(carried(a, self.from[0], self.at()), turned(a.turn, shift));
        let turn = then(a.turn, on_a);
        Pose { at: sub(joint, turned(turn, sub(self.at(), self.from[1]))), turn }
    }

    fn dofs(&self, poses: [Pose; 2]) -> Vec<f64> {
        let mut u = vec![0.0; 2 * STRIDE];
        (0..2).for_each(|i| place(&mut u, i, self.kinds[i], self.from[i], poses[i]));
        if self.grounded {
            u[..STRIDE].fill(0.0);
        }
        u
    }

    fn poses(&self, u: &[f64]) -> [Pose; 2] {
        let b = pose(u, 1, self.kinds[1], self.from[1]);
        [if self.grounded { self.pose_a(0) } else { pose(u, 0, self.kinds[0], self.from[0]) }, b]
    }
}

/// A motion that a joint allows: the turn and the shift of body b relative to body a.
fn motion(joint: Joint, case: usize, unit: f64) -> (Quaternion, Vector) {
    let amount = |k: usize| 6.2 * random(17 * case + k);
    let across = cross(AXIS, OTHER);
    let anywhere: Vector = [0.9 * unit * amount(1), unit * amount(2), unit * amount(3)];
    let along = scale(unit * amount(1), AXIS);
    let in_plane = add(scale(unit * amount(2), OTHER), scale(unit * amount(3), across));
    let (about, any) = (turn(AXIS, amount(4)), turn(direction(case + 20), amount(5)));
    // About the axis of a, then about that of b: both stay perpendicular.
    let crossed = then(turn(AXIS, amount(6)), turn(OTHER, amount(7)));
    // A twist after a tilt has the angle of the twist.
    let tilted = then(turn(add(OTHER, scale(amount(1), across)), 0.4 * amount(2)), turn(AXIS, ANGLE));
    match joint {
        J::Fixed => (AT_REST, [0.0; 3]),
        J::Prismatic => (AT_REST, along),
        J::Revolute => (about, [0.0; 3]),
        J::Cylindrical => (about, along),
        J::Planar => (about, in_plane),
        J::Parallel => (about, anywhere),
        J::Spherical => (any, [0.0; 3]),
        J::Universal => (crossed, [0.0; 3]),
        J::Perpendicular => (crossed, anywhere),
        J::RotationMotor => (tilted, anywhere),
        J::TranslationMotor => (any, add(in_plane, scale(TRAVEL * unit, AXIS))),
    }
}

/// Every motion of a joint satisfies its equations, at any angle and in any unit; a random motion does not.
#[test]
fn joints_allow_their_motions_and_no_others() -> Outcome {
    for unit in [1e-6, 1.0, 1e6] {
        for (joint, _) in JOINTS {
            for case in 0..24 {
                let model = Model::new(unit, [KINDS[case % 2], KINDS[case / 2 % 2]], case % 5 == 0);
                let set = model.set(joint)?;
                let a = model.pose_a(case);
                let (turn_on_a, shift) = motion(joint, case, unit);
                let u = model.dofs([a, model.pose_b(a, turn_on_a, shift)]);
                let (c, rounding) = (values(&set, &u)?, set.rounding(&u)?);
                // Euler parameters near rest have lost digits.
                let norms = c.len()
                    - usize::from(!model.grounded && model.kinds[0] == Kind::Euler)
                    - usize::from(model.kinds[1] == Kind::Euler);
                let allowed = c.iter().zip(rounding.c()).take(norms).all(|(c, r)| c.abs() <= 64.0 * r);
                assert!(allowed, "{joint:?}, unit {unit}, case {case}: {c:?}, rounding {:?}", rounding.c());
                assert!(rounding.c().iter().all(|&r| r < 1e-12 * unit.max(1.0)), "{joint:?}: {:?}", rounding.c());

                let (off, by) = (turn(direction(case + 400), 0.3), scale(0.3 * unit, direction(case + 300)));
                let u = model.dofs([a, model.pose_b(a, then(off, turn_on_a), add(shift, by))]);
                let c = values(&set, &u)?;
                assert!(c.iter().any(|c| c.abs() > 1e-3 * unit.min(1.0)), "{joint:?}, unit {unit}: {c:?}");
            }
        }
    }
    Ok(())
}

/// The number of removed degrees of freedom agrees with the singular values of G, at consistent configurations.
#[test]
fn joints_remove_their_degrees_of_freedom() -> Outcome {
    for (joint, removed) in JOINTS {
        for case in 0..12 {
            let model = Model::new(1.0, [KINDS[case % 2], KINDS[case / 2 % 2]], case % 5 == 0);
            let set = model.set(joint)?;
            let a = model.pose_a(case);
            let (turn_on_a, shift) = motion(joint, case, 1.0);
            let u = model.dofs([a, model.pose_b(a, turn_on_a, shift)]);
            let mut evaluation = set.allocate();
            set.evaluate(&u, &mut evaluation)?;
            let mut dense = Mat::<f64>::zeros(set.equations(), 2 * STRIDE);
            (0..set.equations()).for_each(|r| evaluation.g().row(r).for_each(|(j, v)| dense[(r, j)] = v));
            let values = dense.singular_values().map_err(|_| "no singular values")?;
            let norms = model.kinds.iter().skip(usize::from(model.grounded)).filter(|&&k| k == Kind::Euler).count();
            let rank = values.iter().filter(|&&s| s > 1e-9 * values[0]).count();
            assert_eq!(rank, removed + norms, "{joint:?}, case {case}: {values:?}");
            assert!(values.iter().take(rank).all(|s| *s > 1e-3 * values[0]), "{joint:?}, case {case}: {values:?}");
        }
    }
    Ok(())
}

/// From 1 to 3 rad away in any direction, every weld ends aligned, and every axis points in the right direction.
#[test]
fn joints_are_assembled_from_far_off() -> Outcome {
    for joint in [J::Fixed, J::Prismatic, J::Revolute, J::Cylindrical, J::Planar, J::Parallel] {
        let mut steps = 0;
        for case in 0..200 {
            let model = Model::new(1.0, [KINDS[case % 2], KINDS[case / 2 % 2]], case % 3 == 0);
            let set = model.set(joint)?;
            let a = model.pose_a(case);
            let off = turn(direction(case + 600), 1.0 + 2.0 * (case as f64 / 199.0));
            let start = model.dofs([a, model.pose_b(a, off, scale(2.0, direction(case + 700)))]);
            let solution = solve(&set, &start, &[], &NewtonOptions::default())
                .map_err(|error| format!("{joint:?}, case {case}: {error}"))?;
            let [a, b] = model.poses(&solution.u);
            let on_a = then(back(a.turn), b.turn);
            let aligned = if matches!(joint, J::Fixed | J::Prismatic) {
                angle(on_a)
            } else {
                norm(sub(turned(on_a, AXIS), AXIS))
            };
            assert!(aligned < 1e-7, "{joint:?}, case {case}: off by {aligned}");
            steps += solution.iterates.len() - 1;
        }
        println!("{joint:?}: {} steps in the mean", steps as f64 / 200.0);
    }
    Ok(())
}

/// Exactly half a turn away about a coordinate axis, as models are often built: welds are assembled. Opposite axes never count as satisfied;
/// if Newton's method finds no step from there, it fails.
#[test]
fn half_a_turn_is_not_aligned() -> Outcome {
    for joint in [J::Fixed, J::Prismatic, J::Revolute, J::Cylindrical, J::Planar, J::Parallel] {
        for kinds in [[Kind::Vector; 2], [Kind::Euler; 2]] {
            for axis in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], cross(AXIS, OTHER)] {
                let model = Model::new(1.0, kinds, true);
                let set = model.set(joint)?;
                let (a, off) = (model.pose_a(0), turn(axis, std::f64::consts::PI));
                let u = model.dofs([a, model.pose_b(a, off, [0.0; 3])]);
                let c = values(&set, &u)?;
                assert!(c.iter().any(|c| c.abs() > 1.0), "{joint:?} about {axis:?}: {c:?}");
                let weld = matches!(joint, J::Fixed | J::Prismatic);
                match solve(&set, &u, &[], &NewtonOptions::default()) {
                    Ok(solution) => {
                        let [_, b] = model.poses(&solution.u);
                        let off = if weld { angle(b.turn) } else { norm(sub(turned(b.turn, AXIS), AXIS)) };
                        assert!(off < 1e-7, "{joint:?} about {axis:?}: off by {off}");
                    }
                    Err(error) if weld => return Err(format!("{joint:?} about {axis:?}, {kinds:?}: {error}").into()),
                    Err(error) => println!("{joint:?} about {axis:?}, {kinds:?}: {error}"),
                }
            }
        }
    }
    Ok(())
}

/// Values are angles in radians: of the rotation, and between the axes.
#[test]
fn values_are_angles() -> Outcome {
    for case in 0..40 {
        let model = Model::new(1.0, [KINDS[case % 2], KINDS[case / 2 % 2]], false);
        let (a, by) = (model.pose_a(case), 3.1 * case as f64 / 39.0);
        let on_a = turn(direction(case), by);
        let u = model.dofs([a, model.pose_b(a, on_a, [0.0; 3])]);
        let length = |c: &[f64]| c.iter().fold(0.0, |sum: f64, c| sum.hypot(*c));
        let weld = model.set(J::Fixed)?;
        let rows: Vec<f64> = values(&weld, &u)?
            .into_iter()
            .zip(0..weld.equations())
            .filter_map(|(c, row)| weld.label(row).is_ok_and(|label| label.contains("turn")).then_some(c))
            .collect();
        assert!(
            (length(&rows) - by).abs() < 1e-14
                && norm(sub([rows[0], rows[1], rows[2]], scale(by, direction(case)))) < 1e-14
        );
        let tilt = dot(turned(on_a, AXIS), unit(AXIS)).clamp(-1.0, 1.0).acos();
        let c = values(&model.set(J::Parallel)?, &u)?;
        assert!((length(&c[..2]) - tilt).abs() < 1e-7, "case {case}: {c:?}, {tilt}");
    }
    Ok(())
}
