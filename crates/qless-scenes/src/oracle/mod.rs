//! Reference results: the exact rank of `C_f`, by [`qless::exact`] on the stored doubles, and dense singular values.
//!
//! Exact refers to the binary doubles: the coefficient 1.0 / 3.0 is not 1/3. Constraint systems of 30,000 rows take well
//! under a second. Matrices that fill in for every elimination order, such as random ones of several thousand rows, are
//! too expensive.
//!
//! [`singular_values`] shows the distance to a matrix of lower rank, by dense floating-point arithmetic.

mod singular;

use qless::exact::{self, ExactError, ExactRank, Reading};
use qless::{ConstraintSystem, Csr, SystemError};

pub use singular::singular_values;

/// Why a reference result cannot be computed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum OracleError {
    /// A number is not finite, or an index is too large.
    #[error(transparent)]
    System(#[from] SystemError),
    /// Exact elimination needs too much memory.
    #[error(transparent)]
    Exact(#[from] ExactError),
    /// The matrix is too large for a dense decomposition.
    #[error("the matrix has {found} entries including zeros; the singular value decomposition takes at most {most}")]
    TooLarge {
        /// Number of entries, rows times columns.
        found: usize,
        /// Largest number of entries that is allowed.
        most: usize,
    },
    /// The decomposition does not converge. No finite matrix is known to cause this.
    #[error("the singular value decomposition does not converge")]
    NoConvergence,
}

/// Exact rank of a matrix of doubles.
///
/// ```
/// use qless::Csr;
/// let mut a = Csr::empty(2);
/// a.push_row([(0, 0.1), (1, 1e-300)])?;
/// a.push_row([(0, 0.2), (1, 2e-300)])?;
/// assert_eq!(qless_scenes::oracle::exact_rank(&a)?, 1);
/// a.push_row([(0, 0.3), (1, 3e-300)])?; // 0.3 is not 3 * 0.1 in binary
/// assert_eq!(qless_scenes::oracle::exact_rank(&a)?, 2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`OracleError`].
pub fn exact_rank(rows: &Csr) -> Result<usize, OracleError> {
    // A system has at least one DOF; a matrix may have no columns.
    if rows.cols() == 0 { Ok(0) } else { rank_free(&homogeneous(rows, &[])?) }
}

/// Exact rank of `C_f`, the columns of C whose DOFs are not prescribed.
///
/// # Errors
/// [`OracleError::Exact`].
pub fn rank_free(system: &ConstraintSystem) -> Result<usize, OracleError> {
    Ok(stored(system)?.rank)
}

/// Whether `C_f u_f = b - C_p u_p` has a solution in exact arithmetic.
///
/// ```
/// use qless_scenes::{oracle, paper};
/// assert!(oracle::consistent(&paper::equations_12_to_14(1.0)?.system)?);
/// assert!(!oracle::consistent(&paper::equations_12_to_14(0.0)?.system)?);
/// # Ok::<(), qless_scenes::SceneError>(())
/// ```
///
/// # Errors
/// [`OracleError::Exact`].
pub fn consistent(system: &ConstraintSystem) -> Result<bool, OracleError> {
    Ok(stored(system)?.is_solvable())
}

/// Free DOFs that have the same value in every solution: their unit rows are combinations of the rows of `C_f`.
///
/// It runs one elimination for each DOF, so the system should be small.
///
/// # Errors
/// [`OracleError`].
pub fn generated(system: &ConstraintSystem) -> Result<Vec<usize>, OracleError> {
    let rank = rank_free(system)?;
    let free = free_of(system);
    let fixed = |dof: usize| -> Result<Option<usize>, OracleError> {
        let mut extended = system.matrix().clone();
        extended.push_row([(dof, 1.0)])?;
        Ok((rank_free(&homogeneous(&extended, system.prescribed())?)? == rank).then_some(dof))
    };
    (0..system.dofs()).filter(|&dof| free(dof)).filter_map(|dof| fixed(dof).transpose()).collect()
}

fn free_of(system: &ConstraintSystem) -> impl Fn(usize) -> bool + '_ {
    |dof| system.prescribed().binary_search_by_key(&dof, |&(j, _)| j).is_err()
}

fn stored(system: &ConstraintSystem) -> Result<ExactRank, OracleError> {
    Ok(exact::rank(system, Reading::Stored)?)
}

fn homogeneous(rows: &Csr, prescribed: &[(usize, f64)]) -> Result<ConstraintSystem, OracleError> {
    Ok(ConstraintSystem::from_csr(rows, &vec![0.0; rows.rows()], prescribed)?)
}
