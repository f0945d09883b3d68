//! The diagnosis and the reduced form over the ranks of a job. DOFs and equations have numbers in the whole job; results belong to the
//! equations and DOFs of one rank.

use std::ffi::c_int;
use std::sync::Arc;

use qless::{Kind, Options};
use qless_mpi::{Analysis, DistributedElimination, Ranks, Share, agree, analyse};

use crate::analysis::number_of;
use crate::arrays::{IndexBase, has_room, length, not_null, read, set, write};
use crate::elimination::{HeldElimination, JobNumbers};
use crate::handles::{get, insert, on, qless_distributed, qless_elimination, qless_options, remove};
use crate::options;
use crate::ranks::{CallerRanks, qless_ranks};
use crate::status::{AMBIGUOUS, CallFailure, OK, guard};

/// The analysis of a job on one of its ranks, and what this rank gave.
#[derive(Debug)]
struct HeldDistributed {
    analysis: Analysis,
    share: Share,
    base: IndexBase,
    /// The number of this rank, and of ranks.
    place: (usize, usize),
}

/// The result of this rank, or on all ranks the failure of the first rank with one: no rank waits for one that has returned.
fn agreed<T>(ranks: &CallerRanks, own: Result<T, CallFailure>) -> Result<T, CallFailure> {
    agree(ranks, own.map_err(|failure| failure.on_rank(ranks.rank())))
}

/// Diagnoses the equations of all ranks. Collective.
///
/// # Safety
/// `ranks` holds functions that do what the header states, and the arrays have the lengths that it states.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn qless_analyse_ranks(
    ranks: *const qless_ranks,
    base: c_int,
    first_dof: i64,
    end_dof: i64,
    equations: i64,
    numbers: *const i64,
    starts: *const i64,
    columns: *const i64,
    values: *const f64,
    rhs: *const f64,
    prescribed_count: i64,
    prescribed_dofs: *const i64,
    prescribed_values: *const f64,
    needed_count: i64,
    needed_dofs: *const i64,
    options: *const qless_options,
    distributed: *mut *mut qless_distributed,
) -> c_int {
    guard(|| {
        // SAFETY: the caller upholds the contract, here and below.
        let ranks = unsafe { CallerRanks::new(ranks) }?;
        let given = || -> Result<(Share, IndexBase, Options), CallFailure> {
            let base = IndexBase::new(base)?;
            let mut share =
                Share::new(base.read(first_dof, "first_dof")? as u64..base.read(end_dof, "end_dof")? as u64);
            unsafe {
                add_equations(&mut share, base, (equations, numbers, rhs), (starts, columns, values))?;
                prescribe(&mut share, base, prescribed_count, prescribed_dofs, prescribed_values)?;
                need(&mut share, base, needed_count, needed_dofs)?;
            }
            not_null("distributed", distributed)?;
            Ok((share, base, options::of(options)?))
        };
        let (share, base, options) = agreed(&ranks, given())?;
        let analysis = analyse(&ranks, &share, &options)?;
        let status = if analysis.confidence().ambiguous { AMBIGUOUS } else { OK };
        let held = HeldDistributed { analysis, share, base, place: (ranks.rank(), ranks.size()) };
        unsafe { insert("distributed", distributed, held) }?;
        Ok(status)
    })
}

/// # Safety
/// The arrays have the lengths that the header states.
unsafe fn add_equations(
    share: &mut Share,
    base: IndexBase,
    (equations, numbers, rhs): (i64, *const i64, *const f64),
    (starts, columns, values): (*const i64, *const i64, *const f64),
) -> Result<(), CallFailure> {
    let rows = length("the number of equations", equations)?;
    // SAFETY: the caller upholds the contract, here and below.
    let starts = base.starts(unsafe { read("starts", starts, rows + 1) }?)?;
    let (numbers, nnz) = (unsafe { read("numbers", numbers, rows) }?, starts[rows]);
    let (columns, values) = unsafe { (read("columns", columns, nnz)?, read("values", values, nnz)?) };
    let rhs = if rhs.is_null() { None } else { Some(unsafe { read("rhs", rhs, rows) }?) };
    let (numbers, columns) =
        (base.read_all(numbers, "the number of an equation")?, base.read_all(columns, "a column")?);
    for row in 0..rows {
        let entries = (starts[row]..starts[row + 1]).map(|k| (columns[k] as u64, values[k]));
        share.equation(numbers[row] as u64, entries, rhs.map_or(0.0, |rhs| rhs[row]));
    }
    Ok(())
}

