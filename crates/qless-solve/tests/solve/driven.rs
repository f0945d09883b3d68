//! Equilibria driven by motors and right-hand sides: closed forms of the motion, and the work of the motor.

use std::f64::consts::TAU;

use qless_constraints::types::{Body, Driven, Revolute, RotationMotor, TranslationMotor};
use qless_constraints::{ConstraintId, ConstraintSet, TimeError};
use qless_solve::equilibrium::{Equilibrium, EquilibriumError, EquilibriumOptions, Start, Target, drive, solve};

use crate::equilibria::{Frame, UNITS, Weights};
use crate::linkages::{Outcome, random};
use crate::poses::{KINDS, Kind, STRIDE, Vector, add, body, norm, scale, sub};

const Z: Vector = [0.0, 0.0, 1.0];

/// A four-bar linkage with weights and springs at the middles of its bars; a function of time turns the crank.
struct FourBar {
    /// Crank, coupler, rocker, and the distance of the bearings.
    bars: [f64; 4],
    first: f64,
    weights: [Vector; 3],
    springs: [f64; 3],
    angle: fn(f64) -> f64,
    kind: Kind,
}

impl FourBar {
    /// A crank that turns fully, in units of length and force.
    fn random(seed: usize, [length, force]: [f64; 2]) -> Self {
        let number = |k: usize| random(97 * seed + k);
        let crank = 0.5 + 0.3 * number(0);
        let base = 2.0 + 0.3 * number(1);
        // Grashof's condition with a margin: the shortest and the longest bar together are shorter than the others.
        let (coupler, rocker) = (1.9 + 0.2 * number(2), 1.8 + 0.2 * number(3));
        Self {
            bars: [crank, coupler, rocker, base].map(|x| length * x),
            first: TAU * number(4),
            weights: [5, 7, 9].map(|k| [force * number(k), -force * (1.0 + number(k + 1)), 0.0]),
            springs: [11, 12, 13].map(|k| force / length * (1.0 + number(k))),
            angle: |t| 0.4 * t + 0.1 * t * t,
            kind: KINDS[seed % 2],
        }
    }

    /// The joints at an angle of the crank: the end of the rocker is an intersection of two circles.
    fn joints(&self, phi: f64) -> [Vector; 4] {
        let [crank, coupler, rocker, base] = self.bars;
        let pin = scale(crank, [phi.cos(), phi.sin(), 0.0]);
        let across = sub([base, 0.0, 0.0], pin);
        let far = norm(across);
        let along = (coupler * coupler - rocker * rocker + far * far) / (2.0 * far);
        let high = (coupler * coupler - along * along).sqrt();
        let side = [-across[1], across[0], 0.0];
        let end = add(pin, add(scale(along / far, across), scale(high / far, side)));
        [[0.0; 3], pin, end, [base, 0.0, 0.0]]
    }

    fn middle(&self, i: usize, phi: f64) -> Vector {
        let joints = self.joints(phi);
        scale(0.5, add(joints[i], joints[i + 1]))
    }

    fn body(&self, i: usize) -> Body {
        body(i, self.kind, self.middle(i, self.first))
    }

    fn set(&self) -> Outcome<(ConstraintSet, ConstraintId)> {
        let (joints, ground) = (self.joints(self.first), Body::ground());
        let mut builder = ConstraintSet::builder(3 * STRIDE);
        for i in 0..4_usize {
            let [a, b] = [i.checked_sub(1), (i < 3).then_some(i)].map(|i| i.map_or(ground, |i| self.body(i)));
            builder.add(format!("hinge {i}"), Revolute { a, b, at: joints[i], axis: Z })?;
        }
        let motor = builder.add("motor", RotationMotor::new(ground, self.body(0), Z, self.angle))?;
        for i in 0..3 {
            if self.kind == Kind::Vector {
                // The remaining part of the stride.
                builder.add("spare", Driven::new([(STRIDE * i + 6, 1.0)], |_| 0.0))?;
            }
        }
        Ok((builder.build()?, motor))
    }

    fn model(&self) -> Weights {
        let mut springs = vec![0.0; 3 * STRIDE];
        (0..3).for_each(|i| springs[STRIDE * i..][..3].fill(self.springs[i]));
        Weights { springs }
    }

    fn loads(&self) -> Vec<f64> {
        let mut loads = vec![0.0; 3 * STRIDE];
        (0..3).for_each(|i| loads[STRIDE * i..][..3].copy_from_slice(&self.weights[i]));
        loads
    }

