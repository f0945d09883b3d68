//! Rods nearly along an axis in space: motions across them have small entries in G and must not be used as slaves.

use qless_constraints::types::{Distance, Point};
use qless_constraints::{ConstraintSet, SetBuilder};
use qless_solve::newton::{NewtonOptions, solve};

use crate::linkages::{Outcome, random};

const UNITS: [f64; 3] = [1e-6, 1.0, 1e6];

fn node(i: usize, at: [f64; 3]) -> Point {
    Point::new([3 * i, 3 * i + 1, 3 * i + 2], at)
}

/// Solves from nodes that are displaced by a fraction of a rod; returns the number of steps.
fn steps(set: SetBuilder, count: usize, (off, seed, unit): (f64, usize, f64)) -> Outcome<usize> {
    let set = set.build()?;
    let u: Vec<f64> = (0..3 * count).map(|j| unit * off * random(1000 * seed + j)).collect();
    let held = [0, 1, 2].map(|j| (j, 0.0));
    let found = solve(&set, &u, &held, &NewtonOptions::default())?;
    let far = found.u.iter().zip(&u).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(far < 30.0 * count as f64 * off * unit, "{count} nodes, off by {off}: moved by {far:e} in units of {unit}");
    Ok(found.iterates.len() - 1)
}

/// The number of steps depends on neither the length nor the axis of the chain.
#[test]
fn chains_along_an_axis_are_assembled_in_a_few_steps() -> Outcome {
    for rods in [5, 10, 20, 80, 300] {
        for (seed, off) in (0..12).zip([1e-4, 1e-3, 1e-2].into_iter().cycle()) {
            let unit = UNITS[seed % 3];
            let mut builder = ConstraintSet::builder(3 * rods + 3);
            let at = |i: usize| {
                let mut at = [0.0; 3];
                at[seed / 3 % 3] = unit * i as f64;
                node(i, at)
            };
            for i in 0..rods {
                builder.add(format!("rod {i}"), Distance::new(at(i), at(i + 1)))?;
            }
            let steps =
                steps(builder, rods + 1, (off, seed, unit)).map_err(|e| format!("{rods} rods, {off}, {seed}: {e}"))?;
            println!("{rods} rods, {off}: {steps} steps");
            assert!(steps <= 4, "{rods} rods, off by {off}, seed {seed}: {steps} steps");
        }
    }
    Ok(())
}

/// Flat lattices with diagonals in space, with redundant rods: across them G has small entries only, and the residual halves with each step.
#[test]
fn flat_lattices_are_assembled_in_a_few_steps() -> Outcome {
    for (seed, off) in (0..12).zip([1e-4, 1e-3, 1e-2].into_iter().cycle()) {
        let (unit, [columns, rows]) = (UNITS[seed % 3], [9, 5]);
        let mut builder = ConstraintSet::builder(3 * columns * rows);
        let at = |x: usize, y: usize| node(y * columns + x, [unit * x as f64, unit * y as f64, 0.0]);
        for (x, y) in (0..columns).flat_map(|x| (0..rows).map(move |y| (x, y))) {
            for (right, up) in [(1, 0), (0, 1), (1, 1)] {
                if x + right < columns && y + up < rows {
                    builder.add(format!("rod {x} {y} {right}{up}"), Distance::new(at(x, y), at(x + right, y + up)))?;
                }
            }
        }
        let steps = steps(builder, columns * rows, (off, seed, unit)).map_err(|e| format!("{off}, {seed}: {e}"))?;
        println!("lattice, {off}: {steps} steps");
        assert!(steps <= 16, "off by {off}, seed {seed}: {steps} steps");
    }
    Ok(())
}
