use std::error::Error;

use qless_constraints::ConstraintSet;
use qless_constraints::types::{Distance, Equal, LinearEquation, PlanarPoint};
use qless_solve::equilibrium::{Assembly, EquilibriumError, EquilibriumOptions, Model, Start, Target, solve};
use qless_solve::newton::{NewtonOptions, solve as assemble};

use crate::equilibria::{UNITS, Weights, assert_quadratic};
use crate::linkages::{Outcome, four_bar, random};
use crate::stability::Springs;

/// A frame of n scissors: bars of length L from bottom i to top i + 1 and from top i to bottom i + 1, pinned in their middles. Redundant
/// equations keep the bottoms in line.
fn scissors(n: usize, bar: f64, height: f64) -> Outcome<ConstraintSet> {
    let width = (bar * bar - height * height).sqrt();
    let bottom = |i: usize| PlanarPoint::new([4 * i, 4 * i + 1], [width * i as f64, 0.0]);
    let top = |i: usize| PlanarPoint::new([4 * i + 2, 4 * i + 3], [width * i as f64, height]);
    let mut builder = ConstraintSet::builder(4 * (n + 1));
    for i in 0..n {
        builder.add(format!("rising bar {i}"), Distance::new(bottom(i), top(i + 1)))?;
        builder.add(format!("falling bar {i}"), Distance::new(top(i), bottom(i + 1)))?;
        for k in 0..2 {
            let terms = vec![(4 * i + k, 1.0), (4 * i + 6 + k, 1.0), (4 * i + 2 + k, -1.0), (4 * i + 4 + k, -1.0)];
            builder.add(format!("pin {i}, {k}"), LinearEquation { terms, rhs: 0.0 })?;
        }
    }
    builder.add("bottoms in line", Equal::new([1, 4 * n + 1]))?;
    Ok(builder.build()?)
}

/// One motion, the height h. `k (h - h_0) = -F n dw/dh` with `w = sqrt(L^2 - h^2)`: pulled at its end against a spring at its first post.
#[test]
fn a_scissor_frame_is_pulled() -> Outcome {
    let n = 12;
    for [length, force] in UNITS {
        let (bar, height, k) = (length, 0.7 * length, 40.0 * force / length);
        let set = scissors(n, bar, height)?;
        let mut model = Weights { springs: vec![0.0; set.dofs()] };
        model.springs[3] = k;
        let mut loads = vec![0.0; set.dofs()];
        loads[4 * n] = force;
        let target = Target { loads: &loads, prescribed: &[(0, 0.0), (1, 0.0), (2, 0.0)] };
        let found = solve(&mut model, &set, &Start::at_rest(&set), &target, &EquilibriumOptions::default())?;
        assert_quadratic(&format!("scissors, units {length} {force}"), &found, 1e4);
        let h = height + found.u[3];
        let width = (bar * bar - h * h).sqrt();
        let first = (bar * bar - height * height).sqrt();
        assert!((found.u[4 * n] - n as f64 * (width - first)).abs() < 1e-9 * length);
        let pull = force * n as f64 * h / width;
        assert!((k * found.u[3] + pull).abs() < 1e-8 * force, "{} {pull}", k * found.u[3]);
        assert!((found.reactions[0] + found.reactions[2] + force).abs() < 1e-8 * force, "{:?}", found.reactions);
        assert_eq!(found.redundant.len(), 1);
    }
    Ok(())
}