    /// Energy of springs and weights.
    fn energy(&self, phi: f64) -> f64 {
        let of_body = |i: usize| -> f64 {
            let u = sub(self.middle(i, phi), self.middle(i, self.first));
            (0..3).map(|k| 0.5 * self.springs[i] * u[k] * u[k] - self.weights[i][k] * u[k]).sum()
        };
        (0..3).map(of_body).sum()
    }
}

/// The configuration of a driven linkage and the moment of its motor agree with the closed form.
fn check(bar: &FourBar, (set, motor): (&ConstraintSet, ConstraintId), found: &Equilibrium) -> f64 {
    let [length, force] = [bar.bars[3], norm(bar.weights[0]) + norm(bar.weights[1]) + norm(bar.weights[2])];
    let phi = bar.first + (bar.angle)(set.time());
    for i in 0..3 {
        let u = sub(bar.middle(i, phi), bar.middle(i, bar.first));
        let off = norm(sub(u, [0, 1, 2].map(|k| found.u[STRIDE * i + k])));
        assert!(off < 1e-8 * length, "body {i} at time {}: {:e}", set.time(), off / length);
    }
    let moment = -found.multipliers.of(motor)[0];
    let step = 1e-4;
    let [a, b, c, d] = [-2.0, -1.0, 1.0, 2.0].map(|k| bar.energy(phi + k * step));
    let slope = (a - 8.0 * b + 8.0 * c - d) / (12.0 * step);
    assert!((moment - slope).abs() < 1e-7 * force * length, "time {}: {moment:e}, {slope:e}", set.time());
    moment
}

/// The moment of the motor is the slope of the energy, and its work, by Gauss's rule, is the change of the energy; in every unit.
#[test]
fn the_work_of_a_motor_is_the_change_of_energy() -> Outcome {
    // Five points in [-1, 1], order ten.
    let (near, far) =
        ((5.0 - 2.0 * (10.0_f64 / 7.0).sqrt()).sqrt() / 3.0, (5.0 + 2.0 * (10.0_f64 / 7.0).sqrt()).sqrt() / 3.0);
    let (of_near, of_far) = ((322.0 + 13.0 * 70.0_f64.sqrt()) / 900.0, (322.0 - 13.0 * 70.0_f64.sqrt()) / 900.0);
    let points = [(-far, of_far), (-near, of_near), (0.0, 128.0 / 225.0), (near, of_near), (far, of_far)];
    for units in UNITS {
        let bar = FourBar::random(1, units);
        let ((mut set, motor), mut model, loads) = (bar.set()?, bar.model(), bar.loads());
        let target = Target { loads: &loads, prescribed: &[] };
        let mut start = Start { loads: loads.clone(), ..Start::at_rest(&set) };
        let (pieces, last) = (24, 6.0);
        let half = 0.5 * last / f64::from(pieces);
        let mut work = 0.0;
        for piece in 0..pieces {
            for (at, weight) in points {
                let time = half * (f64::from(2 * piece + 1) + at);
                let options = EquilibriumOptions::default();
                let found = drive(&mut model, &mut set, &start, &target, time, &options)?;
                // phi' = 0.4 + 0.2 t.
                work += half * weight * check(&bar, (&set, motor), &found) * (0.4 + 0.2 * time);
                start = found.start();
            }
        }
        let change = bar.energy(bar.first + (bar.angle)(last)) - bar.energy(bar.first);
        let size = norm(bar.weights[0]) * bar.bars[0];
        assert!((work - change).abs() < 1e-8 * size, "{units:?}: {work:e}, {change:e}");
    }
    Ok(())
}

/// Any linkage, at any time, in one call: on the branch where it started, after any number of turns.
#[test]
fn driven_linkages_stay_on_their_branch() -> Outcome {
    for seed in 0..60 {
        let bar = FourBar::random(seed, UNITS[seed % UNITS.len()]);
        let ((mut set, motor), mut model, loads) = (bar.set()?, bar.model(), bar.loads());
        let target = Target { loads: &loads, prescribed: &[] };
        let time = 20.0 * random(seed + 5);
        let (start, options) = (Start::at_rest(&set), EquilibriumOptions::default());
        let found = drive(&mut model, &mut set, &start, &target, time, &options)
            .map_err(|e| format!("{seed}, time {time}: {e}"))?;
        assert_eq!(set.time(), time);
        check(&bar, (&set, motor), &found);
    }
    Ok(())
}

