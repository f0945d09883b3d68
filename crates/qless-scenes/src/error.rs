//! Why a scene cannot be generated as asked.

use qless::SystemError;

use crate::oracle::OracleError;

/// Arguments that make no scene.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// A size outside what the scene's construction needs.
    #[error("{what} is {found}; it must be from {least} to {most}")]
    Size {
        /// Which size.
        what: &'static str,
        /// The size given.
        found: usize,
        /// The smallest that works.
        least: usize,
        /// The largest that works.
        most: usize,
    },
    /// A size that must be a multiple of another number.
    #[error("{what} is {found}; it must be a multiple of {of}")]
    NotMultiple {
        /// Which size.
        what: &'static str,
        /// The size given.
        found: usize,
        /// What must divide it.
        of: usize,
    },
    /// A number that cannot be used, such as a unit of zero.
    #[error("{what} is {found}; it must be finite and not zero")]
    Number {
        /// Which number.
        what: &'static str,
        /// Its value.
        found: f64,
    },
    /// Ends of elements that do not ascend from 0 to 1.
    #[error("end {node} (from 0) of the elements is at {found}; ends must ascend from 0 to 1 by at least 2^-30")]
    Mesh {
        /// Which end.
        node: usize,
        /// Where it is.
        found: f64,
    },
    /// The generated equations are not a valid system, for instance because scaling overflowed.
    #[error(transparent)]
    System(#[from] SystemError),
    /// The truth about the scene cannot be told.
    #[error(transparent)]
    Oracle(#[from] OracleError),
}

/// `least <= found <= most`, or the error that says so.
pub(crate) fn within(what: &'static str, found: usize, least: usize, most: usize) -> Result<(), SceneError> {
    if (least..=most).contains(&found) { Ok(()) } else { Err(SceneError::Size { what, found, least, most }) }
}

/// Sizes above this are taken for a mistake.
pub(crate) const MOST: usize = 1 << 27;
