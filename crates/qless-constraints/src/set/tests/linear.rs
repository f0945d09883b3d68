//! Checks `c = G u - b` for equations of different lengths, with near and distant DOFs, and with repeated coefficient lists.

use super::every_type::random;
use crate::ConstraintSet;
use crate::types::LinearEquation;

/// More DOFs than 16 bits can address, and more equations than one task evaluates.
const DOFS: usize = 200_000;
const EQUATIONS: usize = 10_000;

/// Equation i has 1 to 12 terms. Its DOFs are near each other for the first 4096 equations, distant for the next 4096, and at the end of u
/// for the others.
fn terms(i: usize) -> Vec<(usize, f64)> {
    let dof = |k: usize| match i {
        0..4096 => (7 * i + 3 * k) % 60_000,
        4096..8192 => (7919 * i + 15_485_863 * k) % DOFS,
        _ => DOFS - 1 - (5 * i + 11 * k) % 3000,
    };
    // Every third equation has one of four coefficient lists.
    let value = |k: usize| if i.is_multiple_of(3) { 1.0 + k as f64 } else { random((31 * i + k) as u64) };
    (0..=i % 12).map(|k| (dof(k), value(k))).collect()
}

#[test]
fn values_are_those_of_the_rows() -> Result<(), Box<dyn std::error::Error>> {
    let mut builder = ConstraintSet::builder(DOFS);
    let rhs = |i: usize| if i.is_multiple_of(2) { 0.0 } else { random(i as u64) };
    for i in 0..EQUATIONS {
        builder.add("", LinearEquation { terms: terms(i), rhs: rhs(i) })?;
    }
    let set = builder.build().expect("few DOFs");
    let u: Vec<f64> = (0..DOFS as u64).map(|j| random(j + 77)).collect();
    let mut evaluation = set.allocate();
    set.evaluate(&u, &mut evaluation).expect("of this set");
    for i in 0..EQUATIONS {
        let parts = || terms(i).into_iter().map(|(j, v)| v * u[j]);
        let (truth, size) = (parts().sum::<f64>() - rhs(i), parts().map(f64::abs).sum::<f64>() + rhs(i).abs());
        assert!((evaluation.c[i] - truth).abs() <= 1e-15 * size.max(1.0), "equation {i}: {}, {truth}", evaluation.c[i]);
    }
    Ok(())
}
