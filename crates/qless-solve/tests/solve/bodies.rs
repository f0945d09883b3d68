//! Chains of thousands of bodies with six DOFs each: the catenary of rigid links.

use std::time::Instant;

use qless_constraints::ConstraintSet;
use qless_constraints::types::{Body, Revolute, Universal};
use qless_solve::equilibrium::{EquilibriumOptions, Stability, Start, Target, solve};

use crate::equilibria::Weights;
use crate::linkages::Outcome;

/// The x at which a growing function is `y`.
fn inverse(f: impl Fn(f64) -> f64, y: f64, [mut low, mut high]: [f64; 2]) -> f64 {
    for _ in 0..200 {
        let middle = f64::midpoint(low, high);
        (low, high) = if f(middle) < y { (middle, high) } else { (low, middle) };
    }
    low
}

#[derive(Clone, Copy, Debug)]
enum Joint {
    /// All axes are parallel, so that three equations of each joint are redundant.
    Revolute,
    Universal,
}

/// Equal links between two bearings at the same height.
struct Chain {
    links: usize,
    length: f64,
    force: f64,
    joint: Joint,
}

impl Chain {
    fn link(&self) -> f64 {
        self.length / self.links as f64
    }

    fn span(&self) -> f64 {
        0.8 * self.length
    }

    /// In the reference configuration the joints are on a circle: `span = l sin(n g) / sin g`.
    fn joint(&self, i: usize) -> [f64; 3] {
        let n = self.links as f64;
        let wide = |g: f64| -(n * g).sin() / g.sin();
        let g = inverse(wide, -self.span() / self.link(), [1e-3 / n, 1.5 / n]);
        let (radius, angle) = (0.5 * self.link() / g.sin(), g * (2.0 * i as f64 - n));
        [radius * angle.sin(), -radius * (angle.cos() - (n * g).cos()), 0.0]
    }

    /// Horizontal tension. Links point along the mean of the forces at their ends, `x = sum l H / sqrt(H^2 + V_i^2)`.
    fn tension(&self) -> f64 {
        let wide = |h: f64| (0..self.links).map(|i| self.along(i, h)[0]).sum::<f64>();
        inverse(wide, self.span(), [0.0, 100.0 * self.force])
    }

    /// The vector from one end of a link to the other.
    fn along(&self, i: usize, tension: f64) -> [f64; 2] {
        let weight = self.force / self.links as f64;
        let v = weight * (i as f64 + 0.5 - 0.5 * self.links as f64);
        let scale = self.link() / tension.hypot(v);
        [scale * tension, scale * v]
    }

    fn check(&self) -> Outcome {
        let (n, at): (_, Vec<[f64; 3]>) = (self.links, (0..=self.links).map(|i| self.joint(i)).collect());
        let middle = |i: usize| [0, 1, 2].map(|k| f64::midpoint(at[i][k], at[i + 1][k]));
        let body = |i: usize| {
            let d = 6 * i;
            Body::with_vector([d, d + 1, d + 2], middle(i), [d + 3, d + 4, d + 5])
        };
        let mut builder = ConstraintSet::builder(6 * n);
        let mut joints = Vec::new();
        for i in 0..=n {
            let a = if i == 0 { Body::ground() } else { body(i - 1) };
            let b = if i == n { Body::ground() } else { body(i) };
            let (label, z) = (format!("joint {i}"), [0.0, 0.0, 1.0]);
            let link = i.min(n - 1);
            let across = [at[link][1] - at[link + 1][1], at[link + 1][0] - at[link][0], 0.0];
            joints.push(match self.joint {
                Joint::Revolute => builder.add(label, Revolute { a, b, at: at[i], axis: z })?,
                Joint::Universal => builder.add(label, Universal { a, b, at: at[i], axis_a: z, axis_b: across })?,
            });
        }
        let set = builder.build()?;
        let weight = self.force / n as f64;
        let loads: Vec<f64> = (0..6 * n).map(|j| if j % 6 == 1 { -weight } else { 0.0 }).collect();
        let target = Target { loads: &loads, prescribed: &[] };
        let (mut model, begun) = (Weights { springs: vec![0.0; 6 * n] }, Instant::now());
        let options = EquilibriumOptions { stability: true, ..EquilibriumOptions::default() };
        let found = solve(&mut model, &set, &Start::at_rest(&set), &target, &options)?;
        let took = begun.elapsed().as_secs_f64();
        println!("{n} links, {:?}: {took:.2} s, {:?}", self.joint, found.stability);
        for step in &found.steps {
            println!("load factor {}", step.factor);
            step.iterates.iter().for_each(|i| println!("{:>12.3e} {:>12.3e} {}", i.force, i.constraint, i.length));
        }
        // Positions of all links, and forces at all joints.
        let tension = self.tension();
        let mut end = [at[0][0], at[0][1]];
        for i in 0..n {
            let along = self.along(i, tension);
            for k in 0..2 {
                let place = middle(i)[k] + found.u[6 * i + k];
                let truth = end[k] + 0.5 * along[k];
                assert!((place - truth).abs() < 1e-7 * self.length, "link {i}, axis {k}: {place:e} {truth:e}");
                end[k] += along[k];
            }
            assert!(found.u[6 * i + 2].abs() < 1e-9 * self.length, "link {i}");
        }
        for (i, &joint) in joints.iter().enumerate() {
            let force = [0, 1].map(|k| found.multipliers.of(joint)[k].abs());
            let truth = [tension, (weight * (i as f64 - 0.5 * n as f64)).abs()];
            let off = (0..2).map(|k| (force[k] - truth[k]).abs()).fold(0.0, f64::max);
            assert!(off < 1e-6 * self.force, "joint {i}: {force:?} {truth:?}");
        }
        let redundant = if matches!(self.joint, Joint::Revolute) { 3 } else { 0 };
        assert_eq!(found.redundant.len(), redundant);
        assert!(matches!(found.stability, Some(Stability::Stable | Stability::Undecided)), "{:?}", found.stability);
        if n <= 1000 {
            assert_eq!(found.stability, Some(Stability::Stable));
        }
        Ok(())
    }
}

#[test]
fn chains_of_bodies_hang() -> Outcome {
    for [length, force] in crate::equilibria::UNITS {
        for joint in [Joint::Revolute, Joint::Universal] {
            Chain { links: 20, length, force, joint }.check()?;
        }
    }
    Ok(())
}

#[test]
fn a_thousand_bodies_hang() -> Outcome {
    for joint in [Joint::Revolute, Joint::Universal] {
        Chain { links: 1_000, length: 1.0, force: 1.0, joint }.check()?;
    }
    Ok(())
}

#[test]
fn ten_thousand_bodies_hang() -> Outcome {
    Chain { links: 10_000, length: 1.0, force: 1.0, joint: Joint::Universal }.check()
}
