//! Supports that are equations, whose terms all vanish with u; and motions that only rounding resists.

use std::error::Error;

use qless_constraints::ConstraintSet;
use qless_constraints::types::{Equal, Prescribed};
use qless_solve::equilibrium::{Assembly, EquilibriumError, EquilibriumOptions, Model, Start, Target, solve};

use crate::linkages::{Outcome, random};

type Refusal = Box<dyn Error + Send + Sync>;

/// Springs between pairs of DOFs.
struct Springs {
    dofs: usize,
    list: Vec<(usize, usize, f64)>,
}

impl Springs {
    /// Whole-number stiffness between all DOFs, in a unit.
    fn random(dofs: usize, seed: usize, unit: f64) -> Self {
        let pairs = (0..dofs).flat_map(|i| (0..i).map(move |j| (i, j)));
        let stiffness = |k: usize| unit * (1.0 + (4.5 * (1.0 + random(1000 * seed + k))).floor());
        Self { dofs, list: pairs.enumerate().map(|(k, (i, j))| (i, j, stiffness(k))).collect() }
    }
}

impl Model for Springs {
    fn dofs(&self) -> usize {
        self.dofs
    }

    fn pattern(&self, entry: &mut dyn FnMut(usize, usize)) {
        self.list
            .iter()
            .for_each(|&(i, j, _)| [(i, i), (i, j), (j, i), (j, j)].into_iter().for_each(|(a, b)| entry(a, b)));
    }

    fn assemble(&mut self, u: &[f64], out: &mut Assembly) -> Result<(), Refusal> {
        for &(i, j, k) in &self.list {
            for (a, b) in [(i, j), (j, i)] {
                out.force(a, k * u[a]);
                out.force(a, -k * u[b]);
                out.stiffness(a, a, k);
                out.stiffness(a, b, -k);
            }
        }
        Ok(())
    }
}

/// A support gives the same result and reaction if it is prescribed, an equation, or a tie to a fixed DOF.
#[test]
fn supports_are_the_same_as_equations() -> Outcome {
    for seed in 0..3000 {
        let (dofs, unit, length) = (2 + seed % 8, [1e-6, 1.0, 1e6][seed / 8 % 3], [1.0, 1e-6, 1e6][seed / 24 % 3]);
        let mut model = Springs::random(dofs, seed, unit);
        let loads: Vec<f64> =
            (0..dofs).map(|j| unit * length * (10.0 * random(77 * seed + j)).round() / 10.0).collect();
        let at = seed / 72 % dofs;
        let none = ConstraintSet::builder(dofs).build()?;
        let (held, tied) = ((at + 1) % dofs, seed % 5 == 0 && dofs > 2);
        let prescribed = [(at, 0.0), (held, 0.0)];
        let target = Target { loads: &loads, prescribed: &prescribed[..if tied { 2 } else { 1 }] };
        let options = EquilibriumOptions::default();
        let truth = solve(&mut model, &none, &Start::at_rest(&none), &target, &options)?;
        let mut builder = ConstraintSet::builder(dofs);
        if tied {
            builder.add("tie", Equal::new([at, held]))?;
        } else {
            builder.add("support", Prescribed::fixed([at]))?;
        }
        let set = builder.build()?;
        let target = Target { loads: &loads, prescribed: if tied { &prescribed[1..] } else { &[] } };
        let found = solve(&mut model, &set, &Start::at_rest(&set), &target, &options)
            .map_err(|error| format!("{seed}: {dofs} DOFs, tied {tied}: {error}"))?;
        let most = truth.u.iter().fold(0.0, |most: f64, u| most.max(u.abs()));
        let off = found.u.iter().zip(&truth.u).fold(0.0, |off: f64, (a, b)| off.max((a - b).abs()));
        assert!(off <= 1e-12 * most, "{seed}: {off:e} of {most:e}");
        let force = loads.iter().fold(0.0, |most: f64, f| most.max(f.abs()));
        let off = (found.constraint_forces[at] - truth.reactions[at]).abs();
        assert!(off <= 1e-12 * force, "{seed}: {:?}, {:?}", found.constraint_forces, truth.reactions);
    }
    Ok(())
}

