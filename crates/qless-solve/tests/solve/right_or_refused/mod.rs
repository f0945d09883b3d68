//! Solutions are right to their stated accuracy, and unsupported models are refused with their free motion.

mod dense;
mod extremes;
mod half;
mod large;
mod models;
mod noise_of_t;
mod parts;
mod penalties;
mod steps;
mod supported;
mod trees;
mod units;
mod unsupported;

use qless::common::SplitMix64;
use qless_solve::enforce::{Method, Problem};

use crate::linkages::Outcome;
use models::{Kind, Lack, all_units, model, off};

/// Random numbers, the same in every run.
pub struct Random(SplitMix64);

impl Random {
    pub fn new(seed: usize) -> Self {
        Self(SplitMix64::new(seed as u64))
    }

    /// A number in `[low, high)`.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.0.next() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A whole number below `count`.
    pub fn below(&mut self, count: usize) -> usize {
        (self.0.next() % count as u64) as usize
    }
}

/// Only equations with a penalty have a gap, `lambda / D`; all others hold to rounding.
#[test]
fn each_equation_keeps_to_its_method() -> Outcome {
    for (case, units) in all_units().enumerate() {
        let kind = [Kind::Symmetric, Kind::Unsymmetric, Kind::Indefinite][case % 3];
        let model = model(case + 1, kind, Lack::Nothing, units)?;
        let problem = Problem::new(&model.k, &model.f, &model.system)?;
        let turns = [
            Method::Penalty { factor: 1e6 },
            Method::Elimination,
            Method::Augmented { factor: 1e4 },
            Method::Multiplier,
        ];
        let mut methods = vec![Method::Multiplier; model.system.equations()];
        problem.kept().iter().enumerate().for_each(|(i, &row)| methods[row] = turns[i % 4]);
        let solution = problem.enforce(&methods, 1e-2)?;
        let (u, _) = dense::solution(&model, problem.kept())?;
        assert!(off(&model, &solution.u, &u) <= 1e-2, "{}", model.name);
        for &row in problem.kept() {
            let terms = || model.system.matrix().row(row).map(|(j, v)| v * solution.u[j]);
            let (value, size) = (terms().sum::<f64>(), terms().map(f64::abs).sum::<f64>());
            let gap = (value - model.system.rhs()[row]).abs() / size;
            match methods[row] {
                Method::Penalty { .. } => assert!(gap > 0.0 && gap < 1e-2, "{}: penalty: {gap:e}", model.name),
                Method::Augmented { .. } => assert!(gap <= 1e-2, "{}: augmented: {gap:e}", model.name),
                other => assert!(gap <= 1e-10, "{}: {other:?}: {gap:e}", model.name),
            }
        }
    }
    Ok(())
}
