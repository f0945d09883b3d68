//! Corotational beams in the plane, as in a finite-element program, under constraints.

use std::error::Error;
use std::f64::consts::TAU;

use qless_constraints::types::{Distance, Equal, LinearEquation, OnSphere, PlanarPoint};
use qless_constraints::{ConstraintSet, SetBuilder};
use qless_solve::equilibrium::{
    Assembly, Equilibrium, EquilibriumError, EquilibriumIterate, EquilibriumOptions, Model, Start, Target, solve,
};

use crate::linkages::Outcome;

/// Units of length and force: changed separately and together.
pub const UNITS: [[f64; 2]; 7] =
    [[1.0, 1.0], [1e-6, 1.0], [1e6, 1.0], [1.0, 1e-6], [1.0, 1e6], [1e-6, 1e-6], [1e6, 1e6]];

/// Prints the residuals. Those that are small but above rounding must be at most `bound` times the square of the larger one before.
pub fn assert_quadratic(name: &str, found: &Equilibrium, bound: f64) {
    let mut fast = 0;
    for step in &found.steps {
        println!("{name}: load factor {} {}", step.factor, if step.converged { "" } else { "failed" });
        println!("{:>4} {:>12} {:>12} {:>8}", "step", "force", "constraint", "length");
        for (k, i) in step.iterates.iter().enumerate() {
            println!("{k:>4} {:>12.3e} {:>12.3e} {:>8}", i.force, i.constraint, i.length);
        }
        let larger = |i: &EquilibriumIterate| i.force.max(i.constraint);
        for pair in step.iterates.windows(2).filter(|_| step.converged) {
            let (before, after) = (larger(&pair[0]), larger(&pair[1]));
            if before < 1e-2 && before > 1e-9 {
                assert!(after <= bound * before * before + 1e-11, "{name}: {before:e} to {after:e}");
                fast += 1;
            }
        }
    }
    assert!(fast >= 1, "{name}: too few steps to judge");
}

/// Beams between pairs of nodes; three DOFs per node: x, y and the rotation.
pub struct Frame {
    pub at: Vec<[f64; 2]>,
    pub beams: Vec<[usize; 2]>,
    pub axial: f64,
    pub bending: f64,
}

impl Frame {
    /// A straight beam along x, from 0 to `length`.
    pub fn straight(elements: usize, length: f64, axial: f64, bending: f64) -> Self {
        let at = (0..=elements).map(|i| [length * i as f64 / elements as f64, 0.0]).collect();
        Self { at, beams: (0..elements).map(|i| [i, i + 1]).collect(), axial, bending }
    }

    /// Stretch, end rotations relative to the chord, and length and direction of the chord.
    fn strains(&self, [a, b]: [usize; 2], u: &[f64]) -> ([f64; 3], f64, f64, [f64; 2]) {
        let first = [0, 1].map(|k| self.at[b][k] - self.at[a][k]);
        let now = [0, 1].map(|k| first[k] + u[3 * b + k] - u[3 * a + k]);
        let (l0, l) = (first[0].hypot(first[1]), now[0].hypot(now[1]));
        let turned = (first[0] * now[1] - first[1] * now[0]).atan2(first[0] * now[0] + first[1] * now[1]);
        let relative = |turn: f64| {
            let x = turn - turned;
            x - TAU * (x / TAU).round()
        };
        // l - l0 without cancellation.
        let stretch = (0..2).map(|k| (now[k] - first[k]) * (now[k] + first[k])).sum::<f64>() / (l + l0);
        ([stretch, relative(u[3 * a + 2]), relative(u[3 * b + 2])], l0, l, now.map(|x| x / l))
    }

    /// `EA s^2 / 2 l + EI (4 a^2 + 4 a b + 4 b^2) / 2 l`, summed.
    pub fn energy(&self, u: &[f64]) -> f64 {
        let of_beam = |beam: &[usize; 2]| {
            let ([s, a, b], l0, ..) = self.strains(*beam, u);
            0.5 * self.axial * s * s / l0 + 2.0 * self.bending * (a * a + a * b + b * b) / l0
        };
        self.beams.iter().map(of_beam).sum()
    }
}

