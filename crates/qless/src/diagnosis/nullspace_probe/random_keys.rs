//! Keys from which random numbers are drawn.

use crate::common::random::signed;
use crate::diagnosis::certificate::History;
use crate::input::components::Labels;
use crate::input::numbering::LocalSystem;
use crate::presolve::eliminated::Eliminated;

/// Seed of the random masters and right-hand sides.
pub(super) const SEED: u64 = 0x9e37_79b9;

/// Keys from which random numbers are drawn. A key is the place of a row or DOF within its component, so that the numbers do not depend on
/// other components. If both lists are empty, a key is the place in the whole system. That is enough if the result does not depend on the
/// numbers.
#[derive(Default)]
pub(crate) struct RandomKeys {
    rows: Vec<u32>,
    dofs: Vec<u32>,
}

impl RandomKeys {
    /// The keys that are places within components.
    pub fn within_components(labels: &Labels, system: LocalSystem) -> Self {
        let (mut next_row, mut next_dof) = (vec![0; labels.count], vec![0; labels.count]);
        let mut rows = Vec::with_capacity(labels.of_row.len());
        let mut dofs = vec![u32::MAX; system.dofs()];
        let draw = |next: &mut u32| {
            *next += 1;
            *next - 1
        };
        for (i, &label) in labels.of_row.iter().enumerate() {
            rows.push(draw(&mut next_row[label as usize]));
            for &j in system.parts(i).0.iter().filter(|&&j| system.free()[j as usize]) {
                if dofs[j as usize] == u32::MAX {
                    dofs[j as usize] = draw(&mut next_dof[label as usize]);
                }
            }
        }
        Self { rows, dofs }
    }

    pub fn are_within_components(&self) -> bool {
        !self.rows.is_empty()
    }

    #[inline]
    pub fn row(&self, i: u32) -> u64 {
        u64::from(self.rows.get(i as usize).copied().unwrap_or(i))
    }

    #[inline]
    pub fn dof(&self, j: usize) -> u64 {
        self.dofs.get(j).map_or(j as u64, |&key| u64::from(key))
    }
}

/// The product of `L^-1` and a random right-hand side, by step; L holds the factors of the elimination steps.
pub fn random_step_sides(history: &History, keys: &RandomKeys) -> Vec<f64> {
    let mut right: Vec<f64> = Vec::with_capacity(history.steps.len());
    for &row in &history.steps {
        let own = signed(SEED, keys.row(history.rows[row as usize]));
        right.push(after(own, &history.factors[row as usize], &right));
    }
    right
}

/// For each step, an upper bound of the sum of magnitudes in its row of `L^-1`; L holds the factors of the elimination steps.
pub fn sizes_of_inverse(history: &History) -> Vec<f64> {
    let mut bounds: Vec<f64> = Vec::with_capacity(history.steps.len());
    for &row in &history.steps {
        let parts = history.factors[row as usize].iter().map(|&(step, factor)| factor.abs() * bounds[step as usize]);
        bounds.push(parts.fold(1.0, |sum, part| sum + part));
    }
    bounds
}

/// The right-hand side `own` of a row after elimination: each pivot row that was subtracted from the row subtracts `factor` times the
/// right-hand side of its step.
fn after(own: f64, factors: &[(u32, f64)], steps: &[f64]) -> f64 {
    own - factors.iter().map(|&(step, factor)| factor * steps[step as usize]).sum::<f64>()
}

/// For every row of the core, a random right-hand side after elimination. The blocks compute their samples from it.
pub(crate) fn random_sides(eliminated: &Eliminated, keys: &RandomKeys) -> Vec<f64> {
    let own = |row: u32| signed(SEED, keys.row(eliminated.names[row as usize]));
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

#[cfg(test)]
mod tests {
    use super::*;

    /// The bounds are at least the sums of magnitudes in the rows of `L^-1`, and equal to them if no factor is positive.
    #[test]
    fn sizes_of_inverse_bound_its_rows() {
        const STEPS: usize = 12;
        for seed in 0..50 {
            let factor = |i: usize, t: usize| 4.0 * signed(seed, (100 * i + t) as u64) - 1.0;
            let drawn = |i: usize, t: usize| {
                (signed(seed + 1000, (100 * i + t) as u64) > 0.0).then(|| (t as u32, factor(i, t)))
            };
            let steps: Vec<u32> = (0..STEPS as u32).collect();
            let factors = (0..STEPS).map(|i| (0..i).filter_map(|t| drawn(i, t)).collect()).collect();
            let mut history = History { rows: steps.clone(), factors, steps, exponents: Vec::new() };
            for is_negative in [false, true] {
                let factors = history.factors.iter_mut().flatten();
                factors.filter(|_| is_negative).for_each(|(_, factor)| *factor = -factor.abs());
                let mut sums = [0.0; STEPS];
                for column in 0..STEPS {
                    let mut x = Vec::new();
                    for (i, factors) in history.factors.iter().enumerate() {
                        x.push(after(f64::from(u8::from(i == column)), factors, &x));
                        sums[i] += x[i].abs();
                    }
                }
                for (bound, sum) in sizes_of_inverse(&history).into_iter().zip(sums) {
                    assert!(bound >= sum * (1.0 - 1e-12), "seed {seed}: {bound} is below {sum}");
                    assert!(!is_negative || bound <= sum * (1.0 + 1e-12), "seed {seed}: {bound} is above {sum}");
                }
            }
        }
    }
}
