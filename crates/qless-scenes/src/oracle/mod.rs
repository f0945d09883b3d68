//! `rank C_f` as it is, to check what floating point makes of it: [`qless::exact`] on the doubles as stored.
//!
//! Exact means exact for the binary doubles: one third as a coefficient is not 1/3. Constraint systems of 30,000 rows take well
//! under a second; matrices without any sparse elimination order, such as random ones of several thousand rows, do not
//! belong here.
//!
//! [`singular_values`] is the other truth: how far a rank is from the next one. It is in floating point, and dense.
//!
//! What is NaN or infinite, fills in beyond memory or is too large to be dense is an [`OracleError`].

mod singular;

use qless::exact::{self, ExactError, ExactRank, Reading};
use qless::{ConstraintSystem, Csr, SystemError};

pub use singular::singular_values;

/// Why the truth about a matrix cannot be told.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum OracleError {
    /// A number that is not finite, or an index that is too large.
    #[error(transparent)]
    System(#[from] SystemError),
    /// Exact elimination fills in beyond memory.
    #[error(transparent)]
    Exact(#[from] ExactError),
    /// Too large to be decomposed as a dense matrix.
    #[error("the matrix has {found} entries with its zeros; at most {most} are decomposed")]
    TooLarge {
        /// Rows times columns.
        found: usize,
        /// The most.
        most: usize,
    },
    /// The decomposition does not converge, which no finite matrix is known to cause.
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
    // A system needs a DOF; a matrix does not.
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

/// Free DOFs that have one value in every solution: those whose unit row is a combination of the rows of `C_f`.
///
/// One elimination per DOF, so for small systems only.
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
