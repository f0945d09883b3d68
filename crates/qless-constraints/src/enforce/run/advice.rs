//! Why a solve was refused, and which factor would do: found by trying, not by a rule.

use super::super::EnforceError;
use super::super::method::Method;
use super::super::problem::Problem;
use super::{Asked, Prepared};

/// The softest spring that is tried when one is too stiff.
const SOFTEST: f64 = 1.0;
/// Powers of ten that are tried when one is too soft.
const STIFFER: i32 = 6;

/// Powers of ten that are tried on both sides where multipliers do not settle.
const DIGITS: i32 = 9;

/// Why a solve was not good enough.
pub enum Failure {
    /// A row that rounding alone should leave.
    OutOfBalance {
        row: usize,
        imbalance: f64,
    },
    /// Augmented equations are not met.
    Left {
        steps: usize,
        left: f64,
    },
    /// Penalties leave more of u than was asked for.
    TooSoft {
        cost: f64,
    },
    Other(EnforceError),
}

impl From<EnforceError> for Failure {
    fn from(error: EnforceError) -> Self {
        Self::Other(error)
    }
}

impl Failure {
    /// The error, with what to do. Cost: a factorization for each factor that is tried.
    pub fn advised(self, problem: &Problem, methods: &[Method], asked: &Asked) -> EnforceError {
        let factors = problem.kept.iter().filter_map(|&row| methods[row].factor());
        let factor = factors.fold(0.0, f64::max);
        match self {
            Self::Other(error) => error,
            Self::Left { steps, left } => {
                let shares = (1..=DIGITS).flat_map(|digits| [10_f64.powi(digits), 10_f64.powi(-digits)]);
                let better = first_that_does(problem, methods, asked, shares).map(|share| share * factor);
                EnforceError::NoConvergence { steps, left, tolerance: asked.accuracy, better }
            }
            Self::TooSoft { cost } => {
                // What is left falls as 1 / factor, once it is small.
                let accuracy = asked.accuracy;
                let first = 2.0 * cost.clamp(accuracy, accuracy.max(1e3)) / accuracy;
                let shares = (0..STIFFER).map(|digits| first * 10_f64.powi(digits));
                let smallest = first_that_does(problem, methods, asked, shares).map(|share| share * factor);
                EnforceError::PenaltyTooSmall { factor, accuracy, cost, smallest }
            }
            Self::OutOfBalance { imbalance, .. } if factor > 0.0 => {
                let shares = (1..).map(|digits| 10_f64.powi(-digits)).take_while(|share| share * factor >= SOFTEST);
                let largest = first_that_does(problem, methods, asked, shares).map(|share| share * factor);
                EnforceError::PenaltyTooLarge { factor, imbalance, largest }
            }
            Self::OutOfBalance { row, imbalance } => EnforceError::OutOfBalance { row: named(problem, row), imbalance },
        }
    }
}

/// The first multiple of all factors with which the solve is good enough.
fn first_that_does(
    problem: &Problem,
    methods: &[Method],
    asked: &Asked,
    mut shares: impl Iterator<Item = f64>,
) -> Option<f64> {
    shares.find(|&share| {
        let methods: Vec<Method> = methods.iter().map(|method| method.times(share)).collect();
        Prepared::new(problem, &methods, 0.0).is_ok_and(|mut prepared| prepared.solved(asked).is_ok())
    })
}

/// What a row of the model is to the caller.
fn named(problem: &Problem, row: usize) -> String {
    let n = problem.system.dofs();
    if row < n { format!("the forces on DOF {row}") } else { problem.system.equation_label(row - n) }
}
