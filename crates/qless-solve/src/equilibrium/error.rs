//! Errors of an equilibrium. Most of them end only the current load step; a shorter step may avoid them.

use std::error::Error;

use qless::{AnalysisError, ArgumentError};
use qless_constraints::{LineariseError, TimeError};

use crate::newton::NewtonError;

/// Why no equilibrium was found.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum EquilibriumError {
    /// The numbers of DOFs or equations do not match.
    #[error("there are {found} {what}, but the constraint set needs {expected}")]
    Size {
        /// Name of the list with the wrong length.
        what: &'static str,
        /// Length of the list.
        found: usize,
        /// Length that the list should have.
        expected: usize,
    },
    /// An option is out of range.
    #[error("the option {what} is {value}; {range}")]
    Option {
        /// Name of the option.
        what: &'static str,
        /// Value of the option.
        value: f64,
        /// The allowed range of the option, in words.
        range: &'static str,
    },
    /// The model adds a force to a DOF out of range.
    #[error("the model adds a force to DOF {dof}, but there are {dofs} DOFs; correct its list of DOFs")]
    Force {
        /// The DOF that is out of range.
        dof: usize,
        /// Number of DOFs.
        dofs: usize,
    },
    /// The model adds stiffness outside its pattern.
    #[error(
        "the model adds stiffness at ({row}, {column}), which is not in its pattern; the pattern must contain both halves"
    )]
    Pattern {
        /// Row of K, a DOF.
        row: usize,
        /// Column of K, a DOF.
        column: usize,
    },
    /// The model rejects the configuration.
    #[error("at load factor {factor}: the model: {source}")]
    Model {
        /// Load factor of the last equilibrium.
        factor: f64,
        /// The model's own error.
        source: Box<dyn Error + Send + Sync>,
    },
    /// A force, stiffness, load or constraint value is NaN or infinite.
    #[error("at load factor {factor}: {what} of DOF or equation {at} is not finite")]
    NotFinite {
        /// Load factor of the last equilibrium.
        factor: f64,
        /// Name of the quantity that is not finite.
        what: &'static str,
        /// DOF or equation of the number that is not finite.
        at: usize,
    },
    /// Neither stiffness nor constraints resist some motion.
    #[error(
        "at load factor {factor} nothing resists a motion of DOFs {dofs:?}: the tangent is singular; support the model, \
         give these DOFs stiffness or constraints, or start where tension holds them"
    )]
    Unsupported {
        /// Load factor of the last equilibrium.
        factor: f64,
        /// The DOFs that move most, in descending order.
        dofs: Vec<usize>,
    },
    /// A motor turns too far in the shortest load step.
    #[error(
        "at load factor {factor}: {label} would turn by {angle} rad in the shortest load step, more than a sixteenth of a turn; \
         allow shorter load steps, or choose a closer target time"
    )]
    Turn {
        /// Load factor of the last equilibrium.
        factor: f64,
        /// Label of the motor.
        label: String,
        /// Angle of the turn, in radians.
        angle: f64,
    },
    /// The shortest load step moves a linkage so far that it may change to another branch.
    #[error(
        "at load factor {factor}: even the shortest load step moves a linkage so far that it may change to another branch; allow \
         shorter load steps, or choose a closer target"
    )]
    Branch {
        /// Load factor of the last equilibrium.
        factor: f64,
    },
    /// The time, or a function of it, is not finite.
    #[error(transparent)]
    Time(#[from] TimeError),
    /// The constraints have no solution nearby.
    #[error("at load factor {factor}: {source}")]
    Constraints {
        /// Load factor of the last equilibrium.
        factor: f64,
        /// Why Newton's method fails.
        source: NewtonError,
    },
    /// Equations that the solution ignores as redundant do not hold.
    #[error("at load factor {factor}: conflicting equations: {}; each contradicts the equations that it depends on", .labels.join(" and "))]
    Conflict {
        /// Load factor of the last equilibrium.
        factor: f64,
        /// Labels of the equations that do not hold.
        labels: Vec<String>,
    },
    /// The constraints cannot be linearised.
    #[error("at load factor {factor}: {source}")]
    System {
        /// Load factor of the last equilibrium.
        factor: f64,
        /// Why the constraints cannot be linearised.
        source: LineariseError,
    },
    /// The constraints cannot be analysed.
    #[error("at load factor {factor}: {source}")]
    Analysis {
        /// Load factor of the last equilibrium.
        factor: f64,
        /// Why the constraints cannot be analysed.
        source: AnalysisError,
    },
    /// An argument has the wrong length or range.
    #[error(transparent)]
    Argument(#[from] ArgumentError),
    /// The load steps became too short.
    #[error(
        "no equilibrium beyond load factor {factor}: at {tried} the force residual is {force:e}, the constraint residual {constraint:e}; \
         the load may exceed the limit load, or the model snaps through: prescribe a displacement instead"
    )]
    NoConvergence {
        /// Load factor of the last equilibrium.
        factor: f64,
        /// Load factor of the last attempt.
        tried: f64,
        /// Relative force residual of the last attempt.
        force: f64,
        /// Relative constraint residual of the last attempt.
        constraint: f64,
    },
    /// A moment is given at the scalar part of Euler parameters.
    #[error(
        "there is a load at DOF {dof}, the scalar part of Euler parameters; a moment has three components, which belong to the other three"
    )]
    Moment {
        /// The DOF of the scalar part, which has the load.
        dof: usize,
    },
    /// The stiffness of the model is not the slope of its forces.
    #[error(
        "at load factor {factor}: the stiffness of the model is wrong: K({row}, {column}) is {given:e}, but differences of the force of DOF \
         {row} give {difference:e}; correct the tangent, which then may find the equilibrium"
    )]
    Tangent {
        /// Load factor of the last equilibrium.
        factor: f64,
        /// Row of K, a DOF.
        row: usize,
        /// Column of K, a DOF.
        column: usize,
        /// The value of K(row, column) in the model's stiffness.
        given: f64,
        /// K(row, column) by differences of the force of DOF `row`.
        difference: f64,
    },
    /// The saddle matrix cannot be factored, or memory is exhausted.
    #[error("at load factor {factor}: the saddle matrix: {why}")]
    Solver {
        /// Load factor of the last equilibrium.
        factor: f64,
        /// The solver's own error.
        why: String,
    },
}