impl Model for Frame {
    fn dofs(&self) -> usize {
        3 * self.at.len()
    }

    fn pattern(&self, entry: &mut dyn FnMut(usize, usize)) {
        for beam in &self.beams {
            for (i, j) in (0..36).map(|k| (k / 6, k % 6)) {
                entry(3 * beam[i / 3] + i % 3, 3 * beam[j / 3] + j % 3);
            }
        }
    }

    fn coordinate(&self, dof: usize) -> f64 {
        if dof % 3 < 2 { self.at[dof / 3][dof % 3].abs() } else { 0.0 }
    }

    /// `f = B^T s`, `K = B^T D B + N z z^T / l + (M1 + M2) (r z^T + z r^T) / l^2` (Crisfield).
    fn assemble(&mut self, u: &[f64], out: &mut Assembly) -> Result<(), Box<dyn Error + Send + Sync>> {
        for &beam in &self.beams {
            let ([s, a, b], l0, l, [cos, sin]) = self.strains(beam, u);
            let dofs = [0, 1, 2, 3, 4, 5].map(|i| 3 * beam[i / 3] + i % 3);
            let r = [-cos, -sin, 0.0, cos, sin, 0.0];
            let z = [sin, -cos, 0.0, -sin, cos, 0.0];
            let turn = |node: usize| -> [f64; 6] {
                std::array::from_fn(|i| f64::from(u8::from(i == 3 * node + 2)) - z[i] / l)
            };
            let rows = [r, turn(0), turn(1)];
            let (ea, ei) = (self.axial / l0, 2.0 * self.bending / l0);
            let stress = [ea * s, ei * (2.0 * a + b), ei * (a + 2.0 * b)];
            let d = [[ea, 0.0, 0.0], [0.0, 2.0 * ei, ei], [0.0, ei, 2.0 * ei]];
            for i in 0..6 {
                (0..3).for_each(|m| out.force(dofs[i], rows[m][i] * stress[m]));
                for j in 0..6 {
                    let material: f64 = (0..9).map(|k| rows[k / 3][i] * d[k / 3][k % 3] * rows[k % 3][j]).sum();
                    let geometric =
                        stress[0] * z[i] * z[j] / l + (stress[1] + stress[2]) * (r[i] * z[j] + z[i] * r[j]) / (l * l);
                    out.stiffness(dofs[i], dofs[j], material + geometric);
                }
            }
        }
        Ok(())
    }
}

fn built(builder: SetBuilder) -> ConstraintSet {
    builder.build().expect("few DOFs")
}

/// The end moment `2 pi E I / L` rolls a cantilever into a circle. It consists of two beams, tied in the middle by three equations and a
/// redundant one.
#[test]
fn a_tied_cantilever_is_rolled_up() -> Outcome {
    let n = 10;
    for [length, force] in UNITS {
        let (axial, bending) = (1e4 * force, force * length * length);
        let mut frame = Frame::straight(2 * n, length, axial, bending);
        // The second half has its own first node.
        frame.at.push(frame.at[n]);
        frame.beams[n][0] = 2 * n + 1;
        let (left, right) = (3 * n, 3 * (2 * n + 1));
        let mut builder = ConstraintSet::builder(frame.dofs());
        for k in 0..3 {
            builder.add(format!("tie {k}"), Equal::new([left + k, right + k]))?;
        }
        let twice = LinearEquation { terms: vec![(left + 2, 2.0), (right + 2, -2.0)], rhs: 0.0 };
        builder.add("tie again", twice)?;
        let set = built(builder);
        let mut loads = vec![0.0; frame.dofs()];
        let moment = TAU * bending / length;
        loads[3 * 2 * n + 2] = moment;
        let clamp = [(0, 0.0), (1, 0.0), (2, 0.0)];
        let target = Target { loads: &loads, prescribed: &clamp };
        let found = solve(&mut frame, &set, &Start::at_rest(&set), &target, &EquilibriumOptions::default())?;
        assert_quadratic(&format!("roll-up, units {length} {force}"), &found, 1e3);
        // The end has returned to the clamp: the circle closes.
        let end = 3 * 2 * n;
        assert!((found.u[end] / length + 1.0).abs() < 1e-9 && (found.u[end + 1] / length).abs() < 1e-9);
        assert!((found.u[end + 2] / TAU - 1.0).abs() < 1e-9, "{}", found.u[end + 2]);
        assert!((frame.energy(&found.u) / (0.5 * moment * TAU) - 1.0).abs() < 1e-9);
        assert!((found.reactions[2] / moment + 1.0).abs() < 1e-8, "{:?}", found.reactions);
        assert!(found.reactions[..2].iter().all(|r| (r * length / moment).abs() < 1e-8), "{:?}", found.reactions);
        // The tie carries the moment by one of the two equations; the other one is redundant.
        assert_eq!(found.redundant.len(), 1);
        assert_eq!(found.multipliers.in_rows(&set)?[found.redundant[0]], 0.0);
        let carried = found.constraint_forces[left + 2];
        assert!((carried.abs() / moment - 1.0).abs() < 1e-8, "{carried}");
    }
    Ok(())
}