/// # Safety
/// The arrays have `count` numbers.
unsafe fn prescribe(
    share: &mut Share,
    base: IndexBase,
    count: i64,
    dofs: *const i64,
    values: *const f64,
) -> Result<(), CallFailure> {
    let count = length("the number of prescribed DOFs", count)?;
    // SAFETY: the caller upholds the contract.
    let (dofs, values) = unsafe { (read("prescribed_dofs", dofs, count)?, read("prescribed_values", values, count)?) };
    let dofs = base.read_all(dofs, "a prescribed DOF")?;
    dofs.iter().zip(values).for_each(|(&dof, &value)| share.prescribe(dof as u64, value));
    Ok(())
}

/// # Safety
/// `dofs` has `count` numbers.
unsafe fn need(share: &mut Share, base: IndexBase, count: i64, dofs: *const i64) -> Result<(), CallFailure> {
    // SAFETY: the caller upholds the contract.
    let dofs = unsafe { read("needed_dofs", dofs, length("the number of needed DOFs", count)?) }?;
    base.read_all(dofs, "a needed DOF")?.into_iter().for_each(|dof| share.need(dof as u64));
    Ok(())
}

/// Frees the analysis of a rank; null is allowed. Eliminations made from it stay valid.
#[unsafe(no_mangle)]
pub extern "C" fn qless_distributed_free(distributed: *mut qless_distributed) -> c_int {
    guard(|| remove::<_, HeldDistributed>(distributed))
}

/// Numbers of equations and DOFs, rank, and numbers of redundant and conflicting equations, of the whole job.
///
/// # Safety
/// Each pointer may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn qless_distributed_counts(
    distributed: *const qless_distributed,
    equations: *mut i64,
    dofs: *mut i64,
    rank: *mut i64,
    redundant: *mut i64,
    conflicting: *mut i64,
) -> c_int {
    on(distributed, |held: Arc<HeldDistributed>| {
        let found = held.analysis.counts();
        let counts = [
            ("equations", equations, found.equations),
            ("dofs", dofs, found.dofs),
            ("rank", rank, found.rank()),
            ("redundant", redundant, found.redundant),
            ("conflicting", conflicting, found.conflicting),
        ];
        // SAFETY: the caller upholds the contract.
        counts.into_iter().try_for_each(|(what, place, count)| unsafe { set(what, place, count as i64) })
    })
}

/// The kind of each equation that this rank gave.
///
/// # Safety
/// `kinds` has room for `length` numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn qless_distributed_kinds(
    distributed: *const qless_distributed,
    kinds: *mut i8,
    length: i64,
) -> c_int {
    on(distributed, |held: Arc<HeldDistributed>| {
        let found: &[Kind] = held.analysis.kinds();
        // SAFETY: the caller upholds the contract.
        let out = unsafe { write("kinds", kinds, length, found.len()) }?;
        out.iter_mut().zip(found).for_each(|(out, &kind)| *out = number_of(kind));
        Ok(())
    })
}

