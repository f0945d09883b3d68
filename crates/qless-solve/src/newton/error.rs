//! Errors of Newton's method.

use qless::{AnalysisError, ArgumentError, ReductionError};
use qless_constraints::LineariseError;

/// Why no configuration was found.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NewtonError {
    /// A number of the linearised equations is not finite, or a prescribed DOF is not valid.
    #[error("at step {step}: {source}")]
    System {
        /// From 0.
        step: usize,
        /// What is wrong.
        source: LineariseError,
    },
    /// u does not have one value per DOF, or a step leads out of the range of doubles.
    #[error("at step {step}: {source}")]
    Argument {
        /// From 0.
        step: usize,
        /// What is wrong.
        source: ArgumentError,
    },
    /// The linearised equations cannot be analysed.
    #[error("at step {step}: {source}")]
    Analysis {
        /// From 0.
        step: usize,
        /// What is wrong.
        source: AnalysisError,
    },
    /// The linearised equations cannot be solved for slaves.
    #[error("at step {step}: {source}")]
    Reduction {
        /// From 0.
        step: usize,
        /// What is wrong.
        source: ReductionError,
    },
    /// A tolerance below what rounding allows, or not a number.
    #[error(
        "the tolerance is {0}; it is a multiple of the rounding error of each equation's value, finite and at least 1, such as 4"
    )]
    Tolerance(f64),
    /// Equations that contradict those that they depend on: no motion that the others allow reduces their residual, to first or second
    /// order.
    #[error(
        "{} cannot be satisfied together with {}: the residual is {amount:e}, and no motion that the latter allow reduces it; \
         change one of them, or the prescribed values", .labels.join(" and "), list(.others)
    )]
    Conflict {
        /// The equations.
        rows: Vec<usize>,
        /// Their labels.
        labels: Vec<String>,
        /// Labels of the equations that they depend on; empty if these are the prescribed DOFs alone.
        others: Vec<String>,
        /// The largest `|c_r|` among them, in the unit of its equation.
        amount: f64,
    },
    /// The number of steps is exhausted, or no step reduces c.
    #[error(
        "no convergence in {steps} steps: the residual of {label} is {residual:e} of its terms; start closer to the solution, or \
         change the prescribed values in smaller steps"
    )]
    NoConvergence {
        /// Steps made.
        steps: usize,
        /// Residual at the end, relative to the sizes of the terms.
        residual: f64,
        /// The equation with the largest residual.
        label: String,
    },
}

fn list(labels: &[String]) -> String {
    if labels.is_empty() { "the prescribed DOFs".into() } else { labels.join(" and ") }
}