/// An unsupported model is refused, and the DOFs of its motion are named; so are loads that it cannot carry.
#[test]
fn what_nothing_holds_is_refused() -> Outcome {
    for [length, force] in UNITS {
        let mut frame = Frame::straight(2, length, 1e4 * force, force * length * length);
        let mut builder = ConstraintSet::builder(9);
        builder.add("pin", Equal::new([0, 3]))?;
        let set = built(builder);
        for pulled in [0.0, 0.1 * force] {
            let mut loads = vec![0.0; 9];
            loads[7] = pulled;
            let target = Target { loads: &loads, prescribed: &[(0, 0.0), (2, 0.0)] };
            let refused = solve(&mut frame, &set, &Start::at_rest(&set), &target, &EquilibriumOptions::default());
            match refused {
                Err(EquilibriumError::Unsupported { dofs, .. }) => {
                    assert!([1, 4, 7].iter().all(|dof| dofs.contains(dof)), "{dofs:?}");
                }
                other => panic!("{length} {force} {pulled}: {other:?}"),
            }
        }
    }
    Ok(())
}

/// Rods in the plane, with weights and springs at joints: all forces are constant, all stiffness is from springs to the ground.
pub struct Weights {
    pub springs: Vec<f64>,
}

impl Model for Weights {
    fn dofs(&self) -> usize {
        self.springs.len()
    }

    fn pattern(&self, entry: &mut dyn FnMut(usize, usize)) {
        (0..self.springs.len()).filter(|&j| self.springs[j] != 0.0).for_each(|j| entry(j, j));
    }

    fn assemble(&mut self, u: &[f64], out: &mut Assembly) -> Result<(), Box<dyn Error + Send + Sync>> {
        for (j, &k) in self.springs.iter().enumerate().filter(|(_, k)| **k != 0.0) {
            out.force(j, k * u[j]);
            out.stiffness(j, j, k);
        }
        Ok(())
    }
}

