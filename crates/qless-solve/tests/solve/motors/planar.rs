//! Planar linkages.

use std::f64::consts::PI;

use qless_constraints::ConstraintSet;
use qless_constraints::types::{Body, Prismatic, Revolute, RotationMotor};

use super::{Driven, Ring, UNITS, Z, about, slope, twelfths};
use crate::linkages::Outcome;
use crate::poses::{AT_REST, KINDS, STRIDE, Vector, add, body, norm, scale, sub, turn};

/// `x = r cos phi + sqrt(l^2 - r^2 sin^2 phi)`, six turns through both dead centres, which are met exactly.
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

/// The end of the rocker is an intersection of two circles; the crank makes three turns.
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
