//! The reduced form: slaves, masters, T, G, g, and its uses.

use std::ffi::c_int;
use std::sync::{Arc, RwLock, RwLockReadGuard};

use qless::{Csr, Elimination, Form};

use crate::analysis;
use crate::arrays::{CIndex, IndexBase, length, read, set, write};
use crate::handles::{get, insert, qless_analysis, qless_elimination, remove, unharmed};
use crate::status::{CallFailure, OK, guard};

/// Calls that only read share the lock; a refresh holds it exclusively.
#[derive(Debug)]
pub(crate) struct HeldElimination {
    elimination: RwLock<Elimination>,
    pub(crate) base: IndexBase,
}

impl HeldElimination {
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
    guard(|| {
        let held: Arc<analysis::HeldAnalysis> = get(analysis)?;
        let made = Elimination::from_analysis(Arc::clone(&held.analysis), Form::Explicit)?;
        let made = HeldElimination { elimination: RwLock::new(made), base: held.base };
        // SAFETY: the caller upholds the contract.
        unsafe { insert("elimination", elimination, made) }?;
        Ok(OK)
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
    guard(|| {
        let held: Arc<HeldElimination> = get(elimination)?;
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
        sizes.into_iter().try_for_each(|(what, place, size)| unsafe { set(what, place, size as i64) })?;
        Ok(OK)
    })
}

/// # Safety
/// The arrays have room for as many numbers as [`qless_sizes`] says.
unsafe fn dofs<I: CIndex>(elimination: *const qless_elimination, arrays: [*mut I; 3]) -> Result<c_int, CallFailure> {
    let held: Arc<HeldElimination> = get(elimination)?;
    let known = held.read()?;
    let lists = [("slaves", known.slaves()), ("masters", known.masters()), ("prescribed", known.prescribed())];
    for ((what, list), array) in lists.into_iter().zip(arrays).filter(|(_, array)| !array.is_null()) {
        // SAFETY: the caller upholds the contract.
        let out = unsafe { write(what, array, list.len() as i64, list.len()) }?;
        held.base.write(list.iter().copied(), out)?;
    }
    Ok(OK)
}

/// Slaves, masters and prescribed DOFs, each ascending; null for a list that is not wanted.
///
/// # Safety
/// The arrays are null or have room for as many numbers as [`qless_sizes`] says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn qless_dofs(
    elimination: *const qless_elimination,
    slaves: *mut i32,
    masters: *mut i32,
    prescribed: *mut i32,
) -> c_int {
    // SAFETY: the caller upholds the contract.
    guard(|| unsafe { dofs(elimination, [slaves, masters, prescribed]) })
}

/// [`qless_dofs`] with 64-bit indices.
///
/// # Safety
/// As [`qless_dofs`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn qless_dofs_64(
    elimination: *const qless_elimination,
    slaves: *mut i64,
    masters: *mut i64,
    prescribed: *mut i64,
) -> c_int {
    // SAFETY: the caller upholds the contract.
    guard(|| unsafe { dofs(elimination, [slaves, masters, prescribed]) })
}

/// # Safety
/// The arrays have the lengths that the matrix needs.
unsafe fn rows<I: CIndex>(
    matrix: &Csr,
    base: IndexBase,
    starts: *mut I,
    columns: *mut I,
    values: *mut f64,
) -> Result<c_int, CallFailure> {
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
    Ok(OK)
}

/// T in compressed rows: row i is slave i, column q is master q.
///
/// # Safety
/// `starts` has room for one number more than there are slaves; `columns` and `values` for the entries of T.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn qless_t(
    elimination: *const qless_elimination,
    starts: *mut i32,
    columns: *mut i32,
    values: *mut f64,
) -> c_int {
    guard(|| {
        let held: Arc<HeldElimination> = get(elimination)?;
        // SAFETY: the caller upholds the contract.
        unsafe { rows(held.read()?.reduction().t(), held.base, starts, columns, values) }
    })
}

/// [`qless_t`] with 64-bit indices.
///
/// # Safety
/// As [`qless_t`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn qless_t_64(
    elimination: *const qless_elimination,
    starts: *mut i64,
    columns: *mut i64,
    values: *mut f64,
) -> c_int {
    guard(|| {
        let held: Arc<HeldElimination> = get(elimination)?;
        // SAFETY: the caller upholds the contract.
        unsafe { rows(held.read()?.reduction().t(), held.base, starts, columns, values) }
    })
}

