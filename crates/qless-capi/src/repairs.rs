//! Repairs: which right-hand sides and prescribed values to change so that no conflict is left.

use std::ffi::c_int;
use std::sync::Arc;

use qless::explanation::{Change, Repair};

use crate::analysis::HeldAnalysis;
use crate::arrays::{set, write};
use crate::findings::of_number;
use crate::handles::{on, qless_analysis};
use crate::status::CallFailure;

/// Another value for a right-hand side or a prescribed value.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct qless_change {
    /// Whether the right-hand side of an equation changes (`QLESS_EQUATION`), or a prescribed value (`QLESS_PRESCRIBED`).
    pub what: i64,
    /// Index of the equation, or of the prescribed DOF.
    pub index: i64,
    /// The value in the input.
    pub from: f64,
    /// The value that, with the other changes, cures the conflicts.
    pub to: f64,
}

impl HeldAnalysis {
    fn repairs(&self) -> Result<&[Repair], CallFailure> {
        if let Some(known) = self.repairs.get() {
            return Ok(known);
        }
        let found = self.analysis.repairs()?;
        Ok(self.repairs.get_or_init(|| found))
    }

    fn repair(&self, group: i64) -> Result<&Repair, CallFailure> {
        let group = self.base.read(group, "the group")?;
        let repairs = self.repairs()?;
        let count = repairs.len();
        repairs
            .get(group)
            .ok_or_else(|| CallFailure::input(format!("group {}: there are {count}", self.base.shown(group))))
    }
}

/// Number of groups of conflicts. Conflicts that have right-hand sides or prescribed values in common belong to one group.
///
/// # Safety
/// `groups` may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn qless_repairs(analysis: *const qless_analysis, groups: *mut i64) -> c_int {
    on(analysis, |held: Arc<HeldAnalysis>| {
        // SAFETY: the caller upholds the contract.
        unsafe { set("groups", groups, held.repairs()?.len() as i64) }
    })
}

/// Sizes of a group of conflicts: the number of its conflicting equations, the number of ways to cure them, and the number of changes of
/// each way. A way is a set of changes that cures all conflicts of the group.
///
/// # Safety
/// Each pointer may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn qless_repair_sizes(
    analysis: *const qless_analysis,
    group: i64,
    conflicts: *mut i64,
    ways: *mut i64,
    changes: *mut i64,
) -> c_int {
    on(analysis, |held: Arc<HeldAnalysis>| {
        let repair = held.repair(group)?;
        // SAFETY: the caller upholds the contract.
        unsafe {
            set("conflicts", conflicts, repair.conflicts.len() as i64)?;
            set("ways", ways, repair.ways.len() as i64)?;
            set("changes", changes, repair.ways.first().map_or(0, Vec::len) as i64)?;
        }
        Ok(())
    })
}

/// The conflicting equations of a group, ascending.
///
/// # Safety
/// `rows` has room for `length` numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn qless_repair_conflicts(
    analysis: *const qless_analysis,
    group: i64,
    rows: *mut i64,
    length: i64,
) -> c_int {
    on(analysis, |held: Arc<HeldAnalysis>| {
        let conflicts = &held.repair(group)?.conflicts;
        // SAFETY: the caller upholds the contract.
        held.base.write(conflicts.iter().copied(), unsafe { write("rows", rows, length, conflicts.len()) }?)
    })
}

/// The changes of one way, which is a set of changes that cures all conflicts of a group. The most plausible way has the lowest number.
///
/// # Safety
/// `changes` has room for `length` changes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn qless_repair(
    analysis: *const qless_analysis,
    group: i64,
    way: i64,
    changes: *mut qless_change,
    length: i64,
) -> c_int {
    on(analysis, |held: Arc<HeldAnalysis>| {
        let (ways, place) = (&held.repair(group)?.ways, held.base.read(way, "the way")?);
        let found =
            ways.get(place).ok_or_else(|| CallFailure::input(format!("way {way}: there are {}", ways.len())))?;
        // SAFETY: the caller upholds the contract.
        let out = unsafe { write("changes", changes, length, found.len()) }?;
        for (out, &Change { number, from, to, .. }) in out.iter_mut().zip(found) {
            let (what, index) = of_number(&held, number);
            *out = qless_change { what, index, from, to };
        }
        Ok(())
    })
}
