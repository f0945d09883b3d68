//! Why no equilibrium was found.
//! @@ equilibrium/failure.rs
//! Why a load step failed; most failures are mended by a shorter one.

use std::error::Error;

use qless::{AnalysisError, ArgumentError};
use qless_constraints::{ConstraintSet, LineariseError, TimeError};

use super::EquilibriumIterate;
use crate::newton::NewtonError;

/// Why no equilibrium was found.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum EquilibriumError {
    /// The numbers of DOFs or equations do not fit together.
    #[error("there are {found} {what} where the constraint set needs {expected}")]
    Size {
        /// What does not fit.
        what: &'static str,
        /// How many there are.
        found: usize,
        /// How many there should be.
        expected: usize,
    },
    /// A setting out of its range.
    #[error("the option {what} is {value}; {range}")]
    Option {
        /// Which one.
        what: &'static str,
        /// Its value.
        value: f64,
        /// What it must be.
        range: &'static str,
    },
    /// The model adds a force to a DOF that is not there.
    #[error("the model adds a force to DOF {dof}, but there are {dofs} DOFs; correct its list of DOFs")]
    Force {
        /// The DOF.
        dof: usize,
        /// How many there are.
        dofs: usize,
    },
    /// The model adds stiffness outside its pattern.
    #[error(
        "the model adds stiffness at ({row}, {column}), which its pattern does not name; both halves must be named"
    )]
    Pattern {
        /// Row, a DOF.
        row: usize,
        /// Column, a DOF.
        column: usize,
    },
    /// The model refuses the configuration.
    #[error("at load factor {factor}: the model: {source}")]
    Model {
        /// Reached so far.
        factor: f64,
        /// In its own words.
        source: Box<dyn Error + Send + Sync>,
    },
    /// A force, stiffness, load or constraint value is NaN or infinite.
    #[error("at load factor {factor}: {what} of DOF or equation {at} is not finite")]
    NotFinite {
        /// Reached so far.
        factor: f64,
        /// What.
        what: &'static str,
        /// Where.
        at: usize,
    },
    /// Motions that neither stiffness nor constraints resist.
    #[error(
        "at load factor {factor} nothing resists a motion of DOFs {dofs:?}: the tangent is singular; support the model, \
         give these DOFs stiffness or constraints, or start where tension holds them"
    )]
    Unsupported {
        /// Reached so far.
        factor: f64,
        /// The DOFs that move most in it, the largest first.
        dofs: Vec<usize>,
    },
    /// A motor turns too far in the shortest load step.
    #[error(
        "at load factor {factor}: {label} would turn by {angle} rad in the shortest load step, and more than a sixteenth of a turn is not \
         followed; allow shorter load steps, or go to a time nearer by"
    )]
    Turn {
        /// Reached so far.
        factor: f64,
        /// Its label.
        label: String,
        /// By how much, in radians.
        angle: f64,
    },
    /// The shortest load step turns a linkage so far that it may be on another branch.
    #[error(
        "at load factor {factor}: even the shortest load step moves what the constraints determine so far that it may go over to another branch; \
         allow shorter load steps, or go to a target nearer by"
    )]
    Branch {
        /// Reached so far.
        factor: f64,
    },
    /// The time, or a function of it, is not finite on the way.
    #[error(transparent)]
    Time(#[from] TimeError),
    /// The constraints have no solution near.
    #[error("at load factor {factor}: {source}")]
    Constraints {
        /// Reached so far.
        factor: f64,
        /// Why.
        source: NewtonError,
    },
    /// Equations that are left out of the solution as redundant, and do not hold.
    #[error("at load factor {factor}: {} cannot hold together with the equations that it depends on", .labels.join(" and "))]
    Conflict {
        /// Reached so far.
        factor: f64,
        /// Their labels.
        labels: Vec<String>,
    },
    /// The constraints cannot be linearised.
    #[error("at load factor {factor}: {source}")]
    System {
        /// Reached so far.
        factor: f64,
        /// What is wrong.
        source: LineariseError,
    },
    /// The constraints cannot be analysed.
    #[error("at load factor {factor}: {source}")]
    Analysis {
        /// Reached so far.
        factor: f64,
        /// What is wrong.
        source: AnalysisError,
    },
    /// Numbers that do not fit.
    #[error(transparent)]
    Argument(#[from] ArgumentError),
    /// The steps became too small.
    #[error(
        "no equilibrium beyond load factor {factor}: at {tried} the force residual is {force:e}, the constraint residual {constraint:e}; \
         the load may be more than the model carries, or it snaps through: prescribe a displacement instead"
    )]
    NoConvergence {
        /// The last factor with an equilibrium.
        factor: f64,
        /// The factor of the last attempt.
        tried: f64,
        /// Its force residual, relative.
        force: f64,
        /// Its constraint residual, relative.
        constraint: f64,
    },
    /// The matrix has no factors, or there is no memory for them.
    #[error("at load factor {factor}: the saddle matrix: {why}")]
    Solver {
        /// Reached so far.
        factor: f64,
        /// In the words of the solver.
        why: String,
    },
}

#[derive(Debug)]
pub enum StepFailure {
    Model(Box<dyn Error + Send + Sync>),
    NotFinite {
        what: &'static str,
        at: usize,
    },
    /// KeptRows that do not hold.
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

impl From<EquilibriumError> for StepFailure {
    fn from(error: EquilibriumError) -> Self {
        Self::Fatal(error)
    }
}

impl From<ArgumentError> for StepFailure {
    fn from(error: ArgumentError) -> Self {
        Self::Fatal(error.into())
    }
}

impl From<LineariseError> for StepFailure {
    fn from(error: LineariseError) -> Self {
        Self::System(error)
    }
}

impl From<AnalysisError> for StepFailure {
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
    pub iterate: EquilibriumIterate,
}

impl StepFailure {
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
        let Reached { factor, tried, iterate: EquilibriumIterate { force, constraint, .. } } = reached;
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
