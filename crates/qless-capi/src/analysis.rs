//! The diagnosis: rank, kinds of equations, explanations, digits of confidence.

use std::ffi::c_int;
use std::sync::{Arc, OnceLock};

use qless::explanation::Repair;
use qless::{Analysis, Kind, SystemBuilder, analyse};

use crate::arrays::{IndexBase, has_room, length, read, set, write};
use crate::handles::{insert, on, qless_analysis, qless_options, remove};
use crate::options;
use crate::status::{AMBIGUOUS, CallFailure, OK, guard};

/// An analysis, and the index base of its caller.
#[derive(Debug)]
pub(crate) struct HeldAnalysis {
    pub(crate) analysis: Arc<Analysis>,
    pub(crate) base: IndexBase,
    /// A sentence that limits the verdict: it holds only for the prescribed values of one time history of a deck.
    pub(crate) remark: Option<String>,
    /// The repairs of conflicts, computed when they are first needed.
    pub(crate) repairs: OnceLock<Vec<Repair>>,
}

impl HeldAnalysis {
    pub(crate) fn new(analysis: Analysis, base: IndexBase) -> Self {
        Self { analysis: Arc::new(analysis), base, remark: None, repairs: OnceLock::new() }
    }

    /// Makes a handle of the analysis; the returned status says whether the verdict is ambiguous.
    ///
    /// # Safety
    /// `place` is null or may be written.
    pub(crate) unsafe fn hold(self, place: *mut *mut qless_analysis) -> Result<c_int, CallFailure> {
        let status = if self.analysis.confidence().ambiguous { AMBIGUOUS } else { OK };
        // SAFETY: the caller upholds the contract.
        unsafe { insert("analysis", place, self) }?;
        Ok(status)
    }
}

for_both_indices! { qless_analyse_64 =
    /// Diagnoses `C u = b`, with C in compressed rows.
    ///
    /// # Safety
    /// The arrays have the lengths that the header states: `starts` has one number more than there are equations, and its last number
    /// gives the number of entries.
    pub unsafe extern "C" fn qless_analyse<I>(
        equations: i64,
        dofs: i64,
        base: c_int,
        starts: *const I,
        columns: *const I,
        values: *const f64,
        rhs: *const f64,
        prescribed_count: i64,
        prescribed_dofs: *const I,
        prescribed_values: *const f64,
        options: *const qless_options,
        analysis: *mut *mut qless_analysis,
    ) -> c_int {
        guard(|| {
            let base = IndexBase::new(base)?;
            let rows = length("the number of equations", equations)?;
            let mut builder = SystemBuilder::new(length("the number of DOFs", dofs)?);
            // SAFETY: the caller upholds the contract, here and below.
            let starts = base.starts(unsafe { read("starts", starts, rows + 1) }?)?;
            let nnz = starts[rows];
            let (columns, values) = unsafe { (read("columns", columns, nnz)?, read("values", values, nnz)?) };
            let rhs = if rhs.is_null() { None } else { Some(unsafe { read("rhs", rhs, rows) }?) };
            let columns = base.read_all(columns, "a column")?;
            for row in 0..rows {
                let entries = (starts[row]..starts[row + 1]).map(|k| (columns[k], values[k]));
                builder.equation(entries, rhs.map_or(0.0, |rhs| rhs[row]));
            }
            let count = length("the number of prescribed DOFs", prescribed_count)?;
            let (dofs, values) =
                unsafe { (read("dofs", prescribed_dofs, count)?, read("prescribed", prescribed_values, count)?) };
            for (&dof, &value) in dofs.iter().zip(values) {
                builder.prescribe(base.read(dof, "a prescribed DOF")?, value);
            }
            let found = analyse(&builder.build()?, &options::of(options)?)?;
            unsafe { HeldAnalysis::new(found, base).hold(analysis) }
        })
    }
}

/// Frees an analysis; null is allowed. Eliminations made from it stay valid.
#[unsafe(no_mangle)]
pub extern "C" fn qless_analysis_free(analysis: *mut qless_analysis) -> c_int {
    guard(|| remove::<_, HeldAnalysis>(analysis))
}