/// G in compressed rows: row i is slave i, column p is prescribed DOF p.
///
/// # Safety
/// As [`qless_t`], with the entries of G.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn qless_g_matrix(
    elimination: *const qless_elimination,
    starts: *mut i32,
    columns: *mut i32,
    values: *mut f64,
) -> c_int {
    guard(|| {
        let held: Arc<HeldElimination> = get(elimination)?;
        // SAFETY: the caller upholds the contract.
        unsafe { rows(held.read()?.reduction().g_matrix(), held.base, starts, columns, values) }
    })
}

/// [`qless_g_matrix`] with 64-bit indices.
///
/// # Safety
/// As [`qless_g_matrix`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn qless_g_matrix_64(
    elimination: *const qless_elimination,
    starts: *mut i64,
    columns: *mut i64,
    values: *mut f64,
) -> c_int {
    guard(|| {
        let held: Arc<HeldElimination> = get(elimination)?;
        // SAFETY: the caller upholds the contract.
        unsafe { rows(held.read()?.reduction().g_matrix(), held.base, starts, columns, values) }
    })
}

/// g, one number per slave, for the current b and prescribed values.
///
/// # Safety
/// `g` has room for `length` numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn qless_g(elimination: *const qless_elimination, g: *mut f64, length: i64) -> c_int {
    guard(|| {
        let held: Arc<HeldElimination> = get(elimination)?;
        let known = held.read()?;
        // SAFETY: the caller upholds the contract.
        let out = unsafe { write("g", g, length, known.reduction().g().len()) }?;
        out.copy_from_slice(known.reduction().g());
        Ok(OK)
    })
}

/// Sets new b and prescribed values; slaves and T stay. If equations then conflict, nothing changes.
///
/// # Safety
/// The arrays have the lengths that are given.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn qless_refresh(
    elimination: *mut qless_elimination,
    rhs: *const f64,
    rhs_length: i64,
    prescribed: *const f64,
    prescribed_length: i64,
) -> c_int {
    guard(|| {
        let held: Arc<HeldElimination> = get(elimination)?;
        let lengths = (length("rhs", rhs_length)?, length("prescribed", prescribed_length)?);
        // SAFETY: the caller upholds the contract.
        let (rhs, prescribed) = unsafe { (read("rhs", rhs, lengths.0)?, read("prescribed", prescribed, lengths.1)?) };
        let mut known = unharmed(held.elimination.write())?;
        known.update(rhs, prescribed)?;
        Ok(OK)
    })
}

/// A method of [`Elimination`] that maps an input array to an output array.
type ApplyCall = fn(&Elimination, &[f64], &mut [f64]) -> Result<(), CallFailure>;

/// # Safety
/// The arrays have the lengths that are given and do not overlap.
unsafe fn apply(
    elimination: *const qless_elimination,
    (input, input_length): (*const f64, i64),
    (output, output_length): (*mut f64, i64),
    work: ApplyCall,
) -> Result<c_int, CallFailure> {
    let held: Arc<HeldElimination> = get(elimination)?;
    let (input_length, room) = (length("the input", input_length)?, length("the output", output_length)?);
    // SAFETY: the caller upholds the contract. `work` checks the lengths.
    let (input, output) =
        unsafe { (read("the input", input, input_length)?, write("the output", output, output_length, room)?) };
    work(&*held.read()?, input, output)?;
    Ok(OK)
}

/// `u = L u_q + u_0`: all DOFs from the masters.
///
/// # Safety
/// The arrays have the lengths that are given and do not overlap.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn qless_expand(
    elimination: *const qless_elimination,
    masters: *const f64,
    masters_length: i64,
    u: *mut f64,
    u_length: i64,
) -> c_int {
    let work: ApplyCall = |known, masters, u| Ok(known.expand_into(masters, u)?);
    // SAFETY: the caller upholds the contract.
    guard(|| unsafe { apply(elimination, (masters, masters_length), (u, u_length), work) })
}

/// `du = L du_q`: an increment of all DOFs from one of the masters.
///
/// # Safety
/// As [`qless_expand`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn qless_expand_increment(
    elimination: *const qless_elimination,
    masters: *const f64,
    masters_length: i64,
    du: *mut f64,
    du_length: i64,
) -> c_int {
    let work: ApplyCall = |known, masters, du| Ok(known.expand_increment_into(masters, du)?);
    // SAFETY: the caller upholds the contract.
    guard(|| unsafe { apply(elimination, (masters, masters_length), (du, du_length), work) })
}

