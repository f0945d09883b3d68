//! The reduced form `u_s = T u_q + G u_p + g`: slaves u_s, masters u_q, prescribed DOFs u_p, T, G and g.

use std::ffi::c_int;
use std::sync::{Arc, RwLock, RwLockReadGuard};

use qless::{Csr, Elimination, Form};

use crate::analysis;
use crate::arrays::{CIndex, IndexBase, set, write};
use crate::handles::{insert, on, qless_analysis, qless_elimination, remove, unharmed};
use crate::status::{CallFailure, guard};

/// An elimination and the index base of its caller. Calls that only read share the lock; a refresh holds it exclusively.
#[derive(Debug)]
pub(crate) struct HeldElimination {
    pub(crate) elimination: RwLock<Elimination>,
    pub(crate) base: IndexBase,
    /// Numbers in the job, if the elimination is that of one rank.
    pub(crate) job: Option<JobNumbers>,
}

/// Numbers in the job of DOFs that are local to a rank.
#[derive(Debug)]
pub(crate) struct JobNumbers {
    /// Of each local DOF, ascending.
    pub(crate) dofs: Vec<u64>,
    /// Of the masters that the rank owns, ascending.
    pub(crate) masters: Vec<u64>,
}

impl HeldElimination {
    pub(crate) fn new(elimination: Elimination, base: IndexBase, job: Option<JobNumbers>) -> Self {
        Self { elimination: RwLock::new(elimination), base, job }
    }

    pub(crate) fn read(&self) -> Result<RwLockReadGuard<'_, Elimination>, CallFailure> {
        unharmed(self.elimination.read())
    }
}

/// Chooses slaves and solves for them; an error if equations conflict.
///
/// # Safety
/// `elimination` may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn qless_eliminate(
    analysis: *const qless_analysis,
    elimination: *mut *mut qless_elimination,
) -> c_int {
    on(analysis, |held: Arc<analysis::HeldAnalysis>| {
        let made = Elimination::from_analysis(Arc::clone(&held.analysis), Form::Explicit)?;
        let made = HeldElimination::new(made, held.base, None);
        // SAFETY: the caller upholds the contract.
        unsafe { insert("elimination", elimination, made) }
    })
}

/// Frees an elimination; null is allowed.
#[unsafe(no_mangle)]
pub extern "C" fn qless_elimination_free(elimination: *mut qless_elimination) -> c_int {
    guard(|| remove::<_, HeldElimination>(elimination))
}

/// Numbers of slaves, masters and prescribed DOFs, and of the entries of T and G.
///
/// # Safety
/// Each pointer may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn qless_sizes(
    elimination: *const qless_elimination,
    slaves: *mut i64,
    masters: *mut i64,
    prescribed: *mut i64,
    t_entries: *mut i64,
    g_entries: *mut i64,
) -> c_int {
    on(elimination, |held: Arc<HeldElimination>| {
        let known = held.read()?;
        let reduction = known.reduction();
        let sizes = [
            ("slaves", slaves, known.slaves().len()),
            ("masters", masters, known.masters().len()),
            ("prescribed", prescribed, known.prescribed().len()),
            ("t_entries", t_entries, reduction.t().nnz()),
            ("g_entries", g_entries, reduction.g_matrix().nnz()),
        ];
        // SAFETY: the caller upholds the contract.
        sizes.into_iter().try_for_each(|(what, place, size)| unsafe { set(what, place, size as i64) })
    })
}

for_both_indices! { qless_dofs_64 =
    /// Slaves, masters and prescribed DOFs, each ascending; null for a list that is not wanted.
    ///
    /// # Safety
    /// The arrays are null or have room for as many numbers as [`qless_sizes`] says.
    pub unsafe extern "C" fn qless_dofs<I>(
        elimination: *const qless_elimination,
        slaves: *mut I,
        masters: *mut I,
        prescribed: *mut I,
    ) -> c_int {
        on(elimination, |held: Arc<HeldElimination>| {
            let known = held.read()?;
            let lists = [
                ("slaves", slaves, known.slaves()),
                ("masters", masters, known.masters()),
                ("prescribed", prescribed, known.prescribed()),
            ];
            for (what, array, list) in lists.into_iter().filter(|(_, array, _)| !array.is_null()) {
                // SAFETY: the caller upholds the contract.
                let out = unsafe { write(what, array, list.len() as i64, list.len()) }?;
                held.base.write(list.iter().copied(), out)?;
            }
            Ok(())
        })
    }
}

/// # Safety
/// The arrays have the lengths that the matrix needs.
unsafe fn rows<I: CIndex>(
    matrix: &Csr,
    base: IndexBase,
    starts: *mut I,
    columns: *mut I,
    values: *mut f64,
) -> Result<(), CallFailure> {
    let (count, nnz) = (matrix.rows() + 1, matrix.nnz());
    // SAFETY: the caller upholds the contract.
    let (starts, columns, values) = unsafe {
        (
            write("starts", starts, count as i64, count)?,
            write("columns", columns, nnz as i64, nnz)?,
            write("values", values, nnz as i64, nnz)?,
        )
    };
    base.write(matrix.starts().iter().copied(), starts)?;
    base.write(matrix.columns().iter().map(|&j| j as usize), columns)?;
    values.copy_from_slice(matrix.values());
    Ok(())
}

for_both_indices! { qless_t_64 =
    /// T of `u_s = T u_q + G u_p + g` in compressed rows: row i is slave i, column q is master q.
    ///
    /// # Safety
    /// `starts` has room for one number more than there are slaves; `columns` and `values` for the entries of T.
    pub unsafe extern "C" fn qless_t<I>(
        elimination: *const qless_elimination,
        starts: *mut I,
        columns: *mut I,
        values: *mut f64,
    ) -> c_int {
        on(elimination, |held: Arc<HeldElimination>| {
            // SAFETY: the caller upholds the contract.
            unsafe { rows(held.read()?.reduction().t(), held.base, starts, columns, values) }
        })
    }
}

for_both_indices! { qless_g_matrix_64 =
    /// G in compressed rows: row i is slave i, column p is prescribed DOF p.
    ///
    /// # Safety
    /// As [`qless_t`](super::qless_t), with the entries of G.
    pub unsafe extern "C" fn qless_g_matrix<I>(
        elimination: *const qless_elimination,
        starts: *mut I,
        columns: *mut I,
        values: *mut f64,
    ) -> c_int {
        on(elimination, |held: Arc<HeldElimination>| {
            // SAFETY: the caller upholds the contract.
            unsafe { rows(held.read()?.reduction().g_matrix(), held.base, starts, columns, values) }
        })
    }
}

/// g of `u_s = T u_q + G u_p + g`, one number per slave, for the current right-hand sides b.
///
/// # Safety
/// `g` has room for `length` numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn qless_g(elimination: *const qless_elimination, g: *mut f64, length: i64) -> c_int {
    on(elimination, |held: Arc<HeldElimination>| {
        let known = held.read()?;
        // SAFETY: the caller upholds the contract.
        let out = unsafe { write("g", g, length, known.reduction().g().len()) }?;
        out.copy_from_slice(known.reduction().g());
        Ok(())
    })
}
