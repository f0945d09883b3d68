//! What can be wrong with lists, places and values that a caller hands to a finished result.

/// An argument that does not fit what it is given to. Places count from 0.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ArgumentError {
    /// A list of the wrong length.
    #[error("{what} has {found} numbers; {expected} are needed")]
    WrongLength {
        /// Which list.
        what: &'static str,
        /// Its length.
        found: usize,
        /// The length that it must have.
        expected: usize,
    },
    /// A place that is not there.
    #[error("{what} {found} (from 0) is not there: there are {count}")]
    OutOfRange {
        /// What is counted.
        what: &'static str,
        /// The place asked for.
        found: usize,
        /// How many there are.
        count: usize,
    },
    /// A number that is not finite.
    #[error("{what}: number {place} (from 0) is {value}; give a finite number")]
    NotFinite {
        /// Which list.
        what: &'static str,
        /// Where in the list.
        place: usize,
        /// The number.
        value: f64,
    },
    /// A result that was evaluated before the set changed.
    #[error("{what} were evaluated before the set changed; evaluate again")]
    Outdated {
        /// What.
        what: &'static str,
    },
    /// A number that must not be below zero.
    #[error("{what} is {value}; give a number of at least 0")]
    Negative {
        /// Which number.
        what: &'static str,
        /// The number.
        value: f64,
    },
    /// Numbers so large that the result leaves the range of doubles.
    #[error("{what}: number {place} (from 0) is beyond 1e308; give smaller numbers")]
    Overflow {
        /// Which result.
        what: &'static str,
        /// Where in the result.
        place: usize,
    },
    /// A list that must ascend, or share nothing with another, and does not.
    #[error(
        "{what}: {value} at place {place} (from 0) is out of order or there twice; give each number once, ascending"
    )]
    NotAscending {
        /// Which list.
        what: &'static str,
        /// Where in the list.
        place: usize,
        /// The number found there.
        value: usize,
    },
    /// A result of something else than what it is used with.
    #[error("{what} was made by another analysis or set; give one that this made")]
    Foreign {
        /// What was given.
        what: &'static str,
    },
}

/// The right length.
pub(crate) fn long(what: &'static str, found: usize, expected: usize) -> Result<(), ArgumentError> {
    if found == expected { Ok(()) } else { Err(ArgumentError::WrongLength { what, found, expected }) }
}

/// The right length, and finite.
pub(crate) fn numbers(what: &'static str, numbers: &[f64], expected: usize) -> Result<(), ArgumentError> {
    long(what, numbers.len(), expected)?;
    match numbers.iter().position(|v| !v.is_finite()) {
        Some(place) => Err(ArgumentError::NotFinite { what, place, value: numbers[place] }),
        None => Ok(()),
    }
}

/// A place below `count`.
pub(crate) fn within(what: &'static str, found: usize, count: usize) -> Result<(), ArgumentError> {
    if found < count { Ok(()) } else { Err(ArgumentError::OutOfRange { what, found, count }) }
}

/// A result of finite numbers.
pub(crate) fn in_range(what: &'static str, result: Vec<f64>) -> Result<Vec<f64>, ArgumentError> {
    match result.iter().position(|v| !v.is_finite()) {
        Some(place) => Err(ArgumentError::Overflow { what, place }),
        None => Ok(result),
    }
}
