//! Platforms on three equal arms, one of them redundant: they translate on circles, however nearly collinear their joints are.

use qless_constraints::ConstraintSet;
use qless_constraints::types::{Distance, Driven, OnSphere, PlanarPoint};
use qless_solve::equilibrium::{EquilibriumOptions, Start, Target, drive};

use crate::equilibria::Weights;
use crate::linkages::{Outcome, random};

type Place = [f64; 2];

/// The angle of the first arm.
const SWING: f64 = -1.2;

/// An arm from the origin, and two more joints of the platform; the third arm is off their line by `bend`.
struct Platform {
    unit: f64,
    arm: f64,
    angle: f64,
    joints: [Place; 2],
}

impl Platform {
    fn random(seed: usize, bend: f64, unit: f64) -> Self {
        let [angle, arm, direction, v, w] = [0, 1, 2, 3, 4].map(|k| random(5 * seed + k));
        let at = |length: f64, angle: f64| [unit * length * angle.cos(), unit * length * angle.sin()];
        let direction = 2.55 + 0.2 * direction;
        let joints = [at(1.2 + 0.4 * v, direction), at(1.8 + 0.7 * w, direction + std::f64::consts::PI + bend)];
        Self { unit, arm: unit * (1.5 + 0.4 * arm), angle: 1.7 + 0.3 * angle, joints }
    }

    fn end(&self, swing: f64) -> Place {
        let angle = self.angle + swing;
        [self.arm * angle.cos(), self.arm * angle.sin()]
    }

    fn set(&self) -> Outcome<ConstraintSet> {
        let (end, [v, w]) = (self.end(0.0), self.joints);
        let beside = |joint: Place| [end[0] + joint[0], end[1] + joint[1]];
        let [a, b, c] = [(0, end), (2, beside(v)), (4, beside(w))].map(|(j, at)| PlanarPoint::new([j, j + 1], at));
        let mut builder = ConstraintSet::builder(6);
        for (x, y) in [(a, b), (a, c), (c, b)] {
            builder.add("platform", Distance::new(x, y))?;
        }
        builder.add("second arm", OnSphere { point: b, centre: v, radius: None })?;
        builder.add("third arm", OnSphere { point: c, centre: w, radius: None })?;
        let (arm, angle) = (self.arm, self.angle);
        builder.add("x of the end", Driven::new([(0, 1.0)], move |t| arm * (angle + SWING * t).cos() - end[0]))?;
        builder.add("y of the end", Driven::new([(1, 1.0)], move |t| arm * (angle + SWING * t).sin() - end[1]))?;
        Ok(builder.build()?)
    }
}

/// The platform has moved as far as the end of the arm, and one equation is redundant. Its remainder is rounding, and not a conflict.
#[test]
fn a_third_arm_never_contradicts_the_others() -> Outcome {
    for case in 0..400 {
        let (bend, unit) = (0.1_f64.powf(case as f64 % 20.0 / 7.0), [1e-6, 1.0, 1e6][case % 3]);
        let platform = Platform::random(case, bend, unit);
        let (mut set, loads) = (platform.set()?, [0.0; 6]);
        let target = Target { loads: &loads, prescribed: &[] };
        let (start, options) = (Start::at_rest(&set), EquilibriumOptions::default());
        let found = drive(&mut Weights { springs: vec![0.0; 6] }, &mut set, &start, &target, 1.0, &options)
            .map_err(|error| format!("case {case}, bend {bend:e}, unit {unit:e}: {error}"))?;
        assert_eq!(found.redundant.len(), 1, "case {case}: {:?}", found.redundant);
        let (from, to) = (platform.end(0.0), platform.end(SWING));
        let off = (0..6).map(|j| (found.u[j] - (to[j % 2] - from[j % 2])).abs()).fold(0.0, f64::max);
        assert!(off < 1e-8 * platform.unit, "case {case}, bend {bend:e}: off by {off:e}");
    }
    Ok(())
}
