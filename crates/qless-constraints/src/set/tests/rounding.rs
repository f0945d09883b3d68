//! Compares rounding bounds of c and G with double-double arithmetic, with DOFs moved within their uncertainty.
//!
//! The errors are those of [`crate::ConstraintSet::evaluate`], so that formulas written by hand must meet the bounds of the general
//! evaluation.

use std::f64::consts::FRAC_PI_2;

use super::every_type::{DOFS, ROTATIONS, UnitAndShift, random, set_at};
use crate::ConstraintSet;
use crate::scalar::double_double::DoubleDouble;

type Outcome = Result<(), Box<dyn std::error::Error>>;

/// A random configuration of this size. Lengths are multiples of `unit`, rotations are in radians.
fn configuration(unit: f64, size: f64, seed: u64) -> Vec<f64> {
    let turns = |j: usize| ROTATIONS.iter().any(|range| range.contains(&j));
    let scale = |j: usize| if turns(j) { size } else { size * unit };
    (0..DOFS).map(|j| scale(j) * random(seed * DOFS as u64 + j as u64)).collect()
}

/// Rotations about one axis by multiples of a quarter turn, at which terms cancel that do not cancel elsewhere.
fn about_an_axis(unit: f64, seed: u64) -> Vec<f64> {
    let mut u = configuration(unit, 0.3, seed);
    ROTATIONS.into_iter().flatten().for_each(|j| u[j] = 0.0);
    let quarters = (seed % 9) as f64 - 4.0;
    ROTATIONS.into_iter().for_each(|range| u[range.start() + seed as usize % 3] = quarters * FRAC_PI_2);
    u
}

/// c and G of the nonlinear equations in double-double arithmetic. Each DOF u is moved by up to one unit in the
/// last place of `|u| + s`, where s is the magnitude of the coordinate that it displaces, or 1 for a rotation.
fn reference(set: &ConstraintSet, u: &[f64], seed: u64) -> [Vec<DoubleDouble>; 2] {
    let size = |j: usize| u[j].abs() + set.dof_uses.sizes(j).map_or(0.0, |[at, _]| at);
    let by = |j: usize| 2.0 * random(seed + j as u64) * f64::EPSILON * size(j);
    let moved: Vec<_> = (0..DOFS).map(|j| DoubleDouble::sum(u[j], by(j))).collect();
    let mut all = [Vec::new(), Vec::new()];
    for batch in &set.nonlinear.batches {
        let [c, g] = batch.reference(&moved);
        all[0].extend(c);
        all[1].extend(g);
    }
    all
}

/// Appends `bound / error` of all numbers with an error, after a check that no error exceeds its bound.
fn ratios(what: &str, found: &[f64], bounds: &[f64], truth: &[DoubleDouble], ratios: &mut Vec<f64>) {
    assert_eq!([found.len(), bounds.len()], [truth.len(); 2]);
    for (k, ((&x, &bound), truth)) in found.iter().zip(bounds).zip(truth).enumerate() {
        let error = truth.distance(x);
        assert!(error <= bound, "{what} {k}: {x} is off by {error}, more than {bound}");
        if error > 0.0 {
            ratios.push(bound / error);
        }
    }
}

fn median(mut x: Vec<f64>) -> f64 {
    x.sort_unstable_by(f64::total_cmp);
    x[x.len() / 2]
}

#[test]
fn bounds_hold_and_are_near() -> Outcome {
    let [mut of_c, mut of_g] = [Vec::new(), Vec::new()];
    let mut seed = 0;
    for (unit, shift) in [(1.0, 0.0), (1e-6, 0.0), (1e6, 0.0), (1.0, 1e6), (1e-12, 3e3)] {
        let set = set_at(UnitAndShift { unit, shift })?;
        let linear = set.linear_rows().len();
        let constant = set.linear.col.len();
        for size in [None, Some(0.0), Some(1e-9), Some(1e-3), Some(0.3), Some(2.0), Some(6.0), Some(13.0)] {
            for _ in 0..27 {
                seed += 1;
                let u = size.map_or_else(|| about_an_axis(unit, seed), |size| configuration(unit, size, seed));
                let mut found = set.allocate();
                set.evaluate(&u, &mut found)?;
                let rounding = set.rounding(&u)?;
                let [c, g] = reference(&set, &u, seed);
                let place = format!("unit {unit}, shift {shift}, size {size:?}, seed {seed}:");
                ratios(&format!("{place} c"), &found.c[linear..], &rounding.c()[linear..], &c, &mut of_c);
                let (values, bounds) = (&found.g.values()[constant..], &rounding.g()[constant..]);
                ratios(&format!("{place} entry of G"), values, bounds, &g, &mut of_g);
            }
        }
    }
    assert!(of_c.len() > 10_000 && of_g.len() > 100_000, "{} and {} numbers are off", of_c.len(), of_g.len());
    let (of_c, of_g) = (median(of_c), median(of_g));
    println!("bound over error, medians: c {of_c:.1}, G {of_g:.1}");
    assert!(of_c < 150.0 && of_g < 150.0, "medians {of_c} and {of_g}");
    Ok(())
}
