//! One solve by any methods: factored, held against its support, solved and refined until it is in balance, or refused.

mod advice;
mod give_way;
mod left;
mod support;

use super::EnforceError;
use super::equations::{BALANCED, Goal, SHARP, Settled, settle};
use super::inverse::Inverse;
use super::matrix::times;
use super::method::{Method, springs};
use super::model::Model;
use super::problem::{Problem, Solution};
use super::support::WRONG;
use advice::Failure;

/// Solutions and refinements at most; of augmented equations, each of which takes multipliers over.
const REFINEMENTS: usize = 6;
const AUGMENTATIONS: usize = 200;
/// The least imbalance that is asked of forces beside augmented equations.
const TIGHTEST: f64 = 1e-13;
/// What refinement leaves of a row where nothing hinders it.
const ROUNDED: f64 = 64.0 * f64::EPSILON;

/// u, multipliers and forces by the methods asked for.
pub fn run(problem: &Problem, methods: &[Method], accuracy: f64) -> Result<Solution, EnforceError> {
    let mut prepared = support::prepared(problem, methods)?;
    let sensitivity = support::supported(&mut prepared)?;
    let asked = Asked { accuracy, sensitivity };
    let found = prepared.solved(&asked).map_err(|failure| failure.advised(problem, methods, &asked))?;
    Ok(finished(problem, &found))
}

/// What a solution is measured by.
struct Asked {
    accuracy: f64,
    /// How much of u one share of the terms moves.
    sensitivity: f64,
}

/// The equations of a solve, and the factors of its matrix.
struct Prepared<'a> {
    problem: &'a Problem<'a>,
    methods: &'a [Method],
    model: Model,
    inverse: Inverse<'a>,
}

/// A solution in balance.
struct Found {
    /// u of the free DOFs and lambda.
    x: Vec<f64>,
    imbalance: f64,
    /// The share of u that may be wrong.
    accuracy: f64,
}

impl<'a> Prepared<'a> {
    /// With a `shift` of the diagonal that makes a singular matrix regular, or none.
    fn new(problem: &'a Problem, methods: &'a [Method], shift: f64) -> Result<Self, EnforceError> {
        let springs = springs(problem, methods)?;
        let model = Model::new(problem, methods, &springs)?;
        let inverse = Inverse::new(problem, methods, springs, shift)?;
        Ok(Self { problem, methods, model, inverse })
    }

    /// x in balance, to the accuracy asked for.
    fn solved(&mut self, asked: &Asked) -> Result<Found, Failure> {
        let (n, methods) = (self.model.dofs(), self.methods);
        let is_augmented = |i: usize| i >= n && matches!(methods[i - n], Method::Augmented { .. });
        let patient = self.problem.kept.iter().any(|&row| is_augmented(n + row));
        // Forces of springs are not in balance before their equations are met.
        let forces = if patient { BALANCED.min(asked.accuracy.max(TIGHTEST)) } else { BALANCED };
        let limit = |i: usize| if is_augmented(i) { asked.accuracy } else { forces };
        let steps = if patient { AUGMENTATIONS } else { REFINEMENTS };
        let goal = Goal { limit: &limit, lax: &is_augmented, enough: SHARP, steps, patient };
        let (rhs, sizes) = &self.model.rhs;
        let settled = settle(&self.model, &mut |r: &[f64]| self.inverse.solve(r), (rhs, sizes), &goal)?;
        let Settled { x, row, imbalance, rounding, share, steps } = settled;
        if share > 1.0 {
            let slow = is_augmented(row);
            return Err(if slow {
                Failure::Left { steps, left: imbalance }
            } else {
                Failure::OutOfBalance { row, imbalance }
            });
        }
        let (noise, left) = (rounding.max(WRONG) * asked.sensitivity, self.left_by_springs(&x));
        let is_penalty = |&row: &usize| matches!(methods[row], Method::Penalty { .. });
        if self.problem.kept.iter().any(is_penalty) {
            // Rounding that a softer spring would not have.
            if noise > asked.accuracy && rounding > ROUNDED {
                return Err(Failure::OutOfBalance { row, imbalance });
            }
            if left > asked.accuracy {
                return Err(Failure::TooSoft { cost: left });
            }
        }
        // What may be wrong as a whole is no solution, whatever was asked for.
        if left.is_nan() || left >= 1.0 {
            return Err(Failure::TooSoft { cost: left });
        }
        if noise.is_nan() || noise >= 1.0 {
            return Err(Failure::OutOfBalance { row, imbalance });
        }
        Ok(Found { x, imbalance, accuracy: noise.max(left) })
    }
}

/// Prescribed values, forces and reactions.
fn finished(problem: &Problem, found: &Found) -> Solution {
    let (u, multipliers) = found.x.split_at(problem.system.dofs());
    let mut u = u.to_vec();
    problem.system.prescribed().iter().for_each(|&(j, value)| u[j] = value);
    let mut forces = vec![0.0; u.len()];
    for (row, lambda) in multipliers.iter().enumerate().filter(|(_, lambda)| **lambda != 0.0) {
        problem.system.matrix().row(row).for_each(|(j, v)| forces[j] -= v * lambda);
    }
    let stressed = times(&problem.k, &u);
    let prescribed = problem.system.prescribed().iter();
    let reactions = prescribed.map(|&(j, _)| (j, stressed[j] - forces[j] - problem.f[j])).collect();
    let Found { imbalance, accuracy, .. } = *found;
    Solution { u, multipliers: multipliers.to_vec(), forces, reactions, accuracy, imbalance }
}