/// `f_q = L^T f`: forces on all DOFs, transferred to the masters.
///
/// # Safety
/// As [`qless_expand`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn qless_restrict(
    elimination: *const qless_elimination,
    forces: *const f64,
    forces_length: i64,
    masters: *mut f64,
    masters_length: i64,
) -> c_int {
    let work: ApplyCall = |known, forces, masters| Ok(known.restrict_into(forces, masters)?);
    // SAFETY: the caller upholds the contract.
    guard(|| unsafe { apply(elimination, (forces, forces_length), (masters, masters_length), work) })
}

/// Computes lambda of `K u + C^T lambda = f`, one number for each equation, from `residual = f - K u`.
///
/// # Safety
/// As [`qless_expand`].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn qless_multipliers(
    elimination: *const qless_elimination,
    residual: *const f64,
    residual_length: i64,
    lambda: *mut f64,
    lambda_length: i64,
) -> c_int {
    let work: ApplyCall = |known, residual, out| {
        let found = known.multipliers(residual)?;
        if found.len() != out.len() {
            return Err(CallFailure::input(format!(
                "lambda has room for {} numbers; {} are needed",
                out.len(),
                found.len()
            )));
        }
        out.copy_from_slice(&found);
        Ok(())
    };
    // SAFETY: the caller upholds the contract.
    guard(|| unsafe { apply(elimination, (residual, residual_length), (lambda, lambda_length), work) })
}

/// The reactions `C^T lambda - (f - K u)` at the prescribed DOFs, from `residual = f - K u` and lambda.
///
/// # Safety
/// The arrays have the lengths that are given and do not overlap.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn qless_reactions(
    elimination: *const qless_elimination,
    residual: *const f64,
    residual_length: i64,
    lambda: *const f64,
    lambda_length: i64,
    reactions: *mut f64,
    reactions_length: i64,
) -> c_int {
    guard(|| {
        let held: Arc<HeldElimination> = get(elimination)?;
        let lengths = (length("residual", residual_length)?, length("lambda", lambda_length)?);
        // SAFETY: the caller upholds the contract, here and below.
        let (residual, lambda) =
            unsafe { (read("residual", residual, lengths.0)?, read("lambda", lambda, lengths.1)?) };
        let found = held.read()?.reactions(residual, lambda)?;
        unsafe { write("reactions", reactions, reactions_length, found.len()) }?.copy_from_slice(&found);
        Ok(OK)
    })
}

#[cfg(test)]
mod tests {
    use qless::{Options, SystemBuilder, analyse};

    use super::*;

    #[test]
    fn a_change_that_panicked_fails_later_calls_on_the_handle() {
        let mut builder = SystemBuilder::new(2);
        builder.equation([(0, 1.0), (1, -1.0)], 0.0);
        let analysis = analyse(&builder.build().expect("a system"), &Options::default()).expect("an analysis");
        let made = Elimination::from_analysis(analysis, Form::Explicit).expect("no conflict");
        let held = HeldElimination { elimination: RwLock::new(made), base: IndexBase::new(0).expect("a base") };
        let mut handle = std::ptr::null_mut();
        // SAFETY: the addresses are those of local variables, here and below.
        unsafe { insert("elimination", &raw mut handle, held) }.expect("an address");
        let held: Arc<HeldElimination> = get(handle).expect("a handle");
        let mut u = [0.0; 2];
        let mut expand = || unsafe { qless_expand(handle, [1.0].as_ptr(), 1, u.as_mut_ptr(), 2) };
        assert_eq!(expand(), OK);
        std::thread::scope(|scope| {
            let change = scope.spawn(|| {
                let _change = held.elimination.write();
                panic!("on purpose");
            });
            change.join().expect_err("a panic");
        });
        assert_eq!(expand(), -4);
        assert_eq!(unsafe { qless_refresh(handle, [0.0].as_ptr(), 1, std::ptr::null(), 0) }, -4);
        // SAFETY: the message is valid until the next call.
        let message = unsafe { std::ffi::CStr::from_ptr(crate::qless_message()) }.to_string_lossy().into_owned();
        assert!(message.contains("free the handle and make it again"), "{message}");
        assert_eq!(qless_elimination_free(handle), OK);
    }
}