/// A point on grounded springs, and another that hangs from it by a bar.
struct Dangling {
    springs: [[f64; 4]; 3],
    bar: f64,
    ends: [[f64; 3]; 2],
}

impl Model for Dangling {
    fn dofs(&self) -> usize {
        6
    }

    fn pattern(&self, entry: &mut dyn FnMut(usize, usize)) {
        (0..36).for_each(|k| entry(k / 6, k % 6));
    }

    fn coordinate(&self, dof: usize) -> f64 {
        self.ends[dof / 3].iter().fold(0.0, |most: f64, x| most.max(x.abs()))
    }

    fn assemble(&mut self, u: &[f64], out: &mut Assembly) -> Result<(), Refusal> {
        for [x, y, z, k] in self.springs {
            let direction = [x, y, z];
            let along: f64 = (0..3).map(|i| direction[i] * u[i]).sum();
            for i in 0..3 {
                out.force(i, k * along * direction[i]);
                (0..3).for_each(|j| out.stiffness(i, j, k * direction[i] * direction[j]));
            }
        }
        // Green's strain.
        let before: [f64; 3] = std::array::from_fn(|i| self.ends[1][i] - self.ends[0][i]);
        let now: [f64; 3] = std::array::from_fn(|i| before[i] + u[3 + i] - u[i]);
        let square = |x: &[f64; 3]| x.iter().map(|x| x * x).sum::<f64>();
        let length = square(&before).sqrt();
        let force = self.bar * 0.5 * (square(&now) - square(&before)) / length.powi(3);
        for (a, sign) in [(0, -1.0), (1, 1.0)] {
            for i in 0..3 {
                out.force(3 * a + i, sign * force * now[i]);
                for (b, other) in [(0, -1.0), (1, 1.0)] {
                    for j in 0..3 {
                        let same = if i == j { force } else { 0.0 };
                        let slope = self.bar / length.powi(3) * now[i] * now[j];
                        out.stiffness(3 * a + i, 3 * b + j, sign * other * (slope + same));
                    }
                }
            }
        }
        Ok(())
    }
}

/// Across a bar without force the only stiffness is rounding of its strain: the model is refused, and never called stable.
#[test]
fn what_hangs_without_a_load_is_not_supported() -> Outcome {
    for seed in 0..600 {
        let (length, force) = ([1e-6, 1.0, 1e6][seed % 3], [1.0, 1e6, 1e-6][seed / 3 % 3]);
        let number = |k: usize| random(131 * seed + k);
        let spring = |s: usize| {
            let direction: [f64; 3] = std::array::from_fn(|i| number(5 * s + i) + f64::from(u8::from(i == s)));
            let [x, y, z] = direction;
            [x, y, z, force / length * (1.0 + number(5 * s + 3).abs())]
        };
        let ends = [0, 1].map(|e| std::array::from_fn(|i| length * 2.0 * number(40 + 3 * e + i)));
        let mut model = Dangling { springs: [0, 1, 2].map(spring), bar: force * (10.0 + 5.0 * number(50)), ends };
        let mut loads = vec![0.0; 6];
        (0..3).for_each(|i| loads[i] = force * [0.1, 1.0][seed / 9 % 2] * number(60 + i));
        let set = ConstraintSet::builder(6).build()?;
        let target = Target { loads: &loads, prescribed: &[] };
        let options = EquilibriumOptions { stability: true, ..EquilibriumOptions::default() };
        let found = solve(&mut model, &set, &Start::at_rest(&set), &target, &options);
        assert!(
            matches!(&found, Err(EquilibriumError::Unsupported { dofs, .. }) if !dofs.is_empty() && dofs.iter().all(|&dof| dof >= 3)),
            "{seed}: {found:?}"
        );
        // A load along the bar supports it.
        (0..3).for_each(|i| loads[3 + i] = 0.1 * force * (model.ends[1][i] - model.ends[0][i]) / length);
        let target = Target { loads: &loads, prescribed: &[] };
        let found = solve(&mut model, &set, &Start::at_rest(&set), &target, &options);
        assert!(found.is_ok(), "{seed}, pulled: {found:?}");
    }
    Ok(())
}