/// A crank pushed by its slider gets to its dead centre and not beyond. Impossible motions are refused, and the set keeps its time.
#[test]
fn no_motor_pushes_beyond_a_dead_centre() -> Outcome {
    for [length, force] in UNITS {
        let (ground, r, l) = (Body::ground(), 0.5 * length, 2.0 * length);
        let (pin, end) =
            ([0.3 * length, 0.4 * length, 0.0], [0.3 * length + (l * l - 0.16 * length * length).sqrt(), 0.0, 0.0]);
        let body =
            |i: usize, at| Body::with_vector([6 * i, 6 * i + 1, 6 * i + 2], at, [6 * i + 3, 6 * i + 4, 6 * i + 5]);
        let (crank, rod) = (body(0, scale(0.5, pin)), body(1, scale(0.5, add(pin, end))));
        let slider = Body::node(qless_constraints::types::Point::new([12, 13, 14], end));
        let mut builder = ConstraintSet::builder(15);
        builder.add("bearing", Revolute { a: ground, b: crank, at: [0.0; 3], axis: Z })?;
        builder.add("pin", Revolute { a: crank, b: rod, at: pin, axis: Z })?;
        builder.add("wrist", qless_constraints::types::Spherical { a: rod, b: slider, at: end })?;
        builder.add("guide", Driven::new([(13, 1.0)], |_| 0.0))?;
        let x = [1.0, 0.0, 0.0];
        let motor = builder.add("push", TranslationMotor::new(ground, slider, end, x, move |t| length * t))?;
        let mut set = builder.build()?;
        // A weight on the crank; its height follows from the slider's x by two triangles.
        let mut loads = vec![0.0; 15];
        loads[1] = -force;
        let target = Target { loads: &loads, prescribed: &[] };
        let (start, options) = (Start::at_rest(&set), EquilibriumOptions::default());
        let reach = (r + l - end[0]) / length;
        let height = |t: f64| {
            let s = end[0] + length * t;
            let along = (s * s + r * r - l * l) / (2.0 * s);
            (r * r - along * along).sqrt()
        };
        let found = drive(&mut Weights { springs: vec![0.0; 15] }, &mut set, &start, &target, 0.8 * reach, &options)?;
        assert!((2.0 * found.u[1] - (height(0.8 * reach) - pin[1])).abs() < 1e-8 * length);
        let pushed = -found.multipliers.of(motor)[0];
        let step = 1e-5;
        let slope = 0.5 * force * (height(0.8 * reach + step) - height(0.8 * reach - step)) / (2.0 * step * length);
        assert!((pushed - slope).abs() < 1e-6 * force, "{pushed:e} {slope:e}");
        for beyond in [1.0 + 1e-6, 1.1] {
            set.set_time(0.0)?;
            let found =
                drive(&mut Weights { springs: vec![0.0; 15] }, &mut set, &start, &target, beyond * reach, &options);
            assert!(found.is_err(), "{length} {force} {beyond}: {found:?}");
            assert_eq!(set.time(), 0.0);
        }
    }
    Ok(())
}

/// A right-hand side that is a function of time acts as a moving support: the beam is the same, and the multiplier is the reaction.
#[test]
fn driven_equations_are_supports_that_move() -> Outcome {
    for [length, force] in UNITS {
        let mut frame = Frame::straight(8, length, 1e4 * force, force * length * length);
        let end = 3 * 8 + 1;
        let clamp = [(0, 0.0), (1, 0.0), (2, 0.0)];
        let mut loads = vec![0.0; 3 * frame.at.len()];
        loads[end - 1] = 0.4 * force;
        let mut builder = ConstraintSet::builder(loads.len());
        let lift = builder.add("lift", Driven::new([(end, 1.0)], move |t| 0.7 * length * t.sin()))?;
        let mut set = builder.build()?;
        let target = Target { loads: &loads, prescribed: &clamp };
        let options = EquilibriumOptions::default();
        let start = Start::at_rest(&set);
        let driven = drive(&mut frame, &mut set, &start, &target, 1.0, &options)?;
        let none = ConstraintSet::builder(loads.len()).build()?;
        let held = [&clamp[..], &[(end, 0.7 * length * 1_f64.sin())]].concat();
        let target = Target { loads: &loads, prescribed: &held };
        let moved = solve(&mut frame, &none, &Start::at_rest(&none), &target, &options)?;
        let off = driven.u.iter().zip(&moved.u).enumerate();
        let size = |j: usize| if j % 3 == 2 { 1.0 } else { length };
        off.for_each(|(j, (a, b))| assert!((a - b).abs() < 1e-8 * size(j), "DOF {j}: {a:e} {b:e}"));
        let pushed = -driven.multipliers.of(lift)[0];
        assert!((pushed - moved.reactions[end]).abs() < 1e-7 * force, "{pushed:e} {:e}", moved.reactions[end]);
    }
    Ok(())
}

