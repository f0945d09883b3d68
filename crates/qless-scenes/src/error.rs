//! Errors of the generators.

use qless::SystemError;

use crate::oracle::OracleError;

/// Why a scene cannot be generated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// A size is out of range.
    #[error("{what} is {found}; it must be from {least} to {most}")]
    Size {
        /// Name of the size that is out of range.
        what: &'static str,
        /// Value of the size.
        found: usize,
        /// Smallest allowed value.
        least: usize,
        /// Largest allowed value.
        most: usize,
    },
    /// A size is not a multiple of the required number.
    #[error("{what} is {found}; it must be a multiple of {of}")]
    NotMultiple {
        /// Name of the size that is not a multiple.
        what: &'static str,
        /// Value of the size.
        found: usize,
        /// Number that should divide the size.
        of: usize,
    },
    /// A number is zero, infinite or NaN.
    #[error("{what} is {found}; it must be finite and not zero")]
    Number {
        /// Name of the number that is zero, infinite or NaN.
        what: &'static str,
        /// Value of the number.
        found: f64,
    },
    /// The ends of the elements do not ascend from 0 to 1.
    #[error("end {node} (from 0) of the elements is at {found}; ends must ascend from 0 to 1 by at least 2^-30")]
    Mesh {
        /// Index of the first wrong end.
        node: usize,
        /// Position of the first wrong end.
        found: f64,
    },
    /// The generated equations are not a valid system, for example because scaling overflowed.
    #[error(transparent)]
    System(#[from] SystemError),
    /// The truth about the scene cannot be computed.
    #[error(transparent)]
    Oracle(#[from] OracleError),
}

/// Checks `least <= found <= most`.
pub(crate) fn within(what: &'static str, found: usize, least: usize, most: usize) -> Result<(), SceneError> {
    if (least..=most).contains(&found) { Ok(()) } else { Err(SceneError::Size { what, found, least, most }) }
}

/// Largest size of a scene. Larger numbers are refused as mistakes.
pub(crate) const MOST: usize = 1 << 27;
