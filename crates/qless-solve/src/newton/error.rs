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
        /// Index of the step that failed, from 0.
        step: usize,
        /// Why the equations cannot be linearised.
        source: LineariseError,
    },
    /// u does not have one value per DOF, or a step leads out of the range of doubles.
    #[error("at step {step}: {source}")]
    Argument {
        /// Index of the step that failed, from 0.
        step: usize,
        /// Which argument is wrong.
        source: ArgumentError,
    },
    /// The linearised equations cannot be analysed.
    #[error("at step {step}: {source}")]
    Analysis {
        /// Index of the step that failed, from 0.
        step: usize,
        /// Why the analysis failed.
        source: AnalysisError,
    },
    /// The linearised equations cannot be solved for slaves.
    #[error("at step {step}: {source}")]
    Reduction {
        /// Index of the step that failed, from 0.
        step: usize,
        /// Why the reduction failed.
        source: ReductionError,
    },
    /// The tolerance is below 1, which rounding does not allow, or it is not finite.
    #[error(
        "the tolerance is {0}; it is a multiple of the rounding error of each equation's value, finite and at least 1, such as 4"
    )]
    Tolerance(f64),
    /// Equations contradict those that they depend on: no motion that the other equations allow reduces their residual, to first or second
    /// order.
    #[error(
        "{} cannot be satisfied together with {}: the residual is {amount:e}, and no motion that the latter allow reduces it; \
         change one of them, or the prescribed values", .labels.join(" and "), list(.others)
    )]
    Conflict {
        /// Indices of the contradicted equations.
        rows: Vec<usize>,
        /// Labels of the contradicted equations.
        labels: Vec<String>,
        /// Labels of the equations that the contradicted ones depend on; empty if they depend on prescribed DOFs alone.
        others: Vec<String>,
        /// The largest `|c_r|` of the contradicted equations, in the unit of that equation.
        amount: f64,
    },
    /// The number of steps is exhausted, or no step reduces the constraint values c.
    #[error(
        "no convergence in {steps} steps: the residual of {label} is {residual:e} of its terms; start closer to the solution, or \
         change the prescribed values in smaller steps"
    )]
    NoConvergence {
        /// Number of steps made.
        steps: usize,
        /// The largest residual at the end, relative to the sizes of its terms.
        residual: f64,
        /// The equation with the largest residual.
        label: String,
    },
}

fn list(labels: &[String]) -> String {
    if labels.is_empty() { "the prescribed DOFs".into() } else { labels.join(" and ") }
}
