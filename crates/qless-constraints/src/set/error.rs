//! Errors of a set: constraints that cannot be added, changed, moved in time or linearised.

use qless::{ArgumentError, SystemError};

use crate::constraint::EquationError;

/// Why a constraint could not be changed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EditError {
    /// The constraint belongs to another set.
    #[error("the constraint belongs to another set; use the identity that this set returned")]
    Foreign,
    /// The constraint was removed before.
    #[error("constraint {place} (from 0) was removed; add it again, or deactivate constraints that return later")]
    Gone {
        /// Number of constraints that were added before this one.
        place: usize,
    },
    /// The number of right-hand sides differs from the number of linear equations of the constraint.
    #[error("{label} has {expected} linear equations, not {found}; give one right-hand side for each")]
    Count {
        /// Label of the constraint.
        label: String,
        /// Number of right-hand sides given.
        found: usize,
        /// Number of linear equations of the constraint.
        expected: usize,
    },
    /// A right-hand side is not finite.
    #[error("a right-hand side of {label} would be {value}; give a finite number")]
    NotFinite {
        /// Label of the constraint.
        label: String,
        /// The number.
        value: f64,
    },
    /// A function of time is not finite at the time of the set.
    #[error(transparent)]
    Time(#[from] TimeError),
    /// The evaluation belongs to another set, or is out of date.
    #[error(transparent)]
    Argument(#[from] ArgumentError),
}

/// Why a constraint could not be replaced.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ReplaceError<E: std::error::Error + 'static> {
    /// The constraint belongs to another set, or was removed.
    #[error(transparent)]
    Edit(#[from] EditError),
    /// The new constraint is refused.
    #[error(transparent)]
    Add(#[from] AddError<E>),
}

/// Why the set could not be linearised.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LineariseError {
    /// The evaluation belongs to another set, or is out of date.
    #[error(transparent)]
    Argument(#[from] ArgumentError),
    /// A number of c or G is not finite: u is not finite, or the constraint has no value at u, such as one on a line whose end points
    /// coincide.
    #[error(
        "{label}, row {row}: c or G contains {value} at this configuration; correct u, or choose a configuration at which the \
         constraint is defined"
    )]
    NotFinite {
        /// Row of the equation.
        row: usize,
        /// Label of the equation.
        label: String,
        /// The first number that is not finite.
        value: f64,
    },
    /// A prescribed DOF is not valid.
    #[error(transparent)]
    System(#[from] SystemError),
}

/// Why a constraint could not be added.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AddError<E: std::error::Error + 'static> {
    /// The constraint type refuses the input.
    #[error("{name} \"{label}\": {source}")]
    Input {
        /// Name of the constraint type.
        name: &'static str,
        /// The label given.
        label: String,
        /// The fault.
        source: E,
    },
    /// The equations have a fault that any type can have.
    #[error("{name} \"{label}\": {source}")]
    Equation {
        /// Name of the constraint type.
        name: &'static str,
        /// The label given.
        label: String,
        /// The fault.
        source: EquationError,
    },
}

/// Why the time of a set could not be changed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TimeError {
    /// The time is not finite.
    #[error("time {0} is not finite; give a number")]
    Time(f64),
    /// A right-hand side or a prescribed motion is not finite at the time at which it was evaluated.
    #[error("the function of time of {label} is {value} at time {time}; it must be finite there")]
    NotFinite {
        /// Label of the equation or of its constraint.
        label: String,
        /// The time at which the function was evaluated.
        time: f64,
        /// The value of the function.
        value: f64,
    },
}
