//! One solve, part by part: factor, check the support, solve, and refine until the equations are in balance. The errors of all parts are
//! merged; the most severe one is returned.

mod multipliers;
mod penalty_error;
mod springs;

use super::EnforceError;
use super::EnforceError::{PenaltyTooSmall, Unsupported};
use super::part::{EnforcedPart, PartSplitter};
use super::problem::{Method, Problem, Solution};
use super::refinement::{BALANCED, FLOOR, Refined, RefinementGoal, SHARP, refine};
use super::saddle::{SaddleEquations, SaddleInverse, spring_stiffness};
use crate::common::times;

/// Most solves, including refinements; and most steps in which multipliers take over from springs.
const REFINEMENTS: usize = 6;
const AUGMENTATIONS: usize = 200;
/// The smallest relative residual of forces that is required beside augmented equations.
const TIGHTEST: f64 = 1e-13;
/// Relative residual that refinement normally reaches.
const ROUNDED: f64 = 64.0 * f64::EPSILON;
/// Floor for the terms of an equation, relative to the largest terms of its part.
const FLOOR_OF_EQUATIONS: f64 = ROUNDED;

/// Computes u, multipliers and forces by the given methods.
pub fn run(problem: &Problem, methods: &[Method], accuracy: f64) -> Result<Solution, EnforceError> {
    let (n, m) = (problem.system.dofs(), problem.system.equations());
    let (u, forces, multipliers) = (vec![0.0; n], vec![0.0; n], vec![0.0; m]);
    let mut solution = Solution { u, multipliers, forces, reactions: Vec::new(), accuracy: 0.0, imbalance: 0.0 };
    let mut refused = None;
    for part in PartSplitter::new(problem).parts(methods) {
        let part = part?;
        match solve_part(&part, accuracy) {
            Ok(found) => {
                part.place(&found.x, &mut solution);
                solution.accuracy = solution.accuracy.max(found.accuracy);
                solution.imbalance = solution.imbalance.max(found.imbalance);
            }
            Err(error) => {
                refused = Some(match refused {
                    None => error,
                    Some(first) => worse(first, error),
                });
            }
        }
    }
    refused.map_or_else(|| with_reactions(problem, solution), Err)
}

/// Solves with springs if the methods contain any and their result is certain; otherwise with multipliers.
fn solve_part(part: &EnforcedPart, accuracy: f64) -> Result<PartSolution, EnforceError> {
    let is_sprung = part.methods.iter().any(|method| method.factor().is_some());
    let found = if is_sprung { springs::by_springs(part, accuracy)? } else { None };
    found.map_or_else(|| multipliers::by_multipliers(part, accuracy), Ok)
}

/// The equations of a part, and a factored matrix for them.
struct FactoredPart<'a> {
    part: &'a EnforcedPart<'a>,
    methods: Vec<Method>,
    model: SaddleEquations<'a>,
    inverse: SaddleInverse<'a>,
}

/// A solution in balance.
struct PartSolution {
    /// u of the free DOFs and lambda.
    x: Vec<f64>,
    imbalance: f64,
    /// Estimated relative error of u.
    accuracy: f64,
}

impl<'a> FactoredPart<'a> {
    /// A positive `shift` of the diagonal makes a singular matrix regular.
    fn new(part: &'a EnforcedPart<'a>, methods: Vec<Method>, shift: f64) -> Result<Self, EnforceError> {
        let springs = spring_stiffness(part, &methods)?;
        let model = SaddleEquations::new(part)?.with_penalties(&methods, &springs);
        let inverse = SaddleInverse::new(part, &methods, springs, shift)?;
        Ok(Self { part, methods, model, inverse })
    }

    /// x in balance, or as close as refinement gets; augmented equations need the given accuracy only.
    fn refined(&mut self, accuracy: f64) -> Result<Refined, EnforceError> {
        let Self { part, methods, model, inverse } = self;
        let is_taken_over =
            |i: usize| i >= model.dofs() && matches!(methods[i - model.dofs()], Method::Augmented { .. });
        let patient = (0..methods.len()).any(|i| is_taken_over(model.dofs() + i));
        let (n, is_penalty) = (model.dofs(), |method: &Method| matches!(method, Method::Penalty { .. }));
        let goal = RefinementGoal {
            floor: &|i| if i < n || is_penalty(&part.methods[i - n]) { FLOOR } else { FLOOR_OF_EQUATIONS },
            limit: &limits(part, if patient { accuracy } else { accuracy.min(BALANCED) }),
            lax: &is_taken_over,
            enough: SHARP,
            steps: if patient { AUGMENTATIONS } else { REFINEMENTS },
            patient,
        };
        refine(model, &mut |r: &[f64]| inverse.solve(r), (&part.rhs.0, &part.rhs.1), &goal)
    }
}

/// The allowed relative residual of each row: the given accuracy for augmented equations, and [`BALANCED`] for all others. Beside augmented
/// equations, the others must reach the accuracy as well, but not less than [`TIGHTEST`]: forces are in balance only if the equations of
/// their springs are satisfied.
fn limits<'a>(part: &'a EnforcedPart<'a>, accuracy: f64) -> impl Fn(usize) -> f64 + 'a {
    let is_augmented = |method: &Method| matches!(method, Method::Augmented { .. });
    let forces = if part.methods.iter().any(is_augmented) { BALANCED.min(accuracy.max(TIGHTEST)) } else { BALANCED };
    let n = part.dofs.len();
    move |i: usize| if i >= n && is_augmented(&part.methods[i - n]) { accuracy } else { forces }
}

/// Adds prescribed values and reactions; fails if a number is not finite.
fn with_reactions(problem: &Problem, mut solution: Solution) -> Result<Solution, EnforceError> {
    let Solution { u, multipliers, forces, reactions, .. } = &mut solution;
    problem.system.prescribed().iter().for_each(|&(j, value)| u[j] = value);
    let stressed = times(&problem.k, u);
    let prescribed = problem.system.prescribed().iter();
    reactions.extend(prescribed.map(|&(j, _)| (j, stressed[j] - forces[j] - problem.f[j])));
    let mut all = u.iter().chain(&*multipliers).chain(&*forces).chain(reactions.iter().map(|(_, force)| force));
    if !all.all(|v| v.is_finite()) {
        return Err(EnforceError::OutOfRange);
    }
    problem.check_doubtful(u)?;
    Ok(solution)
}

/// The more severe of two errors, or the first one if they are equally severe. Two free motions are merged, and so are two errors of soft
/// penalties.
pub fn worse(first: EnforceError, second: EnforceError) -> EnforceError {
    match (first, second) {
        (Unsupported(a), Unsupported(b)) => Unsupported(a.union(&b)),
        (PenaltyTooSmall { factor, accuracy, cost, smallest }, second @ PenaltyTooSmall { .. }) => {
            let PenaltyTooSmall { factor: f, cost: c, smallest: s, .. } = second else { return second };
            // One factor for all penalties.
            let smallest = smallest.zip(s).map(|(a, b)| a.max(b));
            PenaltyTooSmall { factor: factor.max(f), accuracy, cost: cost.max(c), smallest }
        }
        // Errors that no factor avoids come first.
        (PenaltyTooSmall { .. }, other) | (_, other @ Unsupported(_)) => other,
        (first, _) => first,
    }
}
