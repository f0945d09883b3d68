//! Condensed matrices, with `u = L u_q + u_0`: the pattern of `K_q = L^T K L` is made once. The values of `K_q` and `f_q = L^T (f - K u_0)`
//! are computed in every step.

use std::ffi::c_int;
use std::sync::Arc;

use qless::elimination::{CondensedPattern, PrescribedDofs, Storage, View};

use crate::arrays::{length, read, set, write};
use crate::elimination::HeldElimination;
use crate::handles::{insert, on, qless_elimination, qless_pattern, remove};
use crate::status::{CallFailure, guard};

/// A pattern, and the elimination that made it.
#[derive(Debug)]
pub(crate) struct HeldPattern {
    pub(crate) elimination: Arc<HeldElimination>,
    pub(crate) pattern: CondensedPattern,
    /// The DOFs of each element, if the pattern was made from elements.
    pub(crate) elements: Option<ElementDofs>,
}

/// DOFs of elements: element e has `dofs[starts[e]..starts[e + 1]]`.
#[derive(Debug)]
pub(crate) struct ElementDofs {
    pub(crate) starts: Vec<usize>,
    pub(crate) dofs: Vec<usize>,
}

impl ElementDofs {
    pub(crate) fn of(&self, e: usize) -> &[usize] {
        &self.dofs[self.starts[e]..self.starts[e + 1]]
    }

    pub(crate) fn count(&self) -> usize {
        self.starts.len() - 1
    }
}

/// Which entries of a symmetric matrix are stored: `QLESS_FULL`, `QLESS_LOWER` or `QLESS_UPPER`.
pub(crate) fn storage(number: c_int) -> Result<Storage, CallFailure> {
    match number {
        0 => Ok(Storage::Full),
        1 => Ok(Storage::Lower),
        2 => Ok(Storage::Upper),
        _ => Err(unknown("storage", number, "QLESS_FULL, QLESS_LOWER or QLESS_UPPER")),
    }
}

/// Whether the condensed matrix is without the prescribed DOFs (`QLESS_ELIMINATED`) or keeps them (`QLESS_KEPT`).
pub(crate) fn prescribed_dofs(number: c_int) -> Result<PrescribedDofs, CallFailure> {
    match number {
        0 => Ok(PrescribedDofs::Eliminated),
        1 => Ok(PrescribedDofs::Kept),
        _ => Err(unknown("prescribed", number, "QLESS_ELIMINATED or QLESS_KEPT")),
    }
}

fn unknown(what: &str, number: c_int, choice: &str) -> CallFailure {
    CallFailure::input(format!("{what} is {number}; give {choice}"))
}

for_both_indices! { qless_condensed_64 =
    /// The pattern of K_q for matrices K with this pattern.
    ///
    /// # Safety
    /// The arrays have the lengths that the header states: `starts` has `dofs + 1` numbers, and `index` as many as the last of them says.
    pub unsafe extern "C" fn qless_condensed<I>(
        elimination: *const qless_elimination,
        dofs: i64,
        lines: c_int,
        storage: c_int,
        prescribed: c_int,
        starts: *const I,
        index: *const I,
        pattern: *mut *mut qless_pattern,
    ) -> c_int {
        on(elimination, |elimination: Arc<HeldElimination>| {
            let dofs = length("the number of DOFs", dofs)?;
            // SAFETY: the caller upholds the contract, here and below.
            let starts = unsafe { read("starts", starts, dofs + 1) }?;
            let entries = elimination.base.read(starts[dofs], "the last start")?;
            let index = unsafe { read("index", index, entries) }?;
            let view = match lines {
                0 => View::rows(starts, index),
                1 => View::columns(starts, index),
                other => return Err(unknown("lines", other, "QLESS_ROWS or QLESS_COLUMNS")),
            };
            let view = if elimination.base.is_one() { view.one_based() } else { view };
            let (view, prescribed) = (view.storing(super::storage(storage)?), prescribed_dofs(prescribed)?);
            let made = elimination.read()?.condensed(view, prescribed)?;
            unsafe { insert("pattern", pattern, HeldPattern { elimination, pattern: made, elements: None }) }
        })
    }
}