/// The spatial four-bar linkage with 3 redundant equations: the energy is stationary along its motion, computed by Newton's method on both
/// sides.
#[test]
fn a_four_bar_linkage_finds_its_equilibrium() -> Outcome {
    let set = four_bar()?.build()?;
    let springs: Vec<f64> = (0..set.dofs()).map(|j| if j % 7 < 3 { 1.0 + 0.1 * j as f64 } else { 0.0 }).collect();
    let loads: Vec<f64> =
        (0..set.dofs()).map(|j| if j % 7 == 1 { -0.6 } else { 0.2 * f64::from(u8::from(j % 7 == 0)) }).collect();
    let mut model = Weights { springs: springs.clone() };
    let target = Target { loads: &loads, prescribed: &[] };
    let found = solve(&mut model, &set, &Start::at_rest(&set), &target, &EquilibriumOptions::default())?;
    assert_quadratic("four-bar", &found, 1e4);
    assert_eq!(found.redundant.len(), 3);
    let lambda = found.multipliers.in_rows(&set)?;
    assert!(found.redundant.iter().all(|&r| lambda[r] == 0.0));
    let energy = |u: &[f64]| -> f64 { (0..u.len()).map(|j| 0.5 * springs[j] * u[j] * u[j] - loads[j] * u[j]).sum() };
    let step = 1e-4;
    let at = |sign: f64| -> Outcome<f64> {
        let moved = assemble(&set, &found.u, &[(0, found.u[0] + sign * step)], &NewtonOptions::default())?;
        Ok(energy(&moved.u))
    };
    let (slope, curvature) =
        ((at(1.0)? - at(-1.0)?) / (2.0 * step), (at(1.0)? + at(-1.0)? - 2.0 * energy(&found.u)) / (step * step));
    assert!(slope.abs() < 1e-6 * curvature.abs(), "{slope:e} {curvature}");
    Ok(())
}

/// Arguments that do not match are refused with their numbers.
#[test]
fn misuse_is_refused() -> Outcome {
    struct Wrong(usize);
    impl Model for Wrong {
        fn dofs(&self) -> usize {
            2
        }
        fn pattern(&self, entry: &mut dyn FnMut(usize, usize)) {
            entry(0, 0);
            if self.0 == 4 {
                entry(0, 7);
            }
        }
        fn assemble(
            &mut self,
            _: &[f64],
            out: &mut qless_solve::equilibrium::Assembly,
        ) -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
            match self.0 {
                0 => out.force(2, 1.0),
                1 => out.stiffness(1, 0, 1.0),
                2 => out.force(0, f64::NAN),
                3 => return Err("turned inside out".into()),
                _ => (),
            }
            Ok(())
        }
    }
    let mut builder = ConstraintSet::builder(2);
    builder.add("equal", Equal::new([0, 1]))?;
    let set = builder.build()?;
    let (start, options) = (Start::at_rest(&set), EquilibriumOptions::default());
    let target = Target { loads: &[1.0, 0.0], prescribed: &[] };
    let expected =
        ["a force to DOF 2", "stiffness at (1, 0)", "the force of DOF", "turned inside out", "stiffness at (0, 7)"];
    for (kind, text) in expected.into_iter().enumerate() {
        let error = solve(&mut Wrong(kind), &set, &start, &target, &options).expect_err(text).to_string();
        assert!(error.contains(text), "{error}");
    }
    let bad = |target: &Target, start: &Start, options: &EquilibriumOptions| {
        solve(&mut Wrong(9), &set, start, target, options).expect_err("misuse")
    };
    assert!(matches!(bad(&Target { loads: &[1.0], ..target }, &start, &options), EquilibriumError::Size { .. }));
    for prescribed in [[(5, 0.0)], [(0, f64::NAN)]] {
        let refused = bad(&Target { prescribed: &prescribed, ..target }, &start, &options);
        assert!(matches!(refused, EquilibriumError::System { .. }), "{refused}");
    }
    let mut others = ConstraintSet::builder(2);
    others.add("equal", Equal::new([0, 1]))?;
    let foreign = Start { multipliers: others.build()?.by_constraint(&[1.0])?, ..start.clone() };
    assert!(matches!(bad(&target, &foreign, &options), EquilibriumError::Argument(_)));
    let fraction = |tolerance, first, shortest| EquilibriumOptions { tolerance, first, shortest, ..options.clone() };
    let off = [0.0, -0.5, 1.5, f64::NAN];
    let fractions = off.into_iter().flat_map(|x| [fraction(x, 0.5, 0.1), fraction(0.1, x, 0.1), fraction(0.1, 0.5, x)]);
    let roundings = [0.5, f64::NAN, f64::INFINITY].map(|roundings| EquilibriumOptions { roundings, ..options.clone() });
    for wrong in fractions.chain(roundings) {
        assert!(matches!(bad(&target, &start, &wrong), EquilibriumError::Option { .. }), "{wrong:?}");
    }
    Ok(())
}

