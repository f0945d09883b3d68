//! Stiff, soft, slender and coarse models in any unit: right if the model is supported, however weakly; refused if rounding supports it.

use faer::sparse::{SparseColMat, Triplet};
use qless::{ConstraintSystem, SystemBuilder};
use qless_solve::enforce::{EnforceError, Problem, Solution};

use super::Random;
use super::dense;
use super::models::{Kind, Lack, Model, Units, all_units, beam_element, model, off};
use crate::linkages::Outcome;
use crate::patch::Block;

/// Steel: stiffness of 2e11 beside coefficients of one.
#[test]
fn steel_is_right_in_displacements_and_multipliers() -> Outcome {
    let (mut worst_u, mut worst_lambda) = (0.0_f64, 0.0_f64);
    for (i, Units { length, force }) in all_units().enumerate() {
        for case in 0..6 {
            let units = Units { length, force: 2.1e11 * force };
            let model = model(9 * case + i, Kind::Symmetric, Lack::Nothing, units)?;
            let problem = Problem::new(&model.k, &model.f, &model.system)?;
            let (u, lambda) = dense::solution(&model, problem.kept())?;
            for solution in [problem.lagrange()?, problem.transformation()?] {
                // The effect of rounding of K does not depend on the method; errors are in units of 1e-10, or of that effect.
                let rounding = (1e10 * solution.accuracy).max(1.0);
                worst_u = worst_u.max(off(&model, &solution.u, &u) / rounding);
                // Ties of rotations carry moments: a force over the root of its DOF's stiffness is the root of an energy, in any unit.
                let of = |row: usize| {
                    let first = model.system.matrix().row(row).next().map_or(0, |(j, _)| j);
                    1.0 / model.k.get(first, first).map_or(1.0, |k| k.sqrt())
                };
                let most = lambda.iter().enumerate().fold(0.0, |most: f64, (r, l)| most.max((l * of(r)).abs()));
                let pairs = solution.multipliers.iter().zip(&lambda).enumerate();
                let wrong = pairs.fold(0.0, |wrong: f64, (r, (a, b))| wrong.max(((a - b) * of(r)).abs()));
                worst_lambda = worst_lambda.max(wrong / most / rounding);
            }
        }
    }
    println!("u {worst_u:.1e}, lambda {worst_lambda:.1e}");
    assert!(worst_u < 3e-10 && worst_lambda < 3e-10, "{worst_u:e}, {worst_lambda:e}");
    Ok(())
}

fn by_all(problem: &Problem) -> Vec<(&'static str, Result<Solution, EnforceError>)> {
    vec![
        ("transformation", problem.transformation()),
        ("lagrange", problem.lagrange()),
        ("augmented", problem.augmented(1e3, 1e-12)),
    ]
}

/// Springs in a row from a wall, tied in the middle, with a load at the end: `u = F sum 1 / k`.
fn row_of_springs(stiffness: &[f64]) -> Outcome<(SparseColMat<usize, f64>, ConstraintSystem)> {
    let (n, middle) = (stiffness.len(), stiffness.len() / 2);
    // DOF i is the right end of spring i; that of the middle spring occurs twice.
    let mut entries = vec![Triplet::new(0, 0, stiffness[0])];
    for i in 1..n {
        let (a, b, s) = (if i == middle { n } else { i - 1 }, i, stiffness[i]);
        entries.extend([(a, a, s), (b, b, s), (a, b, -s), (b, a, -s)].map(|(i, j, v)| Triplet::new(i, j, v)));
    }
    let mut builder = SystemBuilder::new(n + 1);
    builder.equation([(n, 1.0), (middle - 1, -1.0)], 0.0);
    Ok((SparseColMat::try_new_from_triplets(n + 1, n + 1, &entries)?, builder.build()?))
}

