//! Returned solutions satisfy every equation, even if the terms of another equation are large.

use qless_constraints::ConstraintSet;
use qless_constraints::types::{Distance, LinearEquation, PlanarPoint};
use qless_solve::equilibrium::{self, EquilibriumError, EquilibriumOptions, Start, Target};
use qless_solve::newton::{NewtonError, NewtonOptions, solve};

use crate::equilibria::Weights;
use crate::linkages::Outcome;

/// One unit in the last place of the far rod, relative to its length: 1e-4.
const FAR: f64 = 1e12;

/// A rod so far away that its length is known to 1e-4 only, and prescribed values of an unrelated DOF.
fn set(unit: f64, values: &[f64]) -> Outcome<ConstraintSet> {
    let end = |i: usize| PlanarPoint::new([2 * i, 2 * i + 1], [unit * (FAR + i as f64), 0.0]);
    let mut builder = ConstraintSet::builder(5);
    builder.add("far rod", Distance::new(end(0), end(1)))?;
    for (i, &value) in values.iter().enumerate() {
        builder.add(format!("value {i}"), LinearEquation { terms: vec![(4, 1.0)], rhs: unit * value })?;
    }
    Ok(builder.build()?)
}

#[test]
fn a_far_rod_excuses_no_other_equation() -> Outcome {
    for unit in [1e-6, 1.0, 1e6] {
        let set = set(unit, &[1.0])?;
        let mut start = vec![0.0; 5];
        start[4] = unit * (1.0 + 1e-5);
        let found = solve(&set, &start, &[], &NewtonOptions::default())?;
        assert!((found.u[4] - unit).abs() <= 1e-15 * unit, "{:e}", found.u[4] / unit - 1.0);
        // The same in equilibrium, from a configuration in which forces are in balance.
        let mut model = Weights { springs: vec![1.0; 5] };
        let mut loads = vec![0.0; 5];
        loads[4] = 3.0 * unit;
        // The linear equation comes first.
        let multipliers = set.by_constraint(&[3.0 * unit - start[4], 0.0])?;
        let from = Start { u: start, multipliers, loads: loads.clone() };
        let target = Target { loads: &loads, prescribed: &[] };
        let found = equilibrium::solve(&mut model, &set, &from, &target, &EquilibriumOptions::default())?;
        assert!((found.u[4] - unit).abs() <= 1e-15 * unit, "{:e}", found.u[4] / unit - 1.0);
    }
    Ok(())
}

#[test]
fn a_far_rod_hides_no_conflict() -> Outcome {
    for unit in [1e-6, 1.0, 1e6] {
        let set = set(unit, &[1.0, 1.0 + 1e-5])?;
        let refused = solve(&set, &[0.0; 5], &[], &NewtonOptions::default()).expect_err("both cannot hold");
        let NewtonError::Conflict { labels, amount, .. } = &refused else { panic!("{refused}") };
        assert!(labels[0].starts_with("value") && (amount / unit - 1e-5).abs() < 1e-10, "{refused}");
        let (mut model, start) = (Weights { springs: vec![1.0; 5] }, Start::at_rest(&set));
        let target = Target { loads: &[0.0; 5], prescribed: &[] };
        let refused = equilibrium::solve(&mut model, &set, &start, &target, &EquilibriumOptions::default());
        assert!(
            matches!(refused, Err(EquilibriumError::Conflict { .. } | EquilibriumError::Constraints { .. })),
            "{refused:?}"
        );
    }
    Ok(())
}

/// A residual is relative to the largest terms of its part, and other parts do not count.
#[test]
fn residuals_are_relative_to_the_terms_of_their_part() -> Outcome {
    for far in [1e2, 1e4, 1e6] {
        let residual = |shared: usize| -> Outcome<f64> {
            let mut builder = ConstraintSet::builder(5);
            builder.add("near", LinearEquation { terms: vec![(0, 1.0), (1, -1.0)], rhs: 1e-3 })?;
            builder.add("far", LinearEquation { terms: vec![(shared, 1.0), (3, -1.0)], rhs: 1.0 - far })?;
            let start = [1.0, 1.0, 1.0, far, 0.0];
            Ok(solve(&builder.build()?, &start, &[], &NewtonOptions::default())?.iterates[0].residual)
        };
        let ratio = residual(2)? / residual(1)? / far;
        assert!((0.25..4.0).contains(&ratio), "terms of {far}: {ratio}");
    }
    Ok(())
}