/// No DOFs, no constraints, all DOFs prescribed.
#[test]
fn the_smallest_problems() -> Outcome {
    let options = EquilibriumOptions::default();
    let none = ConstraintSet::builder(0).build()?;
    let target = Target { loads: &[], prescribed: &[] };
    let refused = solve(&mut Weights { springs: vec![] }, &none, &Start::at_rest(&none), &target, &options);
    assert!(matches!(refused, Err(EquilibriumError::System { .. })), "{refused:?}");
    let free = ConstraintSet::builder(2).build()?;
    let target = Target { loads: &[3.0, 0.0], prescribed: &[] };
    let mut springs = Weights { springs: vec![2.0, 5.0] };
    let found = solve(&mut springs, &free, &Start::at_rest(&free), &target, &options)?;
    assert!((found.u[0] - 1.5).abs() < 1e-15 && found.u[1] == 0.0);
    // All DOFs are prescribed, consistently with the constraint and in conflict with it.
    let mut builder = ConstraintSet::builder(2);
    builder.add("equal", Equal::new([0, 1]))?;
    let set = builder.build()?;
    let held = Target { loads: &[3.0, 0.0], prescribed: &[(0, 0.25), (1, 0.25)] };
    let found = solve(&mut springs, &set, &Start::at_rest(&set), &held, &options)?;
    assert_eq!((found.u, found.reactions, found.redundant), (vec![0.25; 2], vec![-2.5, 1.25], vec![0]));
    // A force that is not finite, at a DOF that no other is connected to.
    let held = Target { loads: &[0.0; 2], prescribed: &[(0, 0.0), (1, 1.0)] };
    let mut none = Weights { springs: vec![2.0, f64::NAN] };
    let error = solve(&mut none, &free, &Start::at_rest(&free), &held, &options).expect_err("not a number");
    assert!(matches!(error, EquilibriumError::NotFinite { at: 1, .. }), "{error}");
    let against = Target { loads: &[3.0, 0.0], prescribed: &[(0, 0.25), (1, 0.5)] };
    let error = solve(&mut springs, &set, &Start::at_rest(&set), &against, &options).expect_err("0.25 is not 0.5");
    assert!(error.to_string().contains("equal"), "{error}");
    Ok(())
}

/// Two springs tied to each other without ground, and a rod that is out of reach: the errors name them.
#[test]
fn what_cannot_be_is_named() -> Outcome {
    let options = EquilibriumOptions::default();
    for force in [1e-6, 1.0, 1e6] {
        // 0.1 + 0.2 - 0.3 is not zero.
        let mut tied = Springs(vec![(0, Some(1), 0.1 * force), (1, Some(2), 0.2 * force)], 3);
        let mut builder = ConstraintSet::builder(3);
        builder.add("tie", Equal::new([0, 2]))?;
        let set = builder.build()?;
        for loads in [[force, 0.0, 0.0], [0.0; 3], [force, -force, 0.0]] {
            let target = Target { loads: &loads, prescribed: &[] };
            let error = solve(&mut tied, &set, &Start::at_rest(&set), &target, &options);
            match error {
                Err(EquilibriumError::Unsupported { mut dofs, .. }) => {
                    dofs.sort_unstable();
                    assert_eq!(dofs, [0, 1, 2], "{force} {loads:?}");
                }
                other => panic!("{force} {loads:?}: {other:?}"),
            }
        }
        let (a, b) = (PlanarPoint::new([0, 1], [0.0; 2]), PlanarPoint::new([2, 3], [1.0, 0.0]));
        let mut builder = ConstraintSet::builder(4);
        builder.add("short rod", Distance { a, b, length: Some(0.5) })?;
        let set = builder.build()?;
        let target = Target { loads: &[0.0; 4], prescribed: &[(0, 0.0), (1, 0.0), (2, 0.0), (3, 0.0)] };
        let mut model = Weights { springs: vec![force; 4] };
        let error = solve(&mut model, &set, &Start::at_rest(&set), &target, &options).expect_err("too short");
        assert!(error.to_string().contains("short rod"), "{error}");
    }
    Ok(())
}