/// Why an equation of this rank is dependent, with the numbers in the job of the equations of its sum.
///
/// # Safety
/// `numbers` and `coefficients` have room for `room` numbers, and `count` may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn qless_distributed_explanation(
    distributed: *const qless_distributed,
    row: i64,
    numbers: *mut i64,
    coefficients: *mut f64,
    room: i64,
    count: *mut i64,
) -> c_int {
    on(distributed, |held: Arc<HeldDistributed>| {
        let (row, rows) = (held.base.read(row, "the row")?, held.share.equations());
        if row >= rows {
            return Err(CallFailure::input(format!("row {row}, counted from 0: this rank gave {rows} equations")));
        }
        let dependent = held.analysis.dependent();
        let found = dependent.binary_search_by_key(&row, |dependent| dependent.equation);
        let terms = found.map_or(&[][..], |k| &dependent[k].because);
        // SAFETY: the caller upholds the contract, here and below.
        if unsafe { has_room(terms.len(), room, "count", count) }? {
            let needed = terms.len() as i64;
            let out = unsafe { write("numbers", numbers, needed, terms.len()) }?;
            held.base.write(terms.iter().map(|term| term.equation as usize), out)?;
            let out = unsafe { write("coefficients", coefficients, needed, terms.len()) }?;
            out.iter_mut().zip(terms).for_each(|(out, term)| *out = term.coefficient);
        }
        Ok(())
    })
}

/// Solves for the slaves; an error on all ranks if equations conflict. Collective.
///
/// # Safety
/// `ranks` holds functions that do what the header states, and `elimination` may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn qless_distributed_eliminate(
    ranks: *const qless_ranks,
    distributed: *const qless_distributed,
    elimination: *mut *mut qless_elimination,
) -> c_int {
    guard(|| {
        // SAFETY: the caller upholds the contract, here and below.
        let ranks = unsafe { CallerRanks::new(ranks) }?;
        let held = || -> Result<Arc<HeldDistributed>, CallFailure> {
            let held: Arc<HeldDistributed> = get(distributed)?;
            not_null("elimination", elimination)?;
            let (now, then) = ((ranks.rank(), ranks.size()), held.place);
            let other = || format!("this is rank {} of {}, but rank {} of {} analysed", now.0, now.1, then.0, then.1);
            if now == then { Ok(held) } else { Err(CallFailure::input(other())) }
        };
        let held = agreed(&ranks, held())?;
        let made = DistributedElimination::from_analysis(&ranks, &held.share, held.analysis.clone())?;
        let job = JobNumbers { dofs: made.dofs().to_vec(), masters: made.masters().to_vec() };
        unsafe { insert("elimination", elimination, HeldElimination::new(made.into_local(), held.base, Some(job))) }?;
        Ok(OK)
    })
}

/// Writes numbers in the job; an error for an elimination of a single process.
///
/// # Safety
/// `out` has room for `room` numbers, and `count` may be written.
unsafe fn job_numbers(
    elimination: *const qless_elimination,
    (what, list): (&str, fn(&JobNumbers) -> &[u64]),
    (out, room, count): (*mut i64, i64, *mut i64),
) -> c_int {
    on(elimination, |held: Arc<HeldElimination>| {
        let message = "the elimination was not made by qless_distributed_eliminate; its DOFs have no other numbers";
        let list = list(held.job.as_ref().ok_or_else(|| CallFailure::input(message))?);
        // SAFETY: the caller upholds the contract, here and below.
        if unsafe { has_room(list.len(), room, "count", count) }? {
            let out = unsafe { write(what, out, list.len() as i64, list.len()) }?;
            held.base.write(list.iter().map(|&dof| dof as usize), out)?;
        }
        Ok(())
    })
}

/// The number in the job of each local DOF of an elimination, ascending.
///
/// # Safety
/// `dofs` has room for `room` numbers, and `count` may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn qless_distributed_dofs(
    elimination: *const qless_elimination,
    dofs: *mut i64,
    room: i64,
    count: *mut i64,
) -> c_int {
    // SAFETY: the caller upholds the contract.
    unsafe { job_numbers(elimination, ("dofs", |job| &job.dofs), (dofs, room, count)) }
}

/// The numbers in the job of the masters that this rank owns, ascending.
///
/// # Safety
/// `masters` has room for `room` numbers, and `count` may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn qless_distributed_masters(
    elimination: *const qless_elimination,
    masters: *mut i64,
    room: i64,
    count: *mut i64,
) -> c_int {
    // SAFETY: the caller upholds the contract.
    unsafe { job_numbers(elimination, ("masters", |job| &job.masters), (masters, room, count)) }
}
