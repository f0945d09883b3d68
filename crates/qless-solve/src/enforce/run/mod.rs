//! One solve by any methods, part by part: factored, held against its support, solved and refined until it is in balance, or refused.

mod give_way;
mod left;
mod multipliers;
mod penalties;
mod refusal;
mod rounding;
mod springs;
mod support;

use super::EnforceError;
use super::equations::{BALANCED, FLOOR, Goal, SHARP, Settled, settle};
use super::inverse::Inverse;
use super::matrix::times;
use super::method::{Method, springs};
use super::model::Model;
use super::part::{Part, Split};
use super::problem::{Problem, Solution};

/// Solutions and refinements at most; where multipliers take over from springs, or springs from multipliers.
const REFINEMENTS: usize = 6;
const AUGMENTATIONS: usize = 200;
/// The least imbalance that is asked of forces beside augmented equations.
const TIGHTEST: f64 = 1e-13;
/// What refinement leaves of a row where nothing hinders it.
const ROUNDED: f64 = 64.0 * f64::EPSILON;
/// The least share of the largest terms that an equation is measured by: a caller holds it against its own terms, unless those are rounding.
const FLOOR_OF_EQUATIONS: f64 = ROUNDED;

/// u, multipliers and forces by the methods asked for. Parts are refused together.
pub fn run(problem: &Problem, methods: &[Method], accuracy: f64) -> Result<Solution, EnforceError> {
    let (n, m) = (problem.system.dofs(), problem.system.equations());
    let (u, forces, multipliers) = (vec![0.0; n], vec![0.0; n], vec![0.0; m]);
    let mut solution = Solution { u, multipliers, forces, reactions: Vec::new(), accuracy: 0.0, imbalance: 0.0 };
    let mut refused = None;
    for part in Split::new(problem).parts(methods) {
        let part = part?;
        match solved(&part, accuracy) {
            Ok(found) => {
                part.place(&found.x, &mut solution);
                solution.accuracy = solution.accuracy.max(found.accuracy);
                solution.imbalance = solution.imbalance.max(found.imbalance);
            }
            Err(error) => {
                refused = Some(match refused {
                    None => error,
                    Some(first) => refusal::both(first, error),
                });
            }
        }
    }
    refused.map_or_else(|| finished(problem, solution), Err)
}

/// By springs, where the equations ask for them and they leave no doubt.
fn solved(part: &Part, accuracy: f64) -> Result<Found, EnforceError> {
    let is_sprung = part.methods.iter().any(|method| method.factor().is_some());
    let found = if is_sprung { springs::solved(part, accuracy)? } else { None };
    found.map_or_else(|| multipliers::solved(part, accuracy), Ok)
}

/// The equations of a part, and the factors of a matrix for them.
struct Prepared<'a> {
    part: &'a Part<'a>,
    methods: Vec<Method>,
    model: Model<'a>,
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
    fn new(part: &'a Part<'a>, methods: Vec<Method>, shift: f64) -> Result<Self, EnforceError> {
        let springs = springs(part, &methods)?;
        let model = Model::new(part)?.yielding(&methods, &springs);
        let inverse = Inverse::new(part, &methods, springs, shift)?;
        Ok(Self { part, methods, model, inverse })
    }

    /// x in balance, or as near as it comes; some equations may be met to the accuracy asked for.
    fn settled(&mut self, accuracy: f64) -> Result<Settled, EnforceError> {
        let Self { part, methods, model, inverse } = self;
        let is_taken_over =
            |i: usize| i >= model.dofs() && matches!(methods[i - model.dofs()], Method::Augmented { .. });
        let patient = (0..methods.len()).any(|i| is_taken_over(model.dofs() + i));
        let (n, is_penalty) = (model.dofs(), |method: &Method| matches!(method, Method::Penalty { .. }));
        let goal = Goal {
            floor: &|i| if i < n || is_penalty(&part.methods[i - n]) { FLOOR } else { FLOOR_OF_EQUATIONS },
            limit: &limits(part, if patient { accuracy } else { accuracy.min(BALANCED) }),
            lax: &is_taken_over,
            enough: SHARP,
            steps: if patient { AUGMENTATIONS } else { REFINEMENTS },
            patient,
        };
        settle(model, &mut |r: &[f64]| inverse.solve(r), (&part.rhs.0, &part.rhs.1), &goal)
    }
}

/// What may be left of each row: of augmented equations the accuracy asked for. Forces of springs are not in balance before their
/// equations are met.
fn limits<'a>(part: &'a Part<'a>, accuracy: f64) -> impl Fn(usize) -> f64 + 'a {
    let is_augmented = |method: &Method| matches!(method, Method::Augmented { .. });
    let forces = if part.methods.iter().any(is_augmented) { BALANCED.min(accuracy.max(TIGHTEST)) } else { BALANCED };
    let n = part.dofs.len();
    move |i: usize| if i >= n && is_augmented(&part.methods[i - n]) { accuracy } else { forces }
}

/// With prescribed values and reactions, and nothing that is no number.
fn finished(problem: &Problem, mut solution: Solution) -> Result<Solution, EnforceError> {
    let Solution { u, multipliers, forces, reactions, .. } = &mut solution;
    problem.system.prescribed().iter().for_each(|&(j, value)| u[j] = value);
    let stressed = times(&problem.k, u);
    let prescribed = problem.system.prescribed().iter();
    reactions.extend(prescribed.map(|&(j, _)| (j, stressed[j] - forces[j] - problem.f[j])));
    let mut all = u.iter().chain(&*multipliers).chain(&*forces).chain(reactions.iter().map(|(_, force)| force));
    if !all.all(|v| v.is_finite()) {
        return Err(EnforceError::OutOfRange);
    }
    problem.without_doubt(u)?;
    Ok(solution)
}
