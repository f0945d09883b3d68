//! `rank C >= rank (C mod p)`, with equality for all but a few primes p: the exact rank of a sparse matrix.
//!
//! A double is `m 2^k` with whole m and k, so a matrix of doubles has an exact residue modulo any odd prime,
//! and elimination on residues is free of rounding. The rank modulo p never exceeds the true rank and falls
//! below it only where p divides every maximal minor; the larger of two 61-bit primes is taken. Exact means
//! exact for the doubles as stored: one third as a coefficient is not 1/3.
//!
//! Columns that occur once go first, since they cost nothing; the rest is eliminated from the shortest row and
//! its rarest column (Markowitz 1957). Constraint systems of 30,000 rows take well under a second; matrices
//! without any sparse elimination order, such as random ones of several thousand rows, do not belong here.
//!
//! [`singular_values`] is the other truth: how far a rank is from the next one. It is in floating point, and dense.
//!
//! Every function panics where a number is NaN or infinite, which no valid [`ConstraintSystem`] contains.

mod eliminate;
mod field;
mod singular;

use qless::{ConstraintSystem, Csr};

use eliminate::rank;
use field::{Field, Mod61};
pub use singular::singular_values;

/// A row of residues: `(column, value)`, ascending by column, values nonzero.
type Row = Vec<(u32, u64)>;

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
    let all = |_: usize| true;
    rank::<Mod61<1>>(residues::<Mod61<1>>(rows, all), rows.cols)
        .max(rank::<Mod61<31>>(residues::<Mod61<31>>(rows, all), rows.cols))
}

/// Exact rank of `C_f`, the columns of C whose DOFs are not prescribed.
pub fn rank_free(system: &ConstraintSystem) -> usize {
    rank_free_in::<Mod61<1>>(system).max(rank_free_in::<Mod61<31>>(system))
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
    let augmented = augmented_rank::<Mod61<1>>(system).max(augmented_rank::<Mod61<31>>(system));
    augmented == rank_free(system)
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
        let rows = residues::<Mod61<1>>(&extended, &free);
        eliminate::rank::<Mod61<1>>(rows, extended.cols) == rank
    };
    (0..system.dofs()).filter(|&dof| free(dof)).filter(fixed).collect()
}

fn free_of(system: &ConstraintSystem) -> impl Fn(usize) -> bool + '_ {
    |dof| system.prescribed().binary_search_by_key(&dof, |&(j, _)| j).is_err()
}

fn residues<F: Field>(rows: &Csr, keep: impl Fn(usize) -> bool) -> Vec<Row> {
    let entry = |(j, v): (usize, f64)| Some((j as u32, F::of(v))).filter(|&(_, residue)| keep(j) && residue != 0);
    (0..rows.rows()).map(|i| rows.row(i).filter_map(entry).collect()).collect()
}

fn rank_free_in<F: Field>(system: &ConstraintSystem) -> usize {
    rank::<F>(residues::<F>(system.matrix(), free_of(system)), system.dofs())
}

/// Rank of `[C_f | b - C_p u_p]`.
fn augmented_rank<F: Field>(system: &ConstraintSystem) -> usize {
    let mut rows = residues::<F>(system.matrix(), free_of(system));
    let mut value = vec![0; system.dofs()];
    for &(dof, u) in system.prescribed() {
        value[dof] = F::of(u);
    }
    for (i, row) in rows.iter_mut().enumerate() {
        let known = system.matrix().row(i).fold(0, |sum, (j, v)| F::add(sum, F::mul(F::of(v), value[j])));
        let rest = F::add(F::of(system.rhs()[i]), F::negative(known));
        row.extend(Some((system.dofs() as u32, rest)).filter(|&(_, rest)| rest != 0));
    }
    rank::<F>(rows, system.dofs() + 1)
}
