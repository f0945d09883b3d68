//! `rank C_f` as it is, to check what floating point makes of it: [`qless::exact`] on the doubles as stored.
//!
//! Exact means exact for the binary doubles: one third as a coefficient is not 1/3. Constraint systems of 30,000 rows take well
//! under a second; matrices without any sparse elimination order, such as random ones of several thousand rows, do not
//! belong here.
//!
//! [`singular_values`] is the other truth: how far a rank is from the next one. It is in floating point, and dense.
//!
//! Every function panics where a number is NaN or infinite, which no valid [`ConstraintSystem`] contains, and where
//! elimination fills in beyond memory.

mod singular;

use qless::exact::{self, ExactRank, Reading};
use qless::{ConstraintSystem, Csr};

pub use singular::singular_values;

/// Exact rank of a matrix of doubles.
///
/// ```
/// use qless::Csr;
/// let mut a = Csr::empty(2);
/// a.push_row([(0, 0.1), (1, 1e-300)]);
/// a.push_row([(0, 0.2), (1, 2e-300)]);
/// assert_eq!(qless_scenes::oracle::exact_rank(&a), 1);
/// a.push_row([(0, 0.3), (1, 3e-300)]); // 0.3 is not 3 * 0.1 in binary
/// assert_eq!(qless_scenes::oracle::exact_rank(&a), 2);
/// ```
pub fn exact_rank(rows: &Csr) -> usize {
    // A system needs a DOF; a matrix does not.
    if rows.cols == 0 { 0 } else { stored(&homogeneous(rows, &[])).rank }
}

/// Exact rank of `C_f`, the columns of C whose DOFs are not prescribed.
pub fn rank_free(system: &ConstraintSystem) -> usize {
    stored(system).rank
}

/// Whether `C_f u_f = b - C_p u_p` has a solution in exact arithmetic.
///
/// ```
/// use qless_scenes::{oracle, paper};
/// assert!(oracle::consistent(&paper::equations_12_to_14(1.0)?.system));
/// assert!(!oracle::consistent(&paper::equations_12_to_14(0.0)?.system));
/// # Ok::<(), qless_scenes::SceneError>(())
/// ```
pub fn consistent(system: &ConstraintSystem) -> bool {
    stored(system).is_solvable()
}

/// Free DOFs that have one value in every solution: those whose unit row is a combination of the rows of `C_f`.
///
/// One elimination per DOF, so for small systems only.
pub fn generated(system: &ConstraintSystem) -> Vec<usize> {
    let rank = rank_free(system);
    let free = free_of(system);
    let fixed = |&dof: &usize| {
        let mut extended = system.matrix().clone();
        extended.push_row([(dof, 1.0)]);
        rank_free(&homogeneous(&extended, system.prescribed())) == rank
    };
    (0..system.dofs()).filter(|&dof| free(dof)).filter(fixed).collect()
}

fn free_of(system: &ConstraintSystem) -> impl Fn(usize) -> bool + '_ {
    |dof| system.prescribed().binary_search_by_key(&dof, |&(j, _)| j).is_err()
}

fn stored(system: &ConstraintSystem) -> ExactRank {
    exact::rank(system, Reading::Stored).expect("a system within reach of exact elimination")
}

fn homogeneous(rows: &Csr, prescribed: &[(usize, f64)]) -> ConstraintSystem {
    ConstraintSystem::from_csr(rows, &vec![0.0; rows.rows()], prescribed).expect("finite numbers")
}
