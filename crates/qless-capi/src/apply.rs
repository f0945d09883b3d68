//! What a code does with an elimination in every step: refresh, expand, restrict, multipliers, reactions.

use std::ffi::c_int;
use std::sync::Arc;

use qless::Elimination;

use crate::arrays::{length, read, write};
use crate::elimination::HeldElimination;
use crate::handles::{get, on, qless_elimination, unharmed};
use crate::status::{AMBIGUOUS, CallFailure, OK, guard};

/// Sets new b and prescribed values; slaves and T stay. If equations then conflict, nothing changes. The returned status says whether the
/// verdict on the new values is ambiguous.
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
        Ok(if known.confidence().is_some_and(|of| of.ambiguous) { AMBIGUOUS } else { OK })
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
) -> c_int {
    on(elimination, |held: Arc<HeldElimination>| {
        let (input_length, room) = (length("the input", input_length)?, length("the output", output_length)?);
        // SAFETY: the caller upholds the contract. The function `work` checks the lengths.
        let (input, output) =
            unsafe { (read("the input", input, input_length)?, write("the output", output, output_length, room)?) };
        work(&*held.read()?, input, output)
    })
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
    unsafe { apply(elimination, (masters, masters_length), (u, u_length), work) }
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
    unsafe { apply(elimination, (masters, masters_length), (du, du_length), work) }
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
    unsafe { apply(elimination, (forces, forces_length), (masters, masters_length), work) }
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
    unsafe { apply(elimination, (residual, residual_length), (lambda, lambda_length), work) }
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
    on(elimination, |held: Arc<HeldElimination>| {
        let lengths = (length("residual", residual_length)?, length("lambda", lambda_length)?);
        // SAFETY: the caller upholds the contract, here and below.
        let (residual, lambda) =
            unsafe { (read("residual", residual, lengths.0)?, read("lambda", lambda, lengths.1)?) };
        let found = held.read()?.reactions(residual, lambda)?;
        unsafe { write("reactions", reactions, reactions_length, found.len()) }?.copy_from_slice(&found);
        Ok(())
    })
}

#[cfg(test)]
mod tests {
    use qless::{Form, Options, SystemBuilder, analyse};

    use super::*;
    use crate::arrays::IndexBase;
    use crate::elimination::qless_elimination_free;
    use crate::handles::{get, insert};
    use crate::status::OK;

    #[test]
    fn a_change_that_panicked_fails_later_calls_on_the_handle() {
        let mut builder = SystemBuilder::new(2);
        builder.equation([(0, 1.0), (1, -1.0)], 0.0);
        let analysis = analyse(&builder.build().expect("a system"), &Options::default()).expect("an analysis");
        let made = Elimination::from_analysis(analysis, Form::Explicit).expect("no conflict");
        let held = HeldElimination::new(made, IndexBase::new(0).expect("a base"), None);
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