/// Too many turns, and times at which a motor has no angle: errors that say so; the set keeps its time.
#[test]
fn what_cannot_be_followed_is_refused() -> Outcome {
    let (ground, wheel) = (Body::ground(), Body::with_vector([0, 1, 2], [0.0; 3], [3, 4, 5]));
    let wheel_with = |angle: fn(f64) -> f64| -> Outcome<ConstraintSet> {
        let mut builder = ConstraintSet::builder(6);
        builder.add("bearing", Revolute { a: ground, b: wheel, at: [0.0; 3], axis: Z })?;
        builder.add("motor", RotationMotor::new(ground, wheel, Z, angle))?;
        Ok(builder.build()?)
    };
    let (target, options) = (Target { loads: &[0.0; 6], prescribed: &[] }, EquilibriumOptions::default());
    let go = |set: &mut ConstraintSet, time: f64| {
        let start = Start::at_rest(set);
        drive(&mut Weights { springs: vec![0.0; 6] }, set, &start, &target, time, &options)
    };
    let mut set = wheel_with(|t| t)?;
    let found = go(&mut set, 1000.0)?;
    let angle = 1000.0 - TAU * (1000.0 / TAU).round();
    // The angle is known modulo whole turns, in rotation vectors as in c.
    let off = found.u[5] - angle;
    assert!((off - TAU * (off / TAU).round()).abs() < 1e-9 && found.steps.len() > 2500, "{:?}", found.u);
    for turns in 1..4 {
        set.set_time(0.0)?;
        let found = go(&mut set, TAU * f64::from(turns))?;
        assert!(found.u[5].abs() < 1e-9, "{:?}", found.u);
    }
    set.set_time(0.0)?;
    let refused = go(&mut set, 1e5).expect_err("too far");
    assert!(matches!(&refused, EquilibriumError::Turn { label, .. } if label == "motor"), "{refused}");
    assert_eq!(set.time(), 0.0);
    // It has angles at both ends of the path, but not in between.
    let mut set = wheel_with(|t| if (0.1..0.9).contains(&t) { f64::NAN } else { 3.0 * t })?;
    let refused = go(&mut set, 1.0).expect_err("no angle on the way");
    assert!(matches!(&refused, EquilibriumError::Time(TimeError::NotFinite { .. })), "{refused}");
    assert!(set.time() == 0.0 && go(&mut set, f64::NAN).is_err());
    Ok(())
}

/// Linkages that nearly fold flat, where the distance of the branches is the square root of the remaining gap: on the right one. A crank that
/// does not turn fully is refused.
#[test]
fn linkages_that_nearly_fold_keep_their_branch() -> Outcome {
    let mut refused = 0;
    for margin in [0.1, 0.03, 0.01] {
        for seed in 0..24 {
            let mut bar = FourBar::random(seed, UNITS[seed % UNITS.len()]);
            let [crank, coupler, _, base] = bar.bars;
            bar.bars[2] = crank + (1.0 + margin) * base - coupler;
            // At its ends the pin has this distance from the other bearing.
            let goes_round = (coupler - bar.bars[2]).abs() <= base - crank;
            let ((mut set, motor), mut model, loads) = (bar.set()?, bar.model(), bar.loads());
            let target = Target { loads: &loads, prescribed: &[] };
            let time = 20.0 * random(seed + 5);
            let (start, options) = (Start::at_rest(&set), EquilibriumOptions::default());
            match drive(&mut model, &mut set, &start, &target, time, &options) {
                Ok(found) => _ = check(&bar, (&set, motor), &found),
                Err(error) if goes_round => return Err(format!("{margin} {seed}: {error}").into()),
                Err(_) => refused += 1,
            }
        }
    }
    assert!(refused < 10, "{refused}");
    Ok(())
}
