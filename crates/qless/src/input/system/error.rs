//! Errors of a constraint system, with row and column.

/// Why a set of equations is not a valid constraint system. Rows and DOFs are 0-based, as in the API.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SystemError {
    /// A coefficient, right-hand side or prescribed value is NaN or infinite.
    #[error("{what} is {value}; every number must be finite")]
    NotFinite {
        /// The number that is not finite: what it is, with its row and column.
        what: Place,
        /// The value that is not finite.
        value: f64,
    },
    /// A DOF number is not below the number of DOFs.
    #[error("{what} names DOF {dof}, but there are {dofs} DOFs (0 to {}); correct the index or the size", dofs.saturating_sub(1))]
    DofOutOfRange {
        /// The coefficient, right-hand side or prescribed value that has this DOF.
        what: Place,
        /// The DOF number that was given.
        dof: usize,
        /// Number of DOFs.
        dofs: usize,
    },
    /// A row number is not below the number of rows.
    #[error("entry {entry} is in row {row}, but there are {rows} rows; correct the index or the size")]
    RowOutOfRange {
        /// The place of the entry with this row number in the list of entries.
        entry: usize,
        /// The row number that was given.
        row: usize,
        /// Number of rows.
        rows: usize,
    },
    /// Arrays have different lengths, but their lengths must agree.
    #[error("{what} has {found} entries, expected {expected}")]
    WrongLength {
        /// The name of the array.
        what: &'static str,
        /// The length that the array has.
        found: usize,
        /// The length that the array must have.
        expected: usize,
    },
    /// The columns of a compressed row do not ascend.
    #[error("row {row}: column {column} comes after column {before}; columns must ascend and not repeat within a row")]
    NotAscending {
        /// The row whose columns do not ascend.
        row: usize,
        /// The column that is not above the one before it.
        column: usize,
        /// The preceding column of the row, which is not smaller.
        before: usize,
    },
    /// The starts of compressed rows or columns do not ascend from 0 to the number of entries.
    #[error("start {index} is {value}; starts must begin at 0, never decrease and end at the number of entries")]
    BadStarts {
        /// The index of the wrong start in the list of starts.
        index: usize,
        /// The wrong start.
        value: usize,
    },
    /// A DOF is prescribed with two different values.
    #[error("DOF {dof} is prescribed twice, as {first} and as {second}; remove one")]
    PrescribedTwice {
        /// The DOF that is prescribed twice.
        dof: usize,
        /// The prescribed value that comes first in the input.
        first: f64,
        /// The prescribed value that comes later in the input.
        second: f64,
    },
    /// There are no DOFs.
    #[error("the system is empty: it has {rows} equations and no DOFs")]
    Empty {
        /// Number of equations of the system without DOFs.
        rows: usize,
    },
    /// An index of the caller's matrix exceeds its rows or columns.
    #[error("entry {place} (from 0) stands in a row or column that is not there; the matrix must be {dofs} x {dofs}")]
    BadIndex {
        /// The place of the index in the list of indices.
        place: usize,
        /// Number of rows and of columns of the matrix.
        dofs: usize,
    },
    /// An entry lies in the half of a symmetric matrix that, according to the caller, is not stored.
    #[error(
        "entry {place} (from 0) stands at ({row}, {column}), in the half that is not stored; leave it out, or say that all is stored"
    )]
    WrongHalf {
        /// The place of the entry in the list of indices.
        place: usize,
        /// The row of the entry.
        row: usize,
        /// The column of the entry.
        column: usize,
    },
    /// A size exceeds the 32-bit indices of the library, or the memory.
    #[error("{what} is {found}; at most {} are supported", u32::MAX - 1)]
    TooLarge {
        /// The name of the size.
        what: &'static str,
        /// The size, which is too large.
        found: usize,
    },
}

/// The place of a number in the input.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// Coefficient in a row and column.
    Coefficient {
        /// The equation that contains the coefficient, 0-based.
        row: usize,
        /// The DOF of the coefficient, 0-based.
        dof: usize,
    },
    /// Right-hand side of a row.
    RightHandSide {
        /// The equation with this right-hand side, 0-based.
        row: usize,
    },
    /// Prescribed value of a DOF.
    Prescribed {
        /// The prescribed DOF, 0-based.
        dof: usize,
    },
}

impl std::fmt::Display for Place {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Coefficient { row, dof } => write!(f, "the coefficient in row {row}, DOF {dof}"),
            Self::RightHandSide { row } => write!(f, "the right-hand side of row {row}"),
            Self::Prescribed { dof } => write!(f, "the prescribed value of DOF {dof}"),
        }
    }
}