/// The same bits with any number of threads.
#[test]
fn threads_change_no_bit() -> Outcome {
    let set = scissors(60, 1.0, 0.7)?;
    let run = || {
        let mut model = Weights { springs: vec![0.0; set.dofs()] };
        model.springs[3] = 400.0;
        let mut loads = vec![0.0; set.dofs()];
        loads[240] = 1.0;
        let target = Target { loads: &loads, prescribed: &[(0, 0.0), (1, 0.0), (2, 0.0)] };
        solve(&mut model, &set, &Start::at_rest(&set), &target, &EquilibriumOptions::default())
            .map_err(|e| e.to_string())
    };
    let with =
        |threads: usize| rayon::ThreadPoolBuilder::new().num_threads(threads).build().map(|pool| pool.install(run));
    let one = with(1)??;
    for threads in [2, 3, 8] {
        assert!(with(threads)?? == one, "{threads} threads");
    }
    Ok(())
}

/// `F = z + a z^2` with complex `a` and `z = u_0 + i u_1`: the tangent is one complex number.
struct Parabola([f64; 2]);

impl Model for Parabola {
    fn dofs(&self) -> usize {
        2
    }

    fn pattern(&self, entry: &mut dyn FnMut(usize, usize)) {
        (0..4).for_each(|k| entry(k / 2, k % 2));
    }

    fn assemble(&mut self, u: &[f64], out: &mut Assembly) -> Result<(), Box<dyn Error + Send + Sync>> {
        let ([a, b], [x, y]) = (self.0, [u[0], u[1]]);
        let [real, imaginary] = [1.0 + 2.0 * (a * x - b * y), 2.0 * (a * y + b * x)];
        out.force(0, x + a * (x * x - y * y) - b * 2.0 * x * y);
        out.force(1, y + b * (x * x - y * y) + a * 2.0 * x * y);
        let slopes = [(0, 0, real), (0, 1, -imaginary), (1, 0, imaginary), (1, 1, real)];
        slopes.into_iter().for_each(|(i, j, k)| out.stiffness(i, j, k));
        Ok(())
    }
}

/// The load 1 on a parabola, from rest: after steps of 1 and 1/10 fail, the length is that with the least next correction by
/// the second order, `1 / |2 a|`, since a parabola has no third order.
#[test]
fn second_trial_lengths_are_those_of_the_parabola() -> Outcome {
    for seed in 0..40 {
        let (size, turn) = (27.0 + 20.0 * random(seed), 0.6 * random(seed + 100));
        let mut model = Parabola([-size * turn.cos(), size * turn.sin()]);
        let set = ConstraintSet::builder(2).build()?;
        let target = Target { loads: &[1.0, 0.0], prescribed: &[] };
        let options = EquilibriumOptions { iterations: 100, ..EquilibriumOptions::default() };
        let found = solve(&mut model, &set, &Start::at_rest(&set), &target, &options)?;
        let length = found.steps[0].iterates[1].length;
        assert!((2.0 * size * length - 1.0).abs() < 1e-9, "a of size {size}: {length}");
    }
    Ok(())
}