/// No false alarm if neighbours differ by 1e8 many times.
#[test]
fn stiff_parts_on_soft_ones_are_held() -> Outcome {
    for units in all_units() {
        let s = units.force / units.length;
        for count in [4, 20, 100] {
            let stiffness: Vec<f64> = (0..count).map(|i| if i % 2 == 0 { s } else { 1e8 * s }).collect();
            let (k, system) = row_of_springs(&stiffness)?;
            let mut f = vec![0.0; count + 1];
            f[count - 1] = units.force;
            let exact = units.force * stiffness.iter().map(|s| s.recip()).sum::<f64>();
            for (name, solution) in by_all(&Problem::new(&k, &f, &system)?) {
                let solution = solution.map_err(|error| format!("{name}, {count}, {units:?}: {error}"))?;
                let error = (solution.u[count - 1] / exact - 1.0).abs();
                assert!(error <= 3.0 * solution.accuracy, "{name}: {error:e} of {:e}", solution.accuracy);
                assert!(solution.accuracy < 1e-1 || name == "augmented", "{name}: {:e}", solution.accuracy);
            }
        }
    }
    Ok(())
}

/// A wall that gets softer and softer: the stated accuracy gets worse, until the model is refused.
#[test]
fn doubt_grows_as_support_fades() -> Outcome {
    let (mut before, mut refused) = (0.0, false);
    for digits in 0..=20 {
        let mut stiffness = vec![1.0 / 3.0; 10];
        stiffness[0] = 10_f64.powi(-digits);
        let (k, system) = row_of_springs(&stiffness)?;
        let mut f = vec![0.0; 11];
        f[9] = 1.0;
        let exact = stiffness.iter().map(|s| s.recip()).sum::<f64>();
        match Problem::new(&k, &f, &system)?.lagrange() {
            Ok(solution) => {
                assert!(!refused, "1e-{digits} is held, and more was not");
                assert!(solution.accuracy >= 0.5 * before, "{digits}: {:e}", solution.accuracy);
                let error = (solution.u[9] / exact - 1.0).abs();
                assert!(error <= 3.0 * solution.accuracy, "{digits}: {error:e}, {:e}", solution.accuracy);
                before = solution.accuracy;
            }
            Err(EnforceError::Unsupported(_)) => {
                assert!(digits > 12, "1e-{digits} is no rounding");
                refused = true;
            }
            Err(other) => return Err(other.into()),
        }
    }
    assert!(refused);
    Ok(())
}

/// A cantilever of many elements, tied in the middle: its condition grows with the fourth power of their number, but it is supported.
#[test]
fn slender_beams_are_held() -> Outcome {
    for units in all_units() {
        for count in [10, 100, 400] {
            let (h, length) = (units.length / count as f64, units.length);
            let stiffness = units.force * length * length;
            let node = |i: usize| if i > count / 2 { 2 * i + 2 } else { 2 * i };
            let mut entries = Vec::new();
            for i in 0..count {
                // The second half starts with its own node.
                let a = if i == count / 2 { 2 * i + 2 } else { node(i) };
                let (b, s) = (node(i + 1), stiffness / h.powi(3));
                let dofs = [a, a + 1, b, b + 1];
                for (r, row) in beam_element(h).iter().enumerate() {
                    entries.extend(row.iter().zip(dofs).map(|(v, j)| Triplet::new(dofs[r], j, s * v)));
                }
            }
            let dofs = 2 * count + 4;
            let middle = 2 * (count / 2);
            let mut builder = SystemBuilder::new(dofs);
            builder.equation([(middle, 1.0), (middle + 2, -1.0)], 0.0);
            builder.equation([(middle + 1, 1.0), (middle + 3, -1.0)], 0.0);
            builder.equation([(middle + 1, 2.0), (middle + 3, -2.0)], 0.0);
            builder.prescribe(0, 0.0);
            builder.prescribe(1, 0.0);
            let (k, system) = (SparseColMat::try_new_from_triplets(dofs, dofs, &entries)?, builder.build()?);
            let mut f = vec![0.0; dofs];
            f[dofs - 2] = units.force;
            let exact = units.force * length.powi(3) / (3.0 * stiffness);
            for (name, solution) in by_all(&Problem::new(&k, &f, &system)?) {
                let solution = solution.map_err(|error| format!("{name}, {count}, {units:?}: {error}"))?;
                let error = (solution.u[dofs - 2] / exact - 1.0).abs();
                assert!(error <= 3.0 * solution.accuracy, "{name}: {error:e} of {:e}", solution.accuracy);
            }
        }
    }
    Ok(())
}

