//! One solve by any methods: factored, held against its support, solved and refined until it is in balance, or refused.

use super::equations::{BALANCED, Equations, Goal, SHARP, Settled, largest_of_parts, settle};
use super::inverse::Inverse;
use super::matrix::times;
use super::method::{Method, springs};
use super::model::Model;
use super::problem::{Problem, Solution};
use super::support::{HOPELESS, ROUNDING, SUSPICIOUS, sensitivity, sharpened};
use super::{EnforceError, Motion};

/// Solutions and refinements at most; of augmented equations, each of which takes multipliers over.
const REFINEMENTS: usize = 6;
const AUGMENTATIONS: usize = 200;
/// What makes a singular matrix regular, in units without units: far above rounding, far below what holds a model.
const SHIFTS: [f64; 2] = [1e-12, 1e-9];
/// The softest spring that is tried when one is too stiff.
const SOFTEST: f64 = 1.0;

/// u, multipliers and forces by the methods asked for.
pub fn run(problem: &Problem, methods: &[Method], accuracy: f64) -> Result<Solution, EnforceError> {
    let sensitivity = supported(problem, methods)?;
    let settled = attempt(problem, methods, accuracy).map_err(|failure| failure.advised(problem, methods, accuracy))?;
    let rounding = f64::EPSILON * sensitivity;
    Ok(finished(problem, &settled.0, rounding.max(settled.1)))
}

/// How sensitive u is to rounding, or the motion that nothing holds.
fn supported(problem: &Problem, methods: &[Method]) -> Result<f64, EnforceError> {
    let springs = springs(problem, methods)?;
    let model = Model::new(problem, methods, &springs)?;
    let mut inverse = match Inverse::new(problem, methods, &springs, 0.0) {
        Ok(inverse) => inverse,
        Err(EnforceError::Solver(_)) => return Err(loose(problem, methods)),
        Err(other) => return Err(other),
    };
    let mut solve = |r: &[f64]| inverse.solve(r);
    let Ok((growth, mode)) = sensitivity(&model, &mut solve) else { return Err(loose(problem, methods)) };
    // Springs hide K behind their rounding.
    let stiffest = methods.iter().filter_map(|method| method.factor()).fold(1.0, f64::max);
    if growth * stiffest < SUSPICIOUS {
        return Ok(growth);
    }
    if stiffest > 1.0 {
        let without: Vec<Method> = methods.iter().map(|method| method.without_spring()).collect();
        return supported(problem, &without);
    }
    let (motion, held) = sharpened(&model, &mut solve, mode);
    if held <= ROUNDING || growth >= HOPELESS {
        return Err(unsupported(&model, &motion, held));
    }
    Ok(growth)
}

/// The motion that a matrix without inverse leaves free.
fn loose(problem: &Problem, methods: &[Method]) -> EnforceError {
    let without: Vec<Method> = methods.iter().map(|method| method.without_spring()).collect();
    let none = vec![0.0; methods.len()];
    for shift in SHIFTS {
        let found = Model::new(problem, &without, &none).and_then(|model| {
            let mut inverse = Inverse::new(problem, &without, &none, shift)?;
            let mut solve = |r: &[f64]| inverse.solve(r);
            let (_, mode) = sensitivity(&model, &mut solve)?;
            let (motion, held) = sharpened(&model, &mut solve, mode);
            Ok((held <= ROUNDING).then(|| unsupported(&model, &motion, held)))
        });
        if let Ok(Some(error)) = found {
            return error;
        }
    }
    EnforceError::Singular { what: "the stiffness with its constraints" }
}

/// The DOFs of a motion, in the units of the caller.
fn unsupported(model: &Model, motion: &[f64], held: f64) -> EnforceError {
    EnforceError::Unsupported(Motion::new(&motion[..model.dofs()], &model.units()[..model.dofs()], held))
}

/// Why a solve was not good enough.
enum Failure {
    /// The stiffness equations are not met, or equations that leave rounding alone.
    OutOfBalance { row: usize, imbalance: f64 },
    /// Augmented equations are not met.
    Left { steps: usize, left: f64 },
    /// Penalties leave more than was asked for.
    TooSoft { cost: f64 },
    Other(EnforceError),
}

impl From<EnforceError> for Failure {
    fn from(error: EnforceError) -> Self {
        Self::Other(error)
    }
}

/// x, and the share of u that springs leave.
fn attempt(problem: &Problem, methods: &[Method], accuracy: f64) -> Result<(Vec<f64>, f64), Failure> {
    let springs = springs(problem, methods)?;
    let model = Model::new(problem, methods, &springs)?;
    let n = model.dofs();
    let mut inverse = Inverse::new(problem, methods, &springs, 0.0)?;
    let mut solve = |r: &[f64]| inverse.solve(r);
    let is_augmented = |i: usize| i >= n && matches!(methods[i - n], Method::Augmented { .. });
    let patient = problem.kept.iter().any(|&row| is_augmented(n + row));
    let limit = |i: usize| if is_augmented(i) { accuracy } else { BALANCED };
    let (enough, steps) = if patient { (1.0, AUGMENTATIONS) } else { (SHARP, REFINEMENTS) };
    let goal = Goal { limit: &limit, enough, steps, patient };
    let (rhs, sizes) = (model.rhs.0.clone(), model.rhs.1.clone());
    let Settled { x, row, imbalance, share, steps } = settle(&model, &mut solve, (&rhs, &sizes), &goal)?;
    if share > 1.0 {
        return Err(if is_augmented(row) {
            Failure::Left { steps, left: imbalance }
        } else {
            Failure::OutOfBalance { row, imbalance }
        });
    }
    let cost = if springs.iter().any(|&d| d > 0.0) { left_by_springs(model.exact(), &mut solve, &x) } else { 0.0 };
    let penalty = problem.kept.iter().any(|&row| matches!(methods[row], Method::Penalty { .. }));
    if penalty && cost > accuracy { Err(Failure::TooSoft { cost }) } else { Ok((x, cost)) }
}