/// Frees a pattern; null is allowed.
#[unsafe(no_mangle)]
pub extern "C" fn qless_pattern_free(pattern: *mut qless_pattern) -> c_int {
    guard(|| remove::<_, HeldPattern>(pattern))
}

/// Numbers of unknowns and of stored entries of K_q.
///
/// # Safety
/// Each pointer may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn qless_pattern_sizes(
    pattern: *const qless_pattern,
    unknowns: *mut i64,
    entries: *mut i64,
) -> c_int {
    on(pattern, |held: Arc<HeldPattern>| {
        // SAFETY: the caller upholds the contract.
        unsafe {
            set("unknowns", unknowns, held.pattern.unknowns() as i64)?;
            set("entries", entries, held.pattern.nnz() as i64)?;
        }
        Ok(())
    })
}

for_both_indices! { qless_pattern_arrays_64 =
    /// The lines of K_q, and the DOF of each unknown; null for an array that is not wanted.
    ///
    /// # Safety
    /// The arrays are null or have the lengths that the header states.
    pub unsafe extern "C" fn qless_pattern_arrays<I>(
        pattern: *const qless_pattern,
        starts: *mut I,
        index: *mut I,
        dofs: *mut I,
    ) -> c_int {
        on(pattern, |held: Arc<HeldPattern>| {
            let HeldPattern { elimination, pattern, .. } = &*held;
            let wide = |list: &[u32]| list.iter().map(|&k| k as usize).collect::<Vec<_>>();
            let lists = [
                ("starts", starts, wide(pattern.starts())),
                ("index", index, wide(pattern.index())),
                ("dofs", dofs, pattern.dofs().to_vec()),
            ];
            for (what, array, list) in lists.into_iter().filter(|(_, array, _)| !array.is_null()) {
                // SAFETY: the caller upholds the contract.
                let out = unsafe { write(what, array, list.len() as i64, list.len()) }?;
                elimination.base.write(list.into_iter(), out)?;
            }
            Ok(())
        })
    }
}

/// Computes `K_q = L^T K L` and `f_q = L^T (f - K u_0)`, with `u = L u_q + u_0` for the current b and prescribed values of the elimination.
///
/// # Safety
/// The arrays have the lengths that are given and do not overlap.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn qless_condense(
    pattern: *const qless_pattern,
    k: *const f64,
    k_length: i64,
    f: *const f64,
    f_length: i64,
    k_q: *mut f64,
    k_q_length: i64,
    f_q: *mut f64,
    f_q_length: i64,
) -> c_int {
    on(pattern, |held: Arc<HeldPattern>| {
        let known = held.elimination.read()?;
        let (pattern, elimination) = (&held.pattern, &*known);
        // SAFETY: the caller upholds the contract, here and below.
        let k = unsafe { read("k", k, length("k", k_length)?) }?;
        let matrix = if k_q.is_null() && pattern.nnz() > 0 {
            None
        } else {
            Some(unsafe { write("k_q", k_q, k_q_length, pattern.nnz()) }?)
        };
        if f.is_null() && f_q.is_null() {
            let Some(matrix) = matrix else { return Err(CallFailure::input("k_q and f_q are null; give one of them")) };
            pattern.condense_matrix_into(elimination, k, matrix)?;
            return Ok(());
        }
        let (f, f_q) =
            unsafe { (read("f", f, length("f", f_length)?)?, write("f_q", f_q, f_q_length, pattern.unknowns())?) };
        match matrix {
            Some(matrix) => pattern.condense_into(elimination, k, f, matrix, f_q)?,
            None => pattern.load_into(elimination, k, f, f_q)?,
        }
        Ok(())
    })
}
