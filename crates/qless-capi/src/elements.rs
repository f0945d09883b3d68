//! Assembles elements into a condensed matrix without K: `K_q += L_e^T K_e L_e`, `f_q += L_e^T (f_e - K_e u_0)`, with `u = L u_q + u_0`.
//! `L_e` are the rows of L for the DOFs of element e, and `u_0` is taken at these DOFs.

use std::ffi::{c_int, c_void};
use std::sync::{Arc, OnceLock};

use crate::arrays::{length, read, write};
use crate::elimination::HeldElimination;
use crate::handles::{insert, on, qless_elimination, qless_pattern};
use crate::pattern::{ElementDofs, HeldPattern, prescribed_dofs};
use crate::status::CallFailure;

/// A function of the caller that adds `K_e`, by rows, and `f_e` of an element to arrays of zeros. If it returns a number other than 0, the
/// assembly stops.
#[expect(non_camel_case_types, reason = "a name of C")]
pub type qless_element = Option<unsafe extern "C" fn(*mut c_void, i64, *mut f64, *mut f64) -> c_int>;

for_both_indices! { qless_condensed_for_elements_64 =
    /// The pattern of K_q by rows for the elements of a model.
    ///
    /// # Safety
    /// The arrays have the lengths that the header states: `starts` has `elements + 1` numbers, and `dofs` as many as the last of them says.
    pub unsafe extern "C" fn qless_condensed_for_elements<I>(
        elimination: *const qless_elimination,
        elements: i64,
        storage: c_int,
        prescribed: c_int,
        starts: *const I,
        dofs: *const I,
        pattern: *mut *mut qless_pattern,
    ) -> c_int {
        on(elimination, |elimination: Arc<HeldElimination>| {
            let base = elimination.base;
            let count = length("the number of elements", elements)?;
            // SAFETY: the caller upholds the contract, here and below.
            let starts = base.starts(unsafe { read("starts", starts, count + 1) }?)?;
            let dofs = base.read_all(unsafe { read("dofs", dofs, starts[count]) }?, "a DOF of an element")?;
            let elements = ElementDofs { starts, dofs };
            let (storage, prescribed) = (crate::pattern::storage(storage)?, prescribed_dofs(prescribed)?);
            let made = elimination.read()?.condensed_for_elements(count, |e| elements.of(e), storage, prescribed)?;
            let held = HeldPattern { elimination, pattern: made, elements: Some(elements) };
            unsafe { insert("pattern", pattern, held) }
        })
    }
}

/// The caller's pointer, which several threads pass to the caller's function.
struct Context(*mut c_void);

// SAFETY: the library never reads what the pointer points to, and the header requires that several threads can call the function at once.
unsafe impl Sync for Context {}

impl Context {
    fn get(&self) -> *mut c_void {
        self.0
    }
}

/// Assembles `K_q` and `f_q` from all elements of a pattern that was made by [`qless_condensed_for_elements`].
///
/// # Safety
/// The arrays have the lengths that are given; `element` writes only to its arrays and may be called by several threads at once.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn qless_assemble(
    pattern: *const qless_pattern,
    element: qless_element,
    context: *mut c_void,
    k_q: *mut f64,
    k_q_length: i64,
    f_q: *mut f64,
    f_q_length: i64,
) -> c_int {
    on(pattern, |held: Arc<HeldPattern>| {
        let Some(element) = element else { return Err(CallFailure::input("element is null; give a function")) };
        let Some(elements) = &held.elements else {
            return Err(CallFailure::input("the pattern was made from a matrix; call qless_condense"));
        };
        let (pattern, known) = (&held.pattern, held.elimination.read()?);
        // SAFETY: the caller upholds the contract, here and below.
        let (k_q, f_q) = unsafe {
            (write("k_q", k_q, k_q_length, pattern.nnz())?, write("f_q", f_q, f_q_length, pattern.unknowns())?)
        };
        let (context, stopped) = (Context(context), OnceLock::new());
        let call = |e: usize, matrix: &mut [f64], forces: &mut [f64]| {
            if stopped.get().is_none() {
                let e = held.elimination.base.shown(e);
                let status = unsafe { element(context.get(), e, matrix.as_mut_ptr(), forces.as_mut_ptr()) };
                // If another thread stopped the assembly earlier, this status is dropped: one reported element suffices.
                if status != 0 {
                    _ = stopped.set((e, status));
                }
            }
        };
        let assembled = pattern.assemble(&known, elements.count(), |e| elements.of(e), k_q, f_q, call);
        if let Some((e, status)) = stopped.get() {
            return Err(CallFailure::input(format!("element {e}: the function returned {status}")));
        }
        assembled?;
        Ok(())
    })
}

for_both_indices! { qless_add_element_64 =
    /// Adds one element to K_q and f_q, for codes with a loop of their own over elements.
    ///
    /// # Safety
    /// `dofs` and `forces` have `count` numbers, `matrix` has their square, and the arrays of K_q and f_q have the lengths that are given.
    pub unsafe extern "C" fn qless_add_element<I>(
        pattern: *const qless_pattern,
        count: i64,
        dofs: *const I,
        matrix: *const f64,
        forces: *const f64,
        k_q: *mut f64,
        k_q_length: i64,
        f_q: *mut f64,
        f_q_length: i64,
    ) -> c_int {
        on(pattern, |held: Arc<HeldPattern>| {
            let (pattern, base) = (&held.pattern, held.elimination.base);
            let count = length("the number of DOFs", count)?;
            let square = count.checked_mul(count).ok_or_else(|| CallFailure::input("the element has too many DOFs"))?;
            // SAFETY: the caller upholds the contract, here and below.
            let (dofs, matrix, forces) =
                unsafe { (read("dofs", dofs, count)?, read("matrix", matrix, square)?, read("forces", forces, count)?) };
            let dofs = base.read_all(dofs, "a DOF of the element")?;
            let (k_q, f_q) = unsafe {
                (write("k_q", k_q, k_q_length, pattern.nnz())?, write("f_q", f_q, f_q_length, pattern.unknowns())?)
            };
            Ok(pattern.add_element(&*held.elimination.read()?, &dofs, (matrix, forces), k_q, f_q)?)
        })
    }
}
