//! Right-hand sides after what presolve subtracted from their rows.

use super::{Keys, SEEDS};
use crate::common::random::signed;
use crate::diagnosis::certificate::History;
use crate::presolve::eliminated::Eliminated;

/// `L^-1` times a random right-hand side, by step.
pub fn random(history: &History, keys: &Keys, seed: u64) -> Vec<f64> {
    let mut right: Vec<f64> = Vec::with_capacity(history.steps.len());
    for &row in &history.steps {
        let own = signed(seed, keys.row(history.rows[row as usize]));
        right.push(after(own, &history.factors[row as usize], &right));
    }
    right
}

/// The sizes of the rows of `L^-1`, by step.
pub fn bounds(history: &History) -> Vec<f64> {
    let mut bounds: Vec<f64> = Vec::with_capacity(history.steps.len());
    for &row in &history.steps {
        let parts = history.factors[row as usize].iter().map(|&(step, factor)| factor.abs() * bounds[step as usize]);
        bounds.push(parts.fold(1.0, |sum, part| sum + part));
    }
    bounds
}

/// A right-hand side after the steps that were subtracted from its row.
fn after(own: f64, factors: &[(u32, f64)], steps: &[f64]) -> f64 {
    own - factors.iter().map(|&(step, factor)| factor * steps[step as usize]).sum::<f64>()
}

/// A random right-hand side after elimination, for every row of the core: the one of which blocks give their samples.
pub(crate) fn random_sides(eliminated: &Eliminated, keys: &Keys) -> Vec<f64> {
    let own = |row: u32| signed(SEEDS[0], keys.row(eliminated.names[row as usize]));
    let mut steps: Vec<f64> = Vec::with_capacity(eliminated.steps.len());
    for step in &eliminated.steps {
        steps.push(after(own(step.row), &eliminated.factors[step.row as usize], &steps));
    }
    let mut all = vec![0.0; eliminated.rows.len()];
    for &row in &eliminated.core {
        all[row as usize] = after(own(row), &eliminated.factors[row as usize], &steps);
    }
    all
}