/// A chain of equal rods between two supports with the same weight on each joint: the horizontal tension is the same in all rods, and the
/// vertical force grows by one weight per rod.
fn hanging_chain(rods: usize, [length, force]: [f64; 2]) -> Outcome<Equilibrium> {
    let n = rods as f64;
    let rod = length / n;
    let span = 0.8 * length;
    // A parabola of about the right length.
    let at = |i: usize| {
        let s = i as f64 / n;
        [span * s, -4.0 * 0.27 * length * s * (1.0 - s)]
    };
    let node = |i: usize| PlanarPoint::new([2 * i, 2 * i + 1], at(i));
    let mut builder = ConstraintSet::builder(2 * (rods + 1));
    for i in 0..rods {
        let distance = Distance { a: node(i), b: node(i + 1), length: Some(rod) };
        builder.add(format!("rod {i}"), distance)?;
    }
    let set = built(builder);
    let weight = force / n;
    let loads: Vec<f64> = (0..set.dofs()).map(|j| if j % 2 == 1 { -weight } else { 0.0 }).collect();
    let last = 2 * rods;
    let ends = [(0, 0.0), (1, 0.0), (last, 0.0), (last + 1, 0.0)];
    let target = Target { loads: &loads, prescribed: &ends };
    let mut model = Weights { springs: vec![0.0; set.dofs()] };
    let found = solve(&mut model, &set, &Start::at_rest(&set), &target, &EquilibriumOptions::default())?;
    let lambda = found.multipliers.in_rows(&set)?;
    let tension = |i: usize| {
        let place = |i: usize| [0, 1].map(|k| at(i)[k] + found.u[2 * i + k]);
        let (a, b) = (place(i), place(i + 1));
        let along = [0, 1].map(|k| (b[k] - a[k]) / rod);
        assert!((along[0].hypot(along[1]) - 1.0).abs() < 1e-9, "rod {i}");
        along.map(|x| x * lambda[i])
    };
    let first = tension(0);
    for i in 1..rods {
        let here = tension(i);
        assert!((here[0] / first[0] - 1.0).abs() < 1e-7, "rod {i}: {here:?}, {first:?}");
        let vertical = first[1] + weight * i as f64;
        assert!((here[1] - vertical).abs() < 1e-7 * force, "rod {i}: {here:?}, {vertical}");
    }
    // The supports carry half of the weights between them each, and the weights on themselves.
    assert!((found.reactions[1] / (0.5 * weight * (n + 1.0)) - 1.0).abs() < 1e-7, "{:?}", found.reactions);
    Ok(found)
}

#[test]
fn chains_hang() -> Outcome {
    for units in UNITS {
        assert_quadratic(&format!("chain, units {units:?}"), &hanging_chain(20, units)?, 1e6);
    }
    Ok(())
}

#[test]
fn chains_of_thousands_of_rods_hang() -> Outcome {
    for rods in [1_000, 10_000] {
        let found = hanging_chain(rods, [1.0, 1.0])?;
        let last = &found.steps[found.steps.len() - 1];
        println!("{rods} rods: {} load steps, {} iterates", found.steps.len(), last.iterates.len());
        last.iterates.iter().for_each(|i| println!("{:>12.3e} {:>12.3e} {}", i.force, i.constraint, i.length));
    }
    Ok(())
}

/// A crank turned by its support pushes a slider against a spring, through both dead centres; the torque follows from virtual work.
#[test]
fn a_crank_turns_through_its_dead_centres() -> Outcome {
    for [length, force] in UNITS {
        let (r, l, k) = (0.5 * length, 2.0 * length, 3.0 * force / length);
        let (pin, slider) = (PlanarPoint::new([0, 1], [r, 0.0]), PlanarPoint::new([2, 3], [r + l, 0.0]));
        let mut builder = ConstraintSet::builder(4);
        builder.add("crank", OnSphere { point: pin, centre: [0.0; 2], radius: None })?;
        let rod = builder.add("rod", Distance::new(pin, slider))?;
        builder.add("guide", LinearEquation { terms: vec![(3, 1.0)], rhs: 0.0 })?;
        let set = built(builder);
        let mut model = Weights { springs: vec![0.0, 0.0, k, 0.0] };
        let mut start = Start::at_rest(&set);
        // The pin is driven along x between the dead centres: on the upper half, there and back.
        for step in (1..=10).chain((0..10).rev()).chain(1..=3) {
            let x = -2.0 * r * f64::from(step) / 10.0;
            let target = Target { loads: &[0.0; 4], prescribed: &[(0, x)] };
            let found = solve(&mut model, &set, &start, &target, &EquilibriumOptions::default());
            let found = found.map_err(|e| format!("units {length} {force}, step {step}: {e}"))?;
            let (px, py) = (r + found.u[0], found.u[1]);
            let truth = px + (l * l - py * py).sqrt() - r - l;
            assert!((found.u[2] - truth).abs() < 1e-9 * length, "step {step}: {} {truth}", found.u[2]);
            // The spring determines the force along the rod.
            let along = (r + l + found.u[2] - px) / l;
            assert!(
                (found.multipliers.of(rod)[0] * along + k * found.u[2]).abs() < 1e-8 * force,
                "step {step}: {found:?}"
            );
            start = found.start();
        }
    }
    Ok(())
}