/// Writes the numbers of equations and DOFs, the rank, and the numbers of redundant and conflicting equations.
///
/// # Safety
/// Each pointer may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn qless_counts(
    analysis: *const qless_analysis,
    equations: *mut i64,
    dofs: *mut i64,
    rank: *mut i64,
    redundant: *mut i64,
    conflicting: *mut i64,
) -> c_int {
    on(analysis, |held: Arc<HeldAnalysis>| {
        let found = &held.analysis;
        let count = |kind: Kind| found.dependent().iter().filter(|d| d.kind == kind).count();
        let counts = [
            ("equations", equations, found.kinds().len()),
            ("dofs", dofs, found.system().dofs()),
            ("rank", rank, found.rank()),
            ("redundant", redundant, count(Kind::Redundant)),
            ("conflicting", conflicting, count(Kind::Conflicting)),
        ];
        // SAFETY: the caller upholds the contract.
        counts.into_iter().try_for_each(|(what, place, count)| unsafe { set(what, place, count as i64) })
    })
}

/// The kind of each equation: 0 independent, 1 redundant, 2 conflicting.
///
/// # Safety
/// `kinds` has room for `length` numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn qless_kinds(analysis: *const qless_analysis, kinds: *mut i8, length: i64) -> c_int {
    on(analysis, |held: Arc<HeldAnalysis>| {
        // SAFETY: the caller upholds the contract.
        let out = unsafe { write("kinds", kinds, length, held.analysis.kinds().len()) }?;
        out.iter_mut().zip(held.analysis.kinds()).for_each(|(out, &kind)| *out = number_of(kind));
        Ok(())
    })
}

/// `QLESS_INDEPENDENT`, `QLESS_REDUNDANT` or `QLESS_CONFLICTING`.
pub(crate) fn number_of(kind: Kind) -> i8 {
    match kind {
        Kind::Independent => 0,
        Kind::Redundant => 1,
        Kind::Conflicting => 2,
    }
}

/// Writes the confidence in digits. `kept`: a change of coefficients in this digit can make the kept equations dependent. `dropped`: the
/// digits to which the dropped equations agree with the kept ones. `ambiguous`: whether another rank or verdict is possible.
///
/// # Safety
/// Each pointer may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn qless_digits(
    analysis: *const qless_analysis,
    kept: *mut f64,
    dropped: *mut f64,
    ambiguous: *mut c_int,
) -> c_int {
    on(analysis, |held: Arc<HeldAnalysis>| {
        let confidence = held.analysis.confidence();
        // SAFETY: the caller upholds the contract.
        unsafe {
            set("kept", kept, confidence.digits_kept())?;
            set("dropped", dropped, confidence.digits_dropped())?;
            set("ambiguous", ambiguous, c_int::from(confidence.ambiguous))?;
        }
        Ok(())
    })
}

for_both_indices! { qless_explanation_64 =
    /// Why an equation is dependent: `row = sum coefficients_k rows_k`. With room 0 only `count` is set.
    ///
    /// # Safety
    /// `rows` and `coefficients` have room for `room` numbers, and `count` may be written.
    pub unsafe extern "C" fn qless_explanation<I>(
        analysis: *const qless_analysis,
        row: i64,
        rows: *mut I,
        coefficients: *mut f64,
        room: i64,
        count: *mut i64,
    ) -> c_int {
        on(analysis, |held: Arc<HeldAnalysis>| {
            let terms = held.analysis.because(held.base.read(row, "the row")?)?;
            // SAFETY: the caller upholds the contract, here and below.
            if unsafe { has_room(terms.len(), room, "count", count) }? {
                let needed = terms.len() as i64;
                let rows = unsafe { write("rows", rows, needed, terms.len()) }?;
                held.base.write(terms.iter().map(|term| term.row), rows)?;
                let out = unsafe { write("coefficients", coefficients, needed, terms.len()) }?;
                out.iter_mut().zip(&terms).for_each(|(out, term)| *out = term.coefficient);
            }
            Ok(())
        })
    }
}
