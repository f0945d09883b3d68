//! Errors of arguments: wrong lengths, indices and values that a caller passes to a method.

/// An invalid argument. Indices count from 0.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ArgumentError {
    /// A list of the wrong length.
    #[error("{what} has {found} numbers; {expected} are needed")]
    WrongLength {
        /// The name of the list.
        what: &'static str,
        /// The length of the list.
        found: usize,
        /// The length that the list must have.
        expected: usize,
    },
    /// An index that is out of range.
    #[error("{what} {found} (from 0) is out of range: there are {count}")]
    OutOfRange {
        /// What the index counts, such as `DOF`.
        what: &'static str,
        /// The index.
        found: usize,
        /// The index must be below this number.
        count: usize,
    },
    /// A number that is not finite.
    #[error("{what}: number {place} (from 0) is {value}; give a finite number")]
    NotFinite {
        /// The name of the list that contains the number.
        what: &'static str,
        /// The place of the number in the list, from 0.
        place: usize,
        /// The number.
        value: f64,
    },
    /// A result that was evaluated before the constraint set changed.
    #[error("{what} were evaluated before the set changed; evaluate again")]
    Outdated {
        /// The name of the outdated result.
        what: &'static str,
    },
    /// A number that must not be below zero.
    #[error("{what} is {value}; give a number of at least 0")]
    Negative {
        /// The name of the number.
        what: &'static str,
        /// The number.
        value: f64,
    },
    /// A result that exceeds the range of doubles.
    #[error("{what}: number {place} (from 0) is beyond 1e308; give smaller numbers")]
    Overflow {
        /// The name of the result.
        what: &'static str,
        /// The place of the number that exceeds the range, from 0.
        place: usize,
    },
    /// A list that does not ascend, or that has a number in common with another list.
    #[error("{what}: {value} at place {place} (from 0) is out of order or repeated; give each number once, ascending")]
    NotAscending {
        /// The name of the list.
        what: &'static str,
        /// The place of the first number out of order, from 0.
        place: usize,
        /// The number at this place.
        value: usize,
    },
    /// A DOF of an element without its place in the pattern of K_q.
    #[error(
        "the pattern of K_q has no place for DOF {dof} of an element; give the DOFs that the pattern was made from"
    )]
    NotInPattern {
        /// The DOF, from 0.
        dof: usize,
    },
    /// A result that belongs to another analysis or set.
    #[error("{what} belongs to another analysis or set; use the one that was made by this analysis or set")]
    Foreign {
        /// The name of the argument.
        what: &'static str,
    },
}

/// Checks the length of a list.
pub(crate) fn long(what: &'static str, found: usize, expected: usize) -> Result<(), ArgumentError> {
    if found == expected { Ok(()) } else { Err(ArgumentError::WrongLength { what, found, expected }) }
}

/// Checks the length of a list, and that all its numbers are finite.
pub(crate) fn numbers(what: &'static str, numbers: &[f64], expected: usize) -> Result<(), ArgumentError> {
    long(what, numbers.len(), expected)?;
    match numbers.iter().position(|v| !v.is_finite()) {
        Some(place) => Err(ArgumentError::NotFinite { what, place, value: numbers[place] }),
        None => Ok(()),
    }
}

/// Checks that an index is below `count`.
pub(crate) fn within(what: &'static str, found: usize, count: usize) -> Result<(), ArgumentError> {
    if found < count { Ok(()) } else { Err(ArgumentError::OutOfRange { what, found, count }) }
}

/// Checks that the numbers of a result are finite.
pub(crate) fn in_range(what: &'static str, result: Vec<f64>) -> Result<Vec<f64>, ArgumentError> {
    match result.iter().position(|v| !v.is_finite()) {
        Some(place) => Err(ArgumentError::Overflow { what, place }),
        None => Ok(result),
    }
}