impl EquilibriumError {
    /// Fills in the load factor of the last equilibrium, which is not known where errors arise.
    pub(super) fn at(mut self, last: f64) -> Self {
        match &mut self {
            Self::Model { factor, .. }
            | Self::NotFinite { factor, .. }
            | Self::Unsupported { factor, .. }
            | Self::Turn { factor, .. }
            | Self::Branch { factor }
            | Self::Constraints { factor, .. }
            | Self::Conflict { factor, .. }
            | Self::System { factor, .. }
            | Self::Analysis { factor, .. }
            | Self::NoConvergence { factor, .. }
            | Self::Tangent { factor, .. }
            | Self::Solver { factor, .. } => *factor = last,
            _ => (),
        }
        self
    }

    /// Whether shorter load steps do not help.
    pub(super) fn is_fatal(&self) -> bool {
        let of_input =
            matches!(self, Self::Size { .. } | Self::Option { .. } | Self::Moment { .. } | Self::Argument(_));
        of_input || matches!(self, Self::Force { .. } | Self::Pattern { .. } | Self::Time(_))
    }

    pub(super) fn solver(why: String) -> Self {
        Self::Solver { factor: 0.0, why }
    }
}

impl From<NewtonError> for EquilibriumError {
    fn from(error: NewtonError) -> Self {
        match error {
            NewtonError::System { source, .. } => Self::System { factor: 0.0, source },
            NewtonError::Analysis { source, .. } => Self::Analysis { factor: 0.0, source },
            NewtonError::Argument { source, .. } => Self::Argument(source),
            source => Self::Constraints { factor: 0.0, source },
        }
    }
}
