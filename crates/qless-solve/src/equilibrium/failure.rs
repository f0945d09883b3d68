//! Why a load step failed; most failures are mended by a shorter one.

use std::error::Error;

use qless::{AnalysisError, ArgumentError};

use super::{EquilibriumError, Iterate};
use crate::newton::NewtonError;
use qless_constraints::{ConstraintSet, LineariseError};

#[derive(Debug)]
pub enum Failure {
    Model(Box<dyn Error + Send + Sync>),
    NotFinite {
        what: &'static str,
        at: usize,
    },
    /// Rows that do not hold.
    Conflict(Vec<usize>),
    /// DOFs of a motion that nothing resists.
    Unsupported(Vec<usize>),
    /// The row of a motor, and the angle in radians that it would turn by in one load step.
    Turn {
        row: usize,
        angle: f64,
    },
    /// What the constraints determine may have gone over to another branch; a step that is this part of it may not.
    Branch(f64),
    NoConvergence,
    Solver(String),
    Constraints(NewtonError),
    System(LineariseError),
    Analysis(AnalysisError),
    /// No shorter step will help.
    Fatal(EquilibriumError),
}

impl From<EquilibriumError> for Failure {
    fn from(error: EquilibriumError) -> Self {
        Self::Fatal(error)
    }
}

impl From<ArgumentError> for Failure {
    fn from(error: ArgumentError) -> Self {
        Self::Fatal(error.into())
    }
}

impl From<LineariseError> for Failure {
    fn from(error: LineariseError) -> Self {
        Self::System(error)
    }
}

impl From<AnalysisError> for Failure {
    fn from(error: AnalysisError) -> Self {
        Self::Analysis(error)
    }
}

/// How far the solution came before a failure.
#[derive(Clone, Copy)]
pub struct Reached {
    pub factor: f64,
    pub tried: f64,
    /// The last of the part.
    pub iterate: Iterate,
}

impl Failure {
    /// Without convergence where the tangent is singular, these DOFs are the reason.
    pub fn or_unsupported(self, dofs: Option<&Vec<usize>>) -> Self {
        match (self, dofs) {
            (Self::NoConvergence, Some(dofs)) => Self::Unsupported(dofs.clone()),
            (other, _) => other,
        }
    }

    /// The part of the step that failed which is tried next.
    pub fn shorter(&self) -> f64 {
        match self {
            Self::Branch(part) => part.clamp(0.1, 0.7),
            _ => 0.25,
        }
    }

    pub fn is_fatal(&self) -> bool {
        matches!(self, Self::Fatal(_))
    }

    pub fn into_error(self, set: &ConstraintSet, reached: Reached) -> EquilibriumError {
        let Reached { factor, tried, iterate: Iterate { force, constraint, .. } } = reached;
        match self {
            Self::Model(source) => EquilibriumError::Model { factor, source },
            Self::NotFinite { what, at } => EquilibriumError::NotFinite { factor, what, at },
            Self::Conflict(rows) => {
                EquilibriumError::Conflict { factor, labels: rows.iter().filter_map(|&r| set.label(r).ok()).collect() }
            }
            Self::Unsupported(dofs) => EquilibriumError::Unsupported { factor, dofs },
            Self::Turn { row, angle } => {
                EquilibriumError::Turn { factor, label: set.label(row).unwrap_or_default(), angle }
            }
            Self::Branch(_) => EquilibriumError::Branch { factor },
            Self::NoConvergence => EquilibriumError::NoConvergence { factor, tried, force, constraint },
            Self::Solver(why) => EquilibriumError::Solver { factor, why },
            Self::Constraints(source) => EquilibriumError::Constraints { factor, source },
            Self::System(source) => EquilibriumError::System { factor, source },
            Self::Analysis(source) => EquilibriumError::Analysis { factor, source },
            Self::Fatal(error) => error,
        }
    }
}
