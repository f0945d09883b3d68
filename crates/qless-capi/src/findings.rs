//! What an analysis found beyond the kinds of equations: fixed DOFs, reasons, doubt, labels.

use std::ffi::{c_char, c_int};
use std::sync::Arc;

use qless::Doubt;
use qless::explanation::{Explanation, Number};

use crate::analysis::HeldAnalysis;
use crate::arrays::{has_room, set, write, write_text};
use crate::handles::{on, qless_analysis};
use crate::status::CallFailure;

/// Values of the argument `what`, which says whether an index means an equation, a DOF, or the prescribed value of a DOF.
const EQUATION: c_int = 0;
const DOF: c_int = 1;
const PRESCRIBED: c_int = 2;

/// A member of an explanation: `coefficient` times an equation or a prescribed value.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct qless_member {
    /// Whether the member is an equation (`QLESS_EQUATION`) or a prescribed value (`QLESS_PRESCRIBED`).
    pub what: i64,
    /// Index of the equation, or of the prescribed DOF.
    pub index: i64,
    /// Factor of the equation or of the prescribed value.
    pub coefficient: f64,
}

for_both_indices! { qless_fixed_64 =
    /// The free DOFs that the equations fix, and their values.
    ///
    /// # Safety
    /// The arrays have room for `room` numbers, and `count` may be written.
    pub unsafe extern "C" fn qless_fixed<I>(
        analysis: *const qless_analysis,
        dofs: *mut I,
        values: *mut f64,
        room: i64,
        count: *mut i64,
    ) -> c_int {
        on(analysis, |held: Arc<HeldAnalysis>| {
            let found = held.analysis.generated();
            // SAFETY: the caller upholds the contract, here and below.
            if unsafe { has_room(found.len(), room, "count", count) }? {
                let needed = found.len() as i64;
                let (dofs, values) =
                    unsafe { (write("dofs", dofs, needed, found.len())?, write("values", values, needed, found.len())?) };
                held.base.write(found.iter().map(|&(dof, _)| dof), dofs)?;
                values.iter_mut().zip(found).for_each(|(out, &(_, value))| *out = value);
            }
            Ok(())
        })
    }
}

/// Writes few equations and prescribed values, with factors, whose weighted sum is a dependent equation or the value of a fixed DOF.
///
/// # Safety
/// `members` has room for `room` members; `rhs`, `irreducible` and `count` may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn qless_reason(
    analysis: *const qless_analysis,
    what: c_int,
    index: i64,
    members: *mut qless_member,
    room: i64,
    rhs: *mut f64,
    irreducible: *mut c_int,
    count: *mut i64,
) -> c_int {
    on(analysis, |held: Arc<HeldAnalysis>| {
        let index = held.base.read(index, "the index")?;
        let reason: Option<Explanation> = match what {
            EQUATION => held.analysis.explain(index)?,
            DOF => held.analysis.explain_fixed(index)?,
            _ => return Err(unknown(what, "QLESS_EQUATION or QLESS_DOF")),
        };
        let Explanation { members: found, right_hand_side, is_irreducible, .. } =
            reason.unwrap_or_else(|| Explanation::new(Vec::new(), 0.0, 0.0));
        // SAFETY: the caller upholds the contract, here and below.
        unsafe {
            set("rhs", rhs, right_hand_side)?;
            set("irreducible", irreducible, c_int::from(is_irreducible))?;
        }
        if unsafe { has_room(found.len(), room, "count", count) }? {
            let out = unsafe { write("members", members, found.len() as i64, found.len()) }?;
            for (out, member) in out.iter_mut().zip(found) {
                let (what, index) = of_number(&held, member.into());
                *out = qless_member { what, index, coefficient: member.coefficient() };
            }
        }
        Ok(())
    })
}

pub(crate) fn of_number(held: &HeldAnalysis, number: Number) -> (i64, i64) {
    match number {
        Number::Prescribed(dof) => (PRESCRIBED.into(), held.base.shown(dof)),
        Number::RightHandSide(row) => (EQUATION.into(), held.base.shown(row)),
        _ => (-1, -1),
    }
}

fn unknown(what: c_int, choice: &str) -> CallFailure {
    CallFailure::input(format!("what is {what}; give {choice}"))
}

/// Why the verdict is in doubt, as a number, and as lines of text. The text also gives the rank in another reading of coefficients, and
/// says if the verdict holds for some times only.
///
/// # Safety
/// `doubt` and `length` may be written, and `text` has room for `room` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn qless_doubt(
    analysis: *const qless_analysis,
    doubt: *mut c_int,
    text: *mut c_char,
    room: i64,
    length: *mut i64,
) -> c_int {
    on(analysis, |held: Arc<HeldAnalysis>| {
        let (number, sentence) = in_words(held.analysis.confidence().doubt);
        let other = held.analysis.other_reading().map(|other| {
            let read = if other.as_zero { "as zero" } else { "as given" };
            let (rank, conflicting) = (other.rank, other.conflicting);
            format!(
                "with {} such coefficients read {read}, the rank is {rank} with {conflicting} conflicts",
                other.terms.len()
            )
        });
        let lines: Vec<&str> = [sentence, other.as_deref(), held.remark.as_deref()].into_iter().flatten().collect();
        // SAFETY: the caller upholds the contract.
        unsafe {
            set("doubt", doubt, number)?;
            write_text(&lines.join("\n"), text, room, length)
        }
    })
}

fn in_words(doubt: Option<Doubt>) -> (c_int, Option<&'static str>) {
    let (number, sentence) = match doubt {
        None => return (0, None),
        Some(Doubt::Near) => (1, "kept equations become dependent if their coefficients are wrong in the last digits"),
        Some(Doubt::NoGap) => (2, "dropped equations differ from combinations of others by more than rounding"),
        Some(Doubt::Mismatch) => {
            (3, "right-hand sides of dependent equations differ by so little that they may be meant as equal")
        }
        Some(Doubt::Noise) => (4, "coefficients that may be rounding decide the result"),
        Some(Doubt::Elimination) => (5, "the rank could not be verified within the memory that is allowed"),
        Some(Doubt::Unproved) => (6, "the verdict on some equation has no proof"),
        Some(Doubt::Exact) => (7, "exact arithmetic has another result"),
        Some(_) => (8, "the verdict is in doubt"),
    };
    (number, Some(sentence))
}

/// The label of an equation or a DOF, or the place of a prescribed value in its deck.
///
/// # Safety
/// `length` may be written, and `text` has room for `room` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn qless_label(
    analysis: *const qless_analysis,
    what: c_int,
    index: i64,
    text: *mut c_char,
    room: i64,
    length: *mut i64,
) -> c_int {
    on(analysis, |held: Arc<HeldAnalysis>| {
        let (system, place) = (held.analysis.system(), held.base.read(index, "the index")?);
        let count = if what == EQUATION { system.equations() } else { system.dofs() };
        if place >= count {
            return Err(CallFailure::input(format!("index {index}: there are {count}")));
        }
        let label = match what {
            EQUATION => system.equation_label(place),
            DOF => system.dof_label(place),
            PRESCRIBED => system.prescribed_place(place).unwrap_or_default().to_owned(),
            _ => return Err(unknown(what, "QLESS_EQUATION, QLESS_DOF or QLESS_PRESCRIBED")),
        };
        // SAFETY: the caller upholds the contract.
        unsafe { write_text(&label, text, room, length) }
    })
}
