//! Why constraints cannot be enforced.

use super::SolverError;
use qless::{AnalysisError, ArgumentError, MapError, ReductionError, SystemError};

/// Why constraints cannot be enforced.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EnforceError {
    /// K or f does not fit to the constraints.
    #[error("there are {found} {what}, but the constraints are on {dofs} DOFs")]
    Size {
        /// What does not fit.
        what: &'static str,
        /// How many there are.
        found: usize,
        /// How many there should be.
        dofs: usize,
    },
    /// K or f has a number that is not finite.
    #[error("K or f holds {value}; every number must be finite")]
    NotFinite {
        /// The number.
        value: f64,
    },
    /// Equations contradict others.
    #[error("{} cannot hold together with the equations that it depends on", .labels.join(" and "))]
    Conflict {
        /// The equations, 0-based.
        rows: Vec<usize>,
        /// Their labels.
        labels: Vec<String>,
    },
    /// The plan is not one of this problem.
    #[error("the plan has {planned} equations, but {kept} are independent, and each must occur once")]
    Plan {
        /// Equations of the plan.
        planned: usize,
        /// Equations that it should have.
        kept: usize,
    },
    /// A penalty factor is not a positive number.
    #[error("the penalty factor is {0}; it must be positive, such as 1e6")]
    Factor(f64),
    /// The matrix has no inverse.
    #[error("{what} is singular: the constraints and prescribed DOFs leave the model free to move")]
    Singular {
        /// Which matrix.
        what: &'static str,
    },
    /// Parts of T stay factors.
    #[error(
        "T has parts that stay factors, of which no step is made; make the map with Form::Explicit, or use Problem"
    )]
    Factored,
    /// The author's solver gave no solution.
    #[error(transparent)]
    Solver(#[from] SolverError),
    /// Augmented Lagrange did not come to an end.
    #[error("{left} of the constraints is left after {steps} steps; use a larger penalty factor")]
    NoConvergence {
        /// Steps made.
        steps: usize,
        /// Largest residual of an equation, relative to its parts.
        left: f64,
    },
    /// The constraints cannot be analysed.
    #[error(transparent)]
    Analysis(#[from] AnalysisError),
    /// The constraints cannot be solved for slaves.
    #[error(transparent)]
    Reduction(#[from] ReductionError),
    /// The equations chosen are no valid system.
    #[error(transparent)]
    System(#[from] SystemError),
    /// The equations cannot be put into the form that K is condensed with.
    #[error(transparent)]
    Map(#[from] MapError),
    /// Numbers that do not fit, or that lead out of the range of doubles.
    #[error(transparent)]
    Argument(#[from] ArgumentError),
}