/// Blocks of solid elements tied face to face without ground have six free motions.
#[test]
fn tied_cubes_without_ground_are_refused() -> Outcome {
    for cells in [1, 3, 6] {
        for Units { length, force } in all_units() {
            let lower = Block { cells, z: 0.0, first: 0 };
            let upper = Block { cells, z: 1.0, first: lower.nodes().len() };
            let nodes = lower.nodes().len();
            let dofs = 6 * nodes;
            let entries = [lower.stiffness(), upper.stiffness()].concat().into_iter();
            let scale = force / length;
            let entries: Vec<_> = entries.map(|e| Triplet::new(e.row, e.col, scale * e.val)).collect();
            let k = SparseColMat::try_new_from_triplets(dofs, dofs, &entries)?;
            let mut builder = SystemBuilder::new(dofs);
            for i in 0..nodes / 2 {
                for axis in 0..3 {
                    builder.equation([(3 * (nodes / 2 + i) + axis, 1.0), (3 * (nodes + i) + axis, -1.0)], 0.0);
                }
            }
            let system = builder.build()?;
            let mut f = vec![0.0; dofs];
            f[dofs - 1] = force;
            for (name, solution) in by_all(&Problem::new(&k, &f, &system)?) {
                match solution {
                    Err(EnforceError::Unsupported(motion)) => assert!(motion.resistance < 1e-13, "{name}: {motion}"),
                    other => {
                        let most = other.map(|s| s.u.iter().fold(0.0, |most: f64, u| most.max(u.abs())));
                        return Err(format!("{name}, {cells} cells, {length}, {force}: {most:?}").into());
                    }
                }
            }
        }
    }
    Ok(())
}

/// Two tied trees of springs from 1e-5 to 1e5 in any order: none is refused, and all are right to their stated accuracy.
#[test]
fn springs_of_all_sizes_are_held() -> Outcome {
    let mut largest = 0.0_f64;
    for case in 0..100 {
        let mut random = Random::new(case);
        let (count, mut entries) = (30, Vec::new());
        let s = |random: &mut Random| 10_f64.powf(random.between(-5.0, 5.0));
        for i in 0..count {
            // DOF 15 is connected by the tie only.
            let s = s(&mut random);
            match i {
                0 => entries.push((0, 0, s)),
                15 => {}
                _ => {
                    let other = if i < 15 { random.below(i) } else { 15 + random.below(i - 15) };
                    entries.extend([(i, i, s), (other, other, s), (i, other, -s), (other, i, -s)]);
                }
            }
        }
        let entries: Vec<_> = entries.into_iter().map(|(i, j, v)| Triplet::new(i, j, v)).collect();
        let mut builder = SystemBuilder::new(count);
        let at = random.below(15);
        builder.equation([(15, 1.0), (at, -1.0)], 0.5);
        builder.equation([(15, -2.0), (at, 2.0)], -1.0);
        let model = Model {
            k: SparseColMat::try_new_from_triplets(count, count, &entries)?,
            f: (0..count).map(|_| random.between(-1.0, 1.0)).collect(),
            system: builder.build()?,
            name: format!("case {case}"),
        };
        let problem = Problem::new(&model.k, &model.f, &model.system)?;
        let (u, _) = dense::solution(&model, problem.kept())?;
        for (name, solution) in by_all(&problem) {
            let solution = solution.map_err(|error| format!("{case}: {name}: {error}"))?;
            let error = off(&model, &solution.u, &u);
            largest = largest.max(error / solution.accuracy);
            assert!(error <= 3.0 * solution.accuracy, "{case}: {name}: {error:e}, {:e}", solution.accuracy);
        }
    }
    println!("errors up to {largest:.1e} of what is stated");
    Ok(())
}