/// `|u - u*| / |u*|` from the first two steps that multipliers would take towards u*: a geometric series.
fn left_by_springs(exact: Model, solve: &mut impl FnMut(&[f64]) -> Result<Vec<f64>, EnforceError>, x: &[f64]) -> f64 {
    let n = exact.dofs();
    let difference = |a: &[f64], b: Vec<f64>| a.iter().zip(b).map(|(a, b)| a - b).collect::<Vec<f64>>();
    let mut left = difference(&exact.rhs.0, exact.apply(x));
    // Forces are in balance already; what is left of them is rounding.
    left[..n].fill(0.0);
    let Ok(first) = solve(&left) else { return f64::INFINITY };
    let Ok(second) = solve(&difference(&left, exact.apply(&first))) else { return f64::INFINITY };
    let of_dofs = |x: &[f64]| {
        let mut dofs = x.to_vec();
        dofs[n..].fill(0.0);
        largest_of_parts(&exact, &dofs)
    };
    let (size, first, second) = (of_dofs(x), of_dofs(&first), of_dofs(&second));
    let parts = size.iter().zip(&first).zip(&second).filter(|((_, first), _)| **first > 0.0);
    let of_part = |((size, first), second): ((&f64, &f64), &f64)| {
        let series = if second < first { first / (1.0 - second / first) } else { f64::INFINITY };
        series / (size + series)
    };
    parts.map(of_part).map(|share| if share.is_nan() { 1.0 } else { share }).fold(0.0, f64::max)
}

impl Failure {
    /// The error, with what to do.
    fn advised(self, problem: &Problem, methods: &[Method], accuracy: f64) -> EnforceError {
        let factors = problem.kept.iter().filter_map(|&row| methods[row].factor());
        let factor = factors.fold(0.0, f64::max);
        match self {
            Self::Other(error) => error,
            Self::TooSoft { cost } => {
                EnforceError::PenaltyTooSmall { factor, accuracy, cost, smallest: smallest(problem, methods, accuracy, cost) }
            }
            Self::Left { steps, left } => EnforceError::NoConvergence { steps, left, tolerance: accuracy },
            Self::OutOfBalance { imbalance, .. } if factor > 0.0 => {
                EnforceError::PenaltyTooLarge { factor, imbalance, largest: largest(problem, methods, accuracy) }
            }
            Self::OutOfBalance { row, imbalance } => EnforceError::OutOfBalance { row: named(problem, row), imbalance },
        }
    }
}

/// The largest spring, by powers of ten below the one asked for, that does.
fn largest(problem: &Problem, methods: &[Method], accuracy: f64) -> Option<f64> {
    let factor = methods.iter().filter_map(|method| method.factor()).fold(0.0, f64::max);
    let shares = (1..).map(|digits| 0.1_f64.powi(digits)).take_while(|share| share * factor >= SOFTEST);
    let mut softer = shares.map(|share| (share, methods.iter().map(|method| method.softer(share)).collect::<Vec<_>>()));
    softer.find(|(_, methods)| attempt(problem, methods, accuracy).is_ok()).map(|(share, _)| share * factor)
}

/// The spring that leaves what is asked for, if rounding allows it: what is left falls as 1 / factor.
fn smallest(problem: &Problem, methods: &[Method], accuracy: f64, cost: f64) -> Option<f64> {
    let factor = methods.iter().filter_map(|method| method.factor()).fold(0.0, f64::max);
    let cost = if cost < 1.0 { cost / (1.0 - cost) } else { 1e3 };
    let shares = (0..16).map(|tries| 1.5 * cost / accuracy * 10_f64.powi(tries));
    let mut stiffer = shares.map(|share| (share, methods.iter().map(|method| method.softer(share)).collect::<Vec<_>>()));
    stiffer.find(|(_, methods)| attempt(problem, methods, accuracy).is_ok()).map(|(share, _)| share * factor)
}

/// What a row of the model is to the caller.
fn named(problem: &Problem, row: usize) -> String {
    let n = problem.system.dofs();
    if row < n { format!("the forces on DOF {row}") } else { problem.system.equation_label(row - n) }
}

/// Prescribed values, forces and reactions.
fn finished(problem: &Problem, x: &[f64], accuracy: f64) -> Solution {
    let (u, multipliers) = x.split_at(problem.system.dofs());
    let mut u = u.to_vec();
    problem.system.prescribed().iter().for_each(|&(j, value)| u[j] = value);
    let mut forces = vec![0.0; u.len()];
    for (row, lambda) in multipliers.iter().enumerate().filter(|(_, lambda)| **lambda != 0.0) {
        problem.system.matrix().row(row).for_each(|(j, v)| forces[j] -= v * lambda);
    }
    let stressed = times(&problem.k, &u);
    let prescribed = problem.system.prescribed().iter();
    let reactions = prescribed.map(|&(j, _)| (j, stressed[j] - forces[j] - problem.f[j])).collect();
    Solution { u, multipliers: multipliers.to_vec(), forces, reactions, accuracy, imbalance: 0.0 }
}
