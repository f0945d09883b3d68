//! What can be wrong with any constraint, whatever its type.

use qless::{ArgumentError, SystemError};

use crate::constraint::StoreError;

/// Why a constraint of a set does not change.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EditError {
    /// A constraint of another set.
    #[error("the constraint is one of another set; use what adding it to this one gave")]
    Foreign,
    /// A constraint that was removed before.
    #[error("constraint {place} (from 0) was removed; add it again, or deactivate what shall come back")]
    Gone {
        /// How many were added before it.
        place: usize,
    },
    /// Another number of right-hand sides than of linear equations.
    #[error("{label} has {expected} linear equations, not {found}; give one right-hand side for each")]
    Count {
        /// The constraint.
        label: String,
        /// Right-hand sides given.
        found: usize,
        /// Linear equations.
        expected: usize,
    },
    /// A right-hand side that is no number.
    #[error("a right-hand side of {label} would be {value}; give a finite number")]
    NotFinite {
        /// The constraint.
        label: String,
        /// The number.
        value: f64,
    },
    /// A function of time that is not finite at that of the set.
    #[error(transparent)]
    Time(#[from] TimeError),
}

/// Why a constraint was not replaced.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ReplaceError<E: std::error::Error + 'static> {
    /// The constraint is not there.
    #[error(transparent)]
    Edit(#[from] EditError),
    /// What it shall be is refused.
    #[error(transparent)]
    Add(#[from] AddError<E>),
}

/// Why there are no linearised equations.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LineariseError {
    /// The quantities are those of another set.
    #[error(transparent)]
    Argument(#[from] ArgumentError),
    /// A number of c or G is not finite: u is not, or the constraint has no value there, as a line whose ends meet.
    #[error(
        "{label}, row {row}: {value} is among the numbers of c and G at this configuration; every number must be finite: \
             correct u, or start where the constraint has a value"
    )]
    NotFinite {
        /// The equation.
        row: usize,
        /// Its label.
        label: String,
        /// The first such number.
        value: f64,
    },
    /// A prescribed DOF is not valid.
    #[error(transparent)]
    System(#[from] SystemError),
}

/// Why a constraint was not added.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AddError<E: std::error::Error + 'static> {
    /// Its type refuses the input.
    #[error("{name} \"{label}\": {source}")]
    Input {
        /// The type.
        name: &'static str,
        /// The label given.
        label: String,
        /// What is wrong.
        source: E,
    },
    /// A fault that any type can have.
    #[error("{name} \"{label}\": {source}")]
    Store {
        /// The type.
        name: &'static str,
        /// The label given.
        label: String,
        /// What is wrong.
        source: StoreError,
    },
}

/// Why a set does not go to another time.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TimeError {
    /// No point in time.
    #[error("time {0} is not finite; give a number")]
    Time(f64),
    /// A right-hand side, or what a motor prescribes, is not finite then.
    #[error("the function of time of {label} is {value} at time {time}; it must be finite there")]
    NotFinite {
        /// The equation.
        label: String,
        /// When.
        time: f64,
        /// What its function gives.
        value: f64,
    },
}
